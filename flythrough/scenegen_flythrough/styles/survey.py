"""Survey: a lawn-mower, lane beside lane at one height, as areas are mapped."""

from __future__ import annotations

import math
from collections.abc import Iterator

import numpy as np
from jaxtyping import Float64

from scenegen_flythrough.route import Route
from scenegen_flythrough.styles.task import BATCH, Batch, Task, between, clear, directions, over_ground

_BATCHES = 3


class Survey:
    """Clips begin anywhere on the first lane, so most of them show a turn or two."""

    def draw(self, task: Task, rng: np.random.Generator) -> Iterator[Batch]:
        """See `Style`."""
        speed_rng, height_rng, pitch_rng, lane_rng, length_rng, *batch_rngs = rng.spawn(5 + _BATCHES)
        knobs, wish = task.knobs, task.knobs.survey
        speed, pitch = between(knobs.speed_mps, speed_rng), between(wish.pitch_deg, pitch_rng)
        low, high = knobs.height_m
        height = between((0.5 * (low + high), high), height_rng)  # maps are not made from among the houses
        lane, length = between(wish.lane_m, lane_rng), between(wish.length_m, length_rng)
        for batch_rng in batch_rngs:
            place_rng, heading_rng, side_rng, begin_rng = batch_rng.spawn(4)
            air = task.airspace
            corner = place_rng.uniform(air.low[:2], air.high[:2], (BATCH, 2))
            heading = heading_rng.uniform(0.0, 2 * np.pi, BATCH)
            side = np.where(side_rng.random(BATCH) < 0.5, 1.0, -1.0)
            begin = begin_rng.uniform(0.0, length, BATCH)
            along = begin[:, None] + np.arange(math.ceil(1.05 * task.way_m / task.step_m) + 3) * task.step_m
            local = _mower(along, lane, length)
            ahead, left = directions(heading)[:, None], directions(heading + 0.5 * np.pi)[:, None]
            xy = corner[:, None] + local[..., :1] * ahead + local[..., 1:] * side[:, None, None] * left
            paths = over_ground(task, xy, height)
            good = clear(task, paths)
            yield Batch([Route(path, speed, pitch) for path in paths[good]], int((~good).sum()))


def _mower(
    along: Float64[np.ndarray, "paths points"], lane_m: float, length_m: float
) -> Float64[np.ndarray, "paths points 2"]:
    """Place after a way along the lanes: along the first lane, and across to the left."""
    turn = 0.5 * math.pi * lane_m
    lane, rest = np.divmod(along, length_m + turn)
    angle = np.maximum(rest - length_m, 0.0) / (0.5 * lane_m)
    forward = np.minimum(rest, length_m) + 0.5 * lane_m * np.sin(angle)
    back = lane % 2 == 1
    across = lane * lane_m + 0.5 * lane_m * (1.0 - np.cos(angle))
    return np.stack([np.where(back, length_m - forward, forward), across], axis=-1)
