"""Table 2: the conventional and the proposed method, oracle and blind, on the same missions over four maps."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Mapping, Sequence
from dataclasses import dataclass
from functools import cached_property
from pathlib import Path
from statistics import fmean
from types import MappingProxyType
from typing import Any

from scenegen.foundation.errors import InputError
from scenegen.maps.own_scene.own_scene import describe
from scenegen.maps.registry import MAPS
from scenegen_datasets.resolve import Source
from scenegen_datasets.store import LOCK, read_lock
from scenegen_flythrough.planners.registry import planner
from scenegen_trainers.campaign import results as campaign_results
from scenegen_trainers.campaign.recipe import FlightRecipe, resolve_flights
from scenegen_trainers.campaign.report.page import write_page
from scenegen_trainers.campaign.run import Campaign, Progress, run
from scenegen_trainers.campaign.statistics import Paired, Rate, mcnemar, wilson
from scenegen_trainers.campaign.store import BASE_POINT
from scenegen_trainers.campaign.summary import Line
from scenegen_trainers.campaign.worker import check_pilot
from scenegen_trainers.pilots.spec import parse_pilot
from scenegen_trainers.tables.entrants import Entrant, check_sizes
from scenegen_trainers.tables.table2_paper import LEFT_OUT, METHODS

FLIGHTS_DIR = "flights"
"""The campaign, below the table's directory."""

BOUNDS = ("oracle", "blind")
"""What true depth and no eyes at all make of the same missions."""

FLIGHTS: Mapping[str, int] = MappingProxyType({"ci": 6, "small": 100, "paper": 400})
"""Missions of each map, by profile."""

_OURS = {"map": list(MAPS), "campaign": {"batches_per_world": 1}}
"""All maps; a new world for every batch, because flights of one world share its streets."""

_NOT_OURS = (
    "pairs",
    "map",
    "scenes",
    "layers",
    "clips_per_world",
    "pairs_per_clip",
    "first_world",
    "flight",
    "splits",
    "render",
    "merged",
    "sensed",
)
"""Keys of a dataset's recipe that its flights do not take over."""


@dataclass(frozen=True, eq=False)
class Table2Job:
    """What to fly.

    Attributes
    ----------
    out : Path
    recipe : FlightRecipe
        Of `flight_recipe`.
    conventional, proposed : Entrant
    flights : int
        Missions of each map.
    planner : str
    processes : int
    profile : str
        For the title.
    dataset : mapping of str to str
        Whose test worlds these are; empty if none was named.
    allow_mixed : bool
    """

    out: Path
    recipe: FlightRecipe
    conventional: Entrant
    proposed: Entrant
    flights: int
    planner: str
    processes: int
    profile: str
    dataset: Mapping[str, str]
    allow_mixed: bool = False

    @cached_property
    def campaign(self) -> Campaign:
        """The flights.

        Raises
        ------
        InputError
            If the checkpoints do not fit the camera or each other.
        """
        check_sizes(self.conventional, self.proposed)
        words = (str(self.conventional.path), str(self.proposed.path), *BOUNDS)
        pilots = tuple(parse_pilot(word, self.planner) for word in words)
        if pilots[0].sha256 == pilots[1].sha256:
            raise InputError(f"--proposed {self.proposed.path}: is the conventional network itself")
        for spec in pilots:
            check_pilot(spec, self.recipe)
        return Campaign(
            recipe=self.recipe,
            points={BASE_POINT: self.recipe},
            pilots=pilots,
            flights=self.flights,
            root=self.out / FLIGHTS_DIR,
            processes=self.processes,
            allow_mixed=self.allow_mixed,
            names=(*METHODS, *BOUNDS),
        )


@dataclass(frozen=True, eq=False)
class Table2:
    """What came of it.

    Attributes
    ----------
    job : Table2Job
    lines : mapping of (str, str) to Line
        By map and pilot.
    duels : mapping of str to Paired
        Conventional against proposed, by map.
    failed : mapping of str to str
        Batches that could not be flown, and why.
    """

    job: Table2Job
    lines: Mapping[tuple[str, str], Line]
    duels: Mapping[str, Paired]
    failed: Mapping[str, str]

    @property
    def maps(self) -> tuple[str, ...]:
        """As they were flown."""
        return self.job.recipe.dataset.map

    @property
    def averaged(self) -> tuple[str, ...]:
        """Maps that the paper's average would hold."""
        return tuple(map for map in self.maps if map != LEFT_OUT)

    def rate(self, pilot: str, maps: Iterable[str]) -> Rate:
        """Collisions of all flights over some maps together."""
        rates = [self.lines[map, pilot].collision for map in maps]
        return wilson(sum(rate.count for rate in rates), sum(rate.of for rate in rates))

    def mean(self, pilot: str, maps: Iterable[str]) -> float | None:
        """Mean of the maps' rates, as the paper averages; None where a map has no flight."""
        rates = [self.lines[map, pilot].collision for map in maps]
        return fmean(rate.share for rate in rates) if rates and all(rate.of for rate in rates) else None

    def paired(self, maps: Iterable[str]) -> Paired:
        """Both methods over some maps together, mission by mission."""
        duels = [self.duels[map] for map in maps]
        first, second = sum(d.first_only for d in duels), sum(d.second_only for d in duels)
        return Paired(
            sum(d.both for d in duels), first, second, sum(d.neither for d in duels), mcnemar(first, second)
        )


def flight_recipe(
    asked: Sequence[Source], camera: Mapping[str, Any] | None, data: Path | None
) -> FlightRecipe:
    """Where, when and with what camera is flown.

    Parameters
    ----------
    asked : sequence of Source
        File and flags, from weakest to strongest.
    camera : mapping or None
        That of the checkpoints.
    data : Path or None
        Dataset whose seed, climate, camera and sensor count, below `asked`: its test worlds are flown, in the hours and
        weather it does not hold out unless `asked` says otherwise (`campaign.conditions`).

    Raises
    ------
    InputError
        In one line, naming file and key.
    """
    sources = [Source("table2", _OURS)]
    if camera is not None:
        sources.append(Source("the checkpoints", {"camera": dict(camera)}))
    if data is not None:
        recipe_of_data = read_lock(data)["recipe"]
        kept = {key: value for key, value in recipe_of_data.items() if key not in _NOT_OURS}
        held = recipe_of_data.get("splits") or {}
        kept["splits"] = {key: held[key] for key in ("test_hours", "test_weather") if held.get(key)}
        sources.append(Source(str(data / LOCK), kept))
    recipe = resolve_flights([*sources, *asked])
    for scene in recipe.dataset.scenes.values():
        describe(scene)
    return recipe


def check_planner(name: str, recipe: FlightRecipe) -> None:
    """Say early what is wrong with a planner's name."""
    planner(name, recipe.loop)


def run_table2(job: Table2Job, told: Callable[[Progress], None] = lambda progress: None) -> Table2:
    """Fly what is missing, then collect. Writes the campaign's own files, too.

    Parameters
    ----------
    job : Table2Job
    told : callable
        Hears of progress.

    Raises
    ------
    InputError
        If the checkpoints do not fit, or the directory holds something else.
    """
    campaign = job.campaign
    failed = run(campaign, told)
    found = campaign_results.gather(campaign)
    campaign_results.write(campaign, found)
    write_page(campaign, found)
    lines = {(line.map, line.pilot): line for line in found.lines}
    return Table2(job, lines, {duel.map: duel.paired for duel in found.duels}, failed)
