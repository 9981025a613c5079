"""The inside of a worker process: it keeps one world standing and flies batch after batch through it."""

from __future__ import annotations

import time
from collections.abc import Callable, Mapping
from dataclasses import asdict
from pathlib import Path
from typing import Any

from scenegen_datasets.stopwatch import Stopwatch
from scenegen_flythrough.loop.pilot import Pilot
from scenegen_render.camera import Camera
from scenegen_render.trace.scenery import scenery
from scenegen_render.trace.views import Views
from scenegen_trainers.campaign.place import Places
from scenegen_trainers.campaign.plan import Batch
from scenegen_trainers.campaign.recipe import FlightRecipe
from scenegen_trainers.campaign.report.plan_view import Frame, draw_plan
from scenegen_trainers.campaign.sortie import Sortie, Witness
from scenegen_trainers.campaign.store import BASE_POINT, CampaignStore
from scenegen_trainers.pilots.modules import find_modules_here
from scenegen_trainers.pilots.spec import PilotSpec, raise_pilot

Told = Callable[[dict[str, Any]], None]

_SAY_EVERY_S = 0.5
"""Between two signs of life."""


class Airfield:
    """Flies batches of one campaign; cameras, pilots and the standing world are kept from batch to batch."""

    def __init__(self) -> None:
        self.watch = Stopwatch()
        self.places = Places(self.watch)
        self._views: dict[tuple[Camera, int], Views] = {}
        self._pilots: dict[tuple[PilotSpec, str, bool], Pilot] = {}

    def sortie(self, recipe: FlightRecipe, batch: Batch) -> Sortie:
        """Get a batch ready to fly."""
        place = self.places.at(recipe.dataset, batch.map, batch.world)
        return Sortie(recipe, place, batch, self._views_of(recipe), self.watch)

    def pilot(self, spec: PilotSpec, recipe: FlightRecipe, boxed: bool = False) -> Pilot:
        """A pilot for a recipe, built once."""
        key = spec, recipe.loop.model_dump_json() + recipe.dataset.camera.model_dump_json(), boxed
        if key not in self._pilots:
            with self.watch("pilot setup"):
                camera = recipe.dataset.camera.camera()
                self._pilots[key] = raise_pilot(spec, recipe.loop, camera, boxed=boxed)
        return self._pilots[key]

    def plan(self, recipe: FlightRecipe, batch: Batch) -> tuple[bytes, dict[str, Any]]:
        """A map of a batch's world for the report, and where its camera stands."""
        place = self.places.at(recipe.dataset, batch.map, batch.world)
        picture = draw_plan(place.world, scenery(place.loaded), 0.0)
        return picture, asdict(Frame.of(place.world))

    def _views_of(self, recipe: FlightRecipe) -> Views:
        camera, tracing = recipe.dataset.camera.camera(), recipe.dataset.render
        key = camera, tracing.sub_samples
        if key not in self._views:
            self._views[key] = Views(camera, tracing)
        return self._views[key]


def worker(setup: Mapping[str, Any]) -> Callable[[dict[str, Any], Told], dict[str, Any]]:
    """Factory for `scenegen.foundation.pool.Pool`: an airfield in a process of its own."""
    settle(setup["path"])
    recipes = {name: FlightRecipe.model_validate(plain) for name, plain in setup["points"].items()}
    pilots = [PilotSpec(**plain) for plain in setup["pilots"]]
    store, airfield = CampaignStore(Path(setup["root"])), Airfield()

    def fly(payload: dict[str, Any], told: Told) -> dict[str, Any]:
        recipe, spec = recipes[payload["point"]], pilots[payload["pilot"]]
        batch = Batch(**payload["batch"])
        told({"stage": f"{batch.map} {batch.world}"})
        sortie = airfield.sortie(recipe, batch)
        if payload["point"] == BASE_POINT and store.read_plan(batch.map, batch.world) is None:
            with airfield.watch("plan"):
                store.commit_plan(batch.map, batch.world, *airfield.plan(recipe, batch))
        record = sortie.fly(airfield.pilot(spec, recipe, payload["boxed"]), _sign_of_life(told))
        store.commit(payload["point"], spec.slug, batch, record)
        decisions = sum(flight.decisions for flight in record.flights)
        return {"flights": len(record.flights), "decisions": decisions, "stages": airfield.watch.take()}

    return fly


def check_pilot(spec: PilotSpec, recipe: FlightRecipe) -> None:
    """Build a pilot and forget it: what is wrong with its file is said before any world is built."""
    if spec.kind != "name":
        raise_pilot(spec, recipe.loop, recipe.dataset.camera.camera())


def settle(path: str) -> None:
    """One thread for everything; modules of the user's own directory can be imported."""
    import cv2

    from scenegen_render import backend

    find_modules_here(path)
    cv2.setNumThreads(1)
    backend.set_threads(1)


def _sign_of_life(told: Told) -> Witness:
    """Says now and then how many drones are in the air."""
    last = -_SAY_EVERY_S

    def witness(seen: Any, answer: Any, images: Any) -> None:
        nonlocal last
        now = time.monotonic()
        if now - last >= _SAY_EVERY_S:
            last = now
            told({"flying": len(seen.flight)})

    return witness
