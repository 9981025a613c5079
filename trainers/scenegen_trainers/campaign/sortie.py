"""One batch, flown: the loop of looking, asking and advancing until no drone is in the air."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import fields, replace

import numpy as np

from scenegen.foundation.rng import stream
from scenegen_datasets.stopwatch import Stopwatch
from scenegen_flythrough.loop.arena import Arena
from scenegen_flythrough.loop.asking import Answer, ask
from scenegen_flythrough.loop.missions import Missions, draw_missions
from scenegen_flythrough.loop.outcome import Outcome
from scenegen_flythrough.loop.pilot import Command, Need, Observation, Pilot
from scenegen_render.trace.views import Views
from scenegen_trainers.campaign.eyes import Eyes, Images
from scenegen_trainers.campaign.moment import Moment, draw_moment
from scenegen_trainers.campaign.place import Place
from scenegen_trainers.campaign.plan import Batch
from scenegen_trainers.campaign.recipe import FlightRecipe
from scenegen_trainers.campaign.record import BatchRecord, FlightRecord

Witness = Callable[[Observation, Answer, Images | None], None]
"""Is shown every decision: what was seen, and what was answered."""


class Sortie:
    """A batch on its way.

    Parameters
    ----------
    recipe : FlightRecipe
    place : Place
        The batch's world.
    batch : Batch
    views : Views
        Of the recipe's camera.
    watch : Stopwatch
    """

    def __init__(
        self, recipe: FlightRecipe, place: Place, batch: Batch, views: Views, watch: Stopwatch
    ) -> None:
        self._recipe, self._place, self._batch, self._views, self._watch = recipe, place, batch, views, watch
        self.moment: Moment = draw_moment(recipe, place.season, batch)
        with watch("missions"):
            self.missions = missions_of(recipe, place, batch, self.moment)

    def fly(
        self, pilot: Pilot, witness: Witness | None = None, needs: frozenset[Need] = frozenset()
    ) -> BatchRecord:
        """Fly all missions of the batch to their ends.

        Parameters
        ----------
        pilot : Pilot
        witness : callable, optional
        needs : frozenset of "depth", "thermal"
            What a witness wants to see beyond what the pilot needs.
        """
        recipe, batch, watch = self._recipe, self._batch, self._watch
        arena = Arena(self._place.obstacles, self.moment.clock, self.missions, recipe.loop)
        wanted = frozenset(pilot.needs) | needs
        eyes = Eyes(self._views, self._place, recipe.dataset, batch, self.moment, wanted, watch)
        camera, seed = self._views.camera, _pilot_seed(recipe, batch)
        reason = _began(pilot, self.missions, seed)
        while len(arena.flying):
            images = eyes.look(arena.flying, arena.poses(), arena.time_s, arena.world_time_s)
            seen = arena.observe(camera, **_shown(pilot, images))
            with watch("pilot"):
                answer = _refused(seen, reason) if reason else ask(pilot, seen, recipe.loop.patience_s)
            if witness is not None:
                witness(seen, answer, images)
            with watch("advance"):
                arena.advance(answer)
        return self._record(arena.outcomes())

    def _record(self, outcomes: tuple[Outcome, ...]) -> BatchRecord:
        missions = self.missions
        weather, season = self.moment.facts
        rows = {int(flight): k for k, flight in enumerate(missions.flight)}
        flights = []
        for outcome in outcomes:
            k = rows[outcome.flight]
            flights.append(
                FlightRecord.of(
                    outcome, missions.start_m[k], missions.goal_m[k], bool(missions.obstructed[k])
                )
            )
        return BatchRecord(self._batch.world, self.moment.hour, weather, season, tuple(flights))


def missions_of(recipe: FlightRecipe, place: Place, batch: Batch, moment: Moment) -> Missions:
    """The missions of a batch. All of a whole batch are drawn, so that a batch cut short flies the first of them."""
    rng = stream(recipe.dataset.seed, "missions", batch.map, batch.world, batch.clip)
    missions = draw_missions(
        place.airspace,
        place.obstacles,
        moment.clock,
        recipe.missions[batch.map],
        recipe.loop.radius_m,
        recipe.campaign.flights_per_batch,
        rng,
        batch.first,
    )
    return replace(missions, **{f.name: getattr(missions, f.name)[: batch.count] for f in fields(missions)})


def _pilot_seed(recipe: FlightRecipe, batch: Batch) -> int:
    rng = stream(recipe.dataset.seed, "pilot", batch.map, batch.world, batch.clip)
    return int(rng.integers(2**63))


def _began(pilot: Pilot, missions: Missions, seed: int) -> str:
    """Tell a pilot of its flights; returns the reason if it fails already there."""
    try:
        pilot.begin(missions.flight, seed)
    except Exception as error:  # foreign code: costs its flights, never the campaign
        return f"raised {type(error).__name__} at the start: {' '.join(str(error).split())[:160]}"
    return ""


def _refused(seen: Observation, reason: str) -> Answer:
    """The answer of a pilot that is not there."""
    count = len(seen.flight)
    command = Command(np.zeros((count, 3)), seen.yaw_rad.copy())
    return Answer(command, None, np.zeros(count), {int(flight): reason for flight in seen.flight})


def _shown(pilot: Pilot, images: Images | None) -> dict[str, np.ndarray | None]:
    """What this pilot may see: nobody is shown the truth who does not say so."""
    if images is None:
        return {}
    shown: dict[str, np.ndarray | None] = {}
    if "depth" in pilot.needs:
        shown["depth_m"] = images.depth_m
    if "thermal" in pilot.needs:
        shown |= {"counts": images.counts, "previous_counts": images.previous_counts}
    return shown
