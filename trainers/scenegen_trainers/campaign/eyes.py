"""What drones see: all their views in one launch, and a thermal camera of its own for each."""

from __future__ import annotations

from collections.abc import Collection
from dataclasses import dataclass

import numpy as np
from jaxtyping import Float32, Float64, Int64, UInt16

from scenegen.foundation.rng import stream
from scenegen_datasets.recipe import Recipe
from scenegen_datasets.stopwatch import Stopwatch
from scenegen_flythrough.loop.pilot import Need
from scenegen_render.bake import bake
from scenegen_render.camera import Camera
from scenegen_render.sensor.flock import Flock
from scenegen_render.trace.lit import light
from scenegen_render.trace.scenery import Scenery, scenery
from scenegen_render.trace.views import Layer, Views
from scenegen_trainers.campaign.moment import Moment
from scenegen_trainers.campaign.place import Place
from scenegen_trainers.campaign.plan import Batch


@dataclass(frozen=True, eq=False)
class Images:
    """Of the drones that fly, row by row.

    Attributes
    ----------
    depth_m : float32 (n, rows, columns)
        The truth.
    counts, previous_counts : uint16 (n, rows, columns) or None
        What their cameras report now and reported at the decision before; the first frame is its own predecessor.
    """

    depth_m: Float32[np.ndarray, "n rows columns"]
    counts: UInt16[np.ndarray, "n rows columns"] | None
    previous_counts: UInt16[np.ndarray, "n rows columns"] | None


class Eyes:
    """The cameras of a batch.

    Parameters
    ----------
    views : Views
    place : Place
    recipe : Recipe
    batch : Batch
    moment : Moment
    needs : collection of "depth", "thermal"
        Heat is solved and radiance traced only for "thermal"; nothing is traced for an empty one.
    watch : Stopwatch
    """

    def __init__(
        self,
        views: Views,
        place: Place,
        recipe: Recipe,
        batch: Batch,
        moment: Moment,
        needs: Collection[Need],
        watch: Stopwatch,
    ) -> None:
        self._views, self._watch = views, watch
        self._thermal, self._blind = "thermal" in needs, not needs
        self._scenery = (
            None if self._blind else _scenery(place, recipe, moment, views.camera, self._thermal, watch)
        )
        self._cameras = _Cameras(recipe, batch, views.camera) if self._thermal else None

    def look(
        self,
        flights: Int64[np.ndarray, "n"],
        poses: Float64[np.ndarray, "n 4 4"],
        time_s: float,
        world_time_s: float,
    ) -> Images | None:
        """Trace and sense; None where nobody looks.

        Parameters
        ----------
        flights : int64 (n,)
            Ids, increasing; only ever fewer.
        poses : float64 (n, 4, 4)
        time_s : float
            Since the start of the flights, increasing.
        world_time_s : float
        """
        if self._scenery is None:
            return None
        with self._watch("trace"):
            want: tuple[Layer, ...] = ("depth", "radiance") if self._thermal else ("depth",)
            seen = self._views.look(self._scenery, poses, world_time_s, want)
        if self._cameras is None or seen.radiance is None:
            return Images(seen.depth, None, None)
        with self._watch("sense"):
            return Images(seen.depth, *self._cameras.read(flights, seen.radiance, time_s))


class _Cameras:
    """The thermal cameras of a batch, and what each reported last."""

    def __init__(self, recipe: Recipe, batch: Batch, camera: Camera) -> None:
        rngs = {k: stream(recipe.seed, "flight", batch.map, k, "sensor") for k in batch.flights}
        self._flock = Flock(camera, recipe.sensor, rngs)
        self._before: dict[int, UInt16[np.ndarray, "rows columns"]] = {}

    def read(
        self, flights: Int64[np.ndarray, "n"], radiance: Float32[np.ndarray, "n rows columns"], time_s: float
    ) -> tuple[UInt16[np.ndarray, "n rows columns"], UInt16[np.ndarray, "n rows columns"]]:
        """Frames of now and of the reading before."""
        now = self._flock.read(flights, radiance, time_s)
        ids = flights.tolist()
        before = np.stack([self._before.get(flight, now[k]) for k, flight in enumerate(ids)])
        self._before = dict(zip(ids, now, strict=True))
        return now, before


def _scenery(
    place: Place, recipe: Recipe, moment: Moment, camera: Camera, thermal: bool, watch: Stopwatch
) -> Scenery:
    """The world's shape, or the world lit by its own heat; all movers are in it."""
    if not thermal:
        with watch("light"):
            return scenery(place.loaded)
    exposure, heat = place.exposure, place.heat
    with watch("solve"):
        state = heat.solve(moment.weather, moment.hour)
    with watch("bake"):
        irradiance = bake(place.loaded, exposure, state, camera.band_um)
    with watch("light"):
        return light(place.loaded, state, irradiance, camera.band_um, range(len(place.world.movers)))
