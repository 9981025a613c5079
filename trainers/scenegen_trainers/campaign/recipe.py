"""The recipe of a campaign: the dataset's, for worlds, weather and camera, and the sections of the closed loop."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from types import MappingProxyType
from typing import Any

from scenegen.foundation.errors import InputError
from scenegen.foundation.section import Section
from scenegen_datasets.recipe import Recipe, resolve_recipe
from scenegen_datasets.resolve import Source, leaves, merge, resolve
from scenegen_datasets.splits.held_out import HeldOut
from scenegen_flythrough.loop.knobs import LoopKnobs, MissionKnobs
from scenegen_trainers.campaign.knobs import CampaignKnobs

DIFFICULTY: Mapping[str, float] = MappingProxyType(
    {"city": 0.6, "coastline": 0.6, "neighborhood": 0.6, "field": 0.6}
)
"""`mission.difficulty` of each map where a recipe leaves it open: such that the oracle collides in at most 5 % of 400
flights, and a blind pilot in 40 to 85 %. Other scenes take the key's own default."""

_NOT_FLOWN = ("layers", "clips_per_world", "pairs_per_clip", "first_world", "flight")
"""Keys of the dataset that decide nothing about a flight."""


class FlightSections(Section):
    """The sections a campaign adds to the dataset's recipe."""

    loop: LoopKnobs = LoopKnobs()
    mission: MissionKnobs = MissionKnobs()
    campaign: CampaignKnobs = CampaignKnobs()


class FlightRecipe(Section):
    """Everything that decides the outcomes of a campaign, but for the pilots.

    Attributes
    ----------
    dataset : Recipe
        Seed, maps, climate, movers, camera, sensor.
    loop : LoopKnobs
    missions : dict of str to MissionKnobs
        Of each map.
    campaign : CampaignKnobs
    """

    dataset: Recipe
    loop: LoopKnobs
    missions: dict[str, MissionKnobs]
    campaign: CampaignKnobs

    @property
    def held_out(self) -> HeldOut:
        """Hours and weather that decide when batches fly: those the recipe holds out, as far as they are drawn."""
        held = self.dataset.splits.held_out
        if self.campaign.conditions == "any":
            return HeldOut()
        return HeldOut(hours=() if self.campaign.hours else held.hours, weather=held.weather)

    def canonical(self) -> dict[str, Any]:
        """Plain data of everything that decides outcomes.

        What is held out, and whether it is flown in, enters where anything is; without, a recipe keeps its identity.
        """
        left_out = {*_NOT_FLOWN, *(() if self.held_out.conditions else ("splits",))}
        dataset = {k: v for k, v in self.dataset.canonical().items() if k not in left_out}
        sections = self.model_dump(mode="json", include={"loop", "missions", "campaign"})
        if not self.held_out.conditions:
            del sections["campaign"]["conditions"]
        return {**dataset, **sections}


def flight_keys() -> Iterator[tuple[str, str, Any]]:
    """Keys that are not the dataset's: dotted name, one-line meaning, default."""
    return leaves(FlightSections)


def resolve_flights(sources: Sequence[Source]) -> FlightRecipe:
    """Compose a recipe from what was asked, key by key.

    Parameters
    ----------
    sources : sequence of Source
        From weakest to strongest; keys of the dataset's recipe and of the closed loop side by side.

    Raises
    ------
    InputError
        In one line, naming file and key.
    """
    own = [Source(s.name, {k: v for k, v in s.values.items() if k in _OWN}) for s in sources]
    theirs = [Source(s.name, {k: v for k, v in s.values.items() if k not in _OWN}) for s in sources]
    dataset = resolve_recipe(theirs)
    asked = merge(source.values for source in own)
    sections = resolve(FlightSections, [*own, Source("", _strong_enough(asked))])
    if sections.campaign.conditions == "held_out" and not dataset.splits.held_out.conditions:
        raise InputError(
            "campaign.conditions held_out: the recipe holds out neither hours nor weather; say which with "
            "--splits.test-hours or --splits.test-weather"
        )
    return FlightRecipe(
        dataset=dataset,
        loop=sections.loop,
        missions={map: _mission(map, sections.mission, asked) for map in dataset.map},
        campaign=sections.campaign,
    )


def _mission(map: str, knobs: MissionKnobs, asked: Mapping[str, Any]) -> MissionKnobs:
    """The missions of one map: with its own difficulty, unless one was asked for."""
    if "difficulty" in (asked.get("mission") or {}) or map not in DIFFICULTY:
        return knobs
    return knobs.model_copy(update={"difficulty": DIFFICULTY[map]})


def _strong_enough(asked: Mapping[str, Any]) -> dict[str, Any]:
    """A drone that can cruise as fast as it is asked to, where nothing else is said about it.

    Raises
    ------
    InputError
        If both are said and do not fit.
    """
    loop = asked.get("loop")
    loop = loop if isinstance(loop, Mapping) else {}
    cruise, drone = loop.get("cruise_mps"), loop.get("drone")
    if not isinstance(cruise, int | float) or isinstance(cruise, bool):
        return {}
    if isinstance(drone, Mapping) and "speed_mps" in drone:
        limit = drone["speed_mps"]
        if isinstance(limit, int | float) and limit < cruise:
            raise InputError(
                f"--loop.cruise_mps {cruise:g} is more than the drone's loop.drone.speed_mps {limit:g}; raise that"
            )
        return {}
    usual = LoopKnobs().drone.speed_mps
    return {"loop": {"drone": {"speed_mps": cruise}}} if cruise > usual else {}


_OWN = frozenset(FlightSections.model_fields)
