"""Corridor: along a street canyon or a lane, in the middle between what stands left and right."""

from __future__ import annotations

import math
from collections.abc import Iterator

import numpy as np
from jaxtyping import Float64, UInt8
from scipy.ndimage import uniform_filter1d

from scenegen_flythrough.airspace import ROOM_CELLS
from scenegen_flythrough.route import Route
from scenegen_flythrough.steering import free_starts
from scenegen_flythrough.styles.task import BATCH, Batch, Task, between, common, directions, over_ground

_BATCHES = 3
_STARTS = 160
_HEADINGS_RAD = np.arange(24) * (2 * np.pi / 24)
_STATION_M = 4.0
_SWAY_M = 28.0
_ENCLOSED = 0.5
"""Share of the way that must have something on both sides."""


class Corridor:
    """Low and straight on; the middle line sways with the walls."""

    def draw(self, task: Task, rng: np.random.Generator) -> Iterator[Batch]:
        """See `Style`."""
        speed_rng, height_rng, pitch_rng, *batch_rngs = rng.spawn(3 + _BATCHES)
        knobs = task.knobs
        speed, pitch = between(knobs.speed_mps, speed_rng), between(knobs.pitch_deg, pitch_rng)
        height = between(common(knobs.corridor.height_m, knobs.height_m), height_rng)
        room = task.airspace.room(height, knobs.clearance_m + 1.0)
        for batch_rng in batch_rngs:
            starts_rng, order_rng = batch_rng.spawn(2)
            beside = np.where(room < ROOM_CELLS, room, 0).astype(np.uint8)  # something stands not far away
            starts = free_starts(task.airspace, beside, knobs, _STARTS, starts_rng)
            lines = _long_lines(task, room, starts, order_rng)
            if len(lines) == 0:
                yield Batch([], BATCH)
                continue
            xy, enclosed = _centred(task, room, lines)
            good = enclosed >= _ENCLOSED
            paths = over_ground(task, xy[good], height)
            yield Batch([Route(path, speed, pitch) for path in paths], BATCH - len(paths))


def _long_lines(
    task: Task,
    room: UInt8[np.ndarray, "rows columns"],
    starts: Float64[np.ndarray, "starts 2"],
    rng: np.random.Generator,
) -> Float64[np.ndarray, "lines 4"]:
    """Straight lines of free air, as start and direction: from every start the freest way, at most a batch."""
    if len(starts) == 0:
        return np.zeros((0, 4))
    way = np.arange(0.0, task.way_m + _STATION_M, 2.0)
    turned = directions(_HEADINGS_RAD + float(rng.uniform(0.0, _HEADINGS_RAD[1])))
    seen = task.airspace.look_up(
        room, starts[:, None, None] + turned[None, :, None] * way[None, None, :, None]
    )
    free = (seen > 1).cumprod(axis=2).sum(axis=2)
    freest = np.argmax(free, axis=1)
    whole = free[np.arange(len(starts)), freest] == len(way)
    return np.concatenate([starts[whole], turned[freest[whole]]], axis=1)[:BATCH]


def _centred(
    task: Task, room: UInt8[np.ndarray, "rows columns"], lines: Float64[np.ndarray, "lines 4"]
) -> tuple[Float64[np.ndarray, "lines points 2"], Float64[np.ndarray, "lines"]]:
    """Plans in the middle between the walls, and the share of the way that has walls."""
    width = task.knobs.corridor.width_m
    start, ahead = lines[:, None, :2], lines[:, None, 2:]
    left = np.stack([-ahead[..., 1], ahead[..., 0]], axis=-1)
    stations = np.arange(math.ceil(task.way_m / _STATION_M) + 3) * _STATION_M
    spots = start + stations[None, :, None] * ahead
    across = np.arange(0.0, 0.75 * width[1] + 1.0)
    free = []
    for side in (1.0, -1.0):
        seen = task.airspace.look_up(room, spots[:, :, None] + side * across[:, None] * left[:, :, None])
        free.append((seen > 0).cumprod(axis=2).sum(axis=2).astype(np.float64))
    total = free[0] + free[1]
    walled = (total >= width[0]) & (total <= width[1]) & (np.maximum(*free) < len(across))
    weight = walled + 1e-3  # where there are no walls the line runs on as it did between the last ones
    wanted = weight * np.where(walled, np.clip(0.5 * (free[0] - free[1]), -5.0, 5.0), 0.0)
    shift = _slowly(wanted) / _slowly(weight)
    return spots + shift[..., None] * left, walled.mean(axis=1)


def _slowly(values: Float64[np.ndarray, "lines stations"]) -> Float64[np.ndarray, "lines stations"]:
    """Means over some thirty metres, twice: a drone sways with the street, not with every porch."""
    count = 2 * round(0.5 * _SWAY_M / _STATION_M) + 1
    return np.asarray(
        uniform_filter1d(
            uniform_filter1d(values, count, axis=1, mode="nearest"), count, axis=1, mode="nearest"
        )
    )
