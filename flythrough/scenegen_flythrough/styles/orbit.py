"""Orbit: around something that stands there, the nose on it all the time."""

from __future__ import annotations

import math
from collections.abc import Iterator

import numpy as np

from scenegen_flythrough.route import Route
from scenegen_flythrough.styles.task import BATCH, Batch, Task, between, clear, directions, over_ground

_BATCHES = 4
_TALL_M = 4.0  # what is lower is nothing to fly around
_PLACES = 256


class Orbit:
    """Flies sideways; speed is bounded by the circle like in any bend."""

    def draw(self, task: Task, rng: np.random.Generator) -> Iterator[Batch]:
        """See `Style`."""
        speed_rng, height_rng, pitch_rng, radius_rng, *batch_rngs = rng.spawn(4 + _BATCHES)
        knobs, air = task.knobs, task.airspace
        speed, height = between(knobs.speed_mps, speed_rng), between(knobs.height_m, height_rng)
        pitch, radius = between(knobs.pitch_deg, pitch_rng), between(knobs.orbit.radius_m, radius_rng)
        step = min(task.step_m, 0.15 * radius)
        turn = np.arange(math.ceil(1.05 * task.way_m / step) + 3) * (step / radius)
        for batch_rng in batch_rngs:
            place_rng, start_rng, side_rng = batch_rng.spawn(3)
            places = place_rng.uniform(air.low[:2], air.high[:2], (_PLACES, 2))
            tall = places[air.tops(places) >= max(_TALL_M, 0.4 * height)]
            centre = np.concatenate([tall, places[: max(BATCH - len(tall), 0)]])[:BATCH]
            side = np.where(side_rng.random(BATCH) < 0.5, 1.0, -1.0)
            angle = start_rng.uniform(0.0, 2 * np.pi, BATCH)[:, None] + side[:, None] * turn
            paths = over_ground(task, centre[:, None] + radius * directions(angle), height)
            good = clear(task, paths)
            good[len(tall) :] = False  # nothing stands in the middle
            routes = [
                Route(path, speed, pitch, nose_rad=inwards)
                for path, inwards in zip(paths[good], angle[good] + np.pi, strict=True)
            ]
            yield Batch(routes, BATCH - len(routes))
