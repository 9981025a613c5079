"""Terrain-follow: nearly straight on, close over ground, roofs and crowns, up before them and down behind."""

from __future__ import annotations

import math
from collections.abc import Iterator

import numpy as np

from scenegen_flythrough.route import Route
from scenegen_flythrough.styles.task import BATCH, Batch, Task, between, clear, directions, lifted

_BATCHES = 4
_LAYER_M = 2.0  # tops are known to a layer: that much is added above what stands there


class TerrainFollow:
    """What is too tall for `height_m` and `climb_deg` ends a draw: drones go around towers."""

    def draw(self, task: Task, rng: np.random.Generator) -> Iterator[Batch]:
        """See `Style`."""
        speed_rng, height_rng, pitch_rng, *batch_rngs = rng.spawn(3 + _BATCHES)
        knobs, air = task.knobs, task.airspace
        speed, pitch = between(knobs.speed_mps, speed_rng), between(knobs.pitch_deg, pitch_rng)
        above = max(between(knobs.terrain_follow.height_m, height_rng), knobs.clearance_m)
        along = np.arange(math.ceil(1.1 * task.way_m / task.step_m) + 3) * task.step_m
        for batch_rng in batch_rngs:
            place_rng, heading_rng, bend_rng = batch_rng.spawn(3)
            start = place_rng.uniform(air.low[:2], air.high[:2], (BATCH, 2))
            bend = bend_rng.normal(0.0, 0.004, (BATCH, 1))
            course = heading_rng.uniform(0.0, 2 * np.pi, (BATCH, 1)) + bend * along
            chords = task.step_m * directions(course[:, :-1])
            xy = start[:, None] + np.concatenate([np.zeros((BATCH, 1, 2)), np.cumsum(chords, axis=1)], axis=1)
            ground = air.world.ground.at(xy.reshape(-1, 2)).reshape(xy.shape[:2])
            tops = air.tops(xy)
            tops = np.maximum(tops, air.tops(xy + 1.5 * _left(course)))
            tops = np.maximum(tops, air.tops(xy - 1.5 * _left(course)))
            least = np.maximum(above + np.maximum(tops - _LAYER_M, 0.0), knobs.height_m[0])
            paths = lifted(xy, ground + least, math.radians(knobs.climb_deg))
            good = clear(task, paths) & ((paths[..., 2] - ground) <= knobs.height_m[1]).all(axis=1)
            yield Batch([Route(path, speed, pitch) for path in paths[good]], int((~good).sum()))


def _left(course: np.ndarray) -> np.ndarray:
    return directions(course + 0.5 * np.pi)
