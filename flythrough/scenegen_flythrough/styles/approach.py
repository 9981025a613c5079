"""Approach: head for an obstacle and stop in front of it.

The path is drawn backwards: from a place in front of something, away from it, and then flown the other way round.
"""

from __future__ import annotations

import math
from collections.abc import Iterator

import numpy as np
from jaxtyping import Float64, UInt8

from scenegen_flythrough.airspace import ROOM_CELLS
from scenegen_flythrough.route import Route
from scenegen_flythrough.steering import wander
from scenegen_flythrough.styles.explore import draw_intent
from scenegen_flythrough.styles.task import BATCH, Batch, Task, between, directions

_BATCHES = 3
_FAN_RAD = np.arange(24) * (2 * np.pi / 24)
_STOP_MPS = 0.8


class Approach:
    """Ends where the distance to the obstacle is `approach.stop_m`, at walking pace."""

    def draw(self, task: Task, rng: np.random.Generator) -> Iterator[Batch]:
        """See `Style`."""
        intent_rng, stop_rng, *batch_rngs = rng.spawn(2 + _BATCHES)
        intent = draw_intent(task.knobs, intent_rng)
        wish = task.knobs.approach
        stop_m = max(between(wish.stop_m, stop_rng), task.knobs.clearance_m + 0.5)
        room = task.airspace.room(intent.height_m, task.knobs.clearance_m + 1.0)
        shape = (BATCH, max(math.ceil(task.way_m / task.step_m) + 2, 4), task.step_m)
        left = np.arange(shape[1])[::-1] * task.step_m
        cap = np.sqrt(_STOP_MPS**2 + 2.0 * wish.brake_mps2 * left)
        for batch_rng in batch_rngs:
            starts_rng, wander_rng = batch_rng.spawn(2)
            start = _in_front(task, room, stop_m, starts_rng)
            paths = wander(task.airspace, room, task.knobs, intent, start, shape, wander_rng)
            routes = [
                Route(path[::-1].copy(), intent.speed_mps, intent.mount_pitch_deg, cap, at_end=True)
                for path in paths
            ]
            yield Batch(routes, BATCH - len(routes))


def _in_front(
    task: Task, room: UInt8[np.ndarray, "rows columns"], stop_m: float, rng: np.random.Generator
) -> tuple[Float64[np.ndarray, "places 2"], Float64[np.ndarray, "places"]]:
    """Places as far from something as asked, and the heading that leads straight away from it."""
    airspace = task.airspace
    cells = min(max(round(stop_m / airspace.cell_m) + 1, 2), ROOM_CELLS - 1)
    front = np.flatnonzero(room.ravel() == cells)
    if len(front) == 0:
        return np.zeros((0, 2)), np.zeros(0)
    xy = airspace.centre(front[rng.integers(len(front), size=BATCH)])
    fan = directions(_FAN_RAD)
    around = airspace.look_up(room, xy[:, None] + max(stop_m, 2.0) * fan).astype(np.float64)
    away = np.einsum("pk,kd->pd", around - around.mean(axis=1, keepdims=True), fan)  # where the room grows
    return xy, np.arctan2(away[:, 1], away[:, 0])
