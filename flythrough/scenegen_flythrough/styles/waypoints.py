"""Waypoints: free exploration from one free point to the next, up, down and around."""

from __future__ import annotations

import math
from collections.abc import Iterator

import numpy as np
from jaxtyping import Bool, Float64

from scenegen_flythrough.route import Route
from scenegen_flythrough.styles.task import BATCH, Batch, Task, between, directions

_BATCHES = 3
_CHOICES = 20  # next points looked at from each
_LOOK_M = 2.0


class Waypoints:
    """Legs are straight, corners are rounded and flown slowly; every leg is free on the coarse map."""

    def draw(self, task: Task, rng: np.random.Generator) -> Iterator[Batch]:
        """See `Style`."""
        speed_rng, pitch_rng, *batch_rngs = rng.spawn(2 + _BATCHES)
        knobs = task.knobs
        speed, pitch = between(knobs.speed_mps, speed_rng), between(knobs.pitch_deg, pitch_rng)
        for batch_rng in batch_rngs:
            corners, alive = _tours(task, batch_rng)
            routes = [Route(_polyline(tour, task, speed), speed, pitch) for tour in corners[alive]]
            yield Batch(routes, BATCH - len(routes))


def _tours(
    task: Task, rng: np.random.Generator
) -> tuple[Float64[np.ndarray, "tours corners 3"], Bool[np.ndarray, "tours"]]:
    """Corners of tours, and which of them found a next point every time."""
    knobs, air, wish = task.knobs, task.airspace, task.knobs.waypoints
    legs = math.ceil(1.3 * task.way_m / wish.leg_m[0]) + 1
    start_rng, *leg_rngs = rng.spawn(1 + legs)
    here = np.empty((BATCH, 3))
    here[:, :2] = start_rng.uniform(air.low[:2], air.high[:2], (BATCH, 2))
    here[:, 2] = air.world.ground.at(here[:, :2]) + start_rng.uniform(*knobs.height_m, BATCH)
    alive = ~air.blocked(here)
    heading = start_rng.uniform(0.0, 2 * np.pi, BATCH)
    corners = [here]
    for k, leg_rng in enumerate(leg_rngs):
        sharpest = math.pi if k == 0 else math.radians(wish.turn_deg)
        turned, length, height = (leg_rng.random((BATCH, _CHOICES)) for _ in range(3))
        angle = heading[:, None] + sharpest * (2.0 * turned - 1.0)
        leg = wish.leg_m[0] + length * (wish.leg_m[1] - wish.leg_m[0])
        there = np.empty((BATCH, _CHOICES, 3))
        there[..., :2] = here[:, None, :2] + leg[..., None] * directions(angle)
        ground = air.world.ground.at(there[..., :2].reshape(-1, 2)).reshape(leg.shape)
        wanted = ground + knobs.height_m[0] + height * (knobs.height_m[1] - knobs.height_m[0])
        climb = leg * math.tan(math.radians(knobs.climb_deg))
        there[..., 2] = np.clip(wanted, here[:, None, 2] - climb, here[:, None, 2] + climb)
        free = _free_legs(task, here, there) & (there[..., 2] - ground >= knobs.height_m[0])
        choice = np.argmax(free, axis=1)  # the first free one: choices come in random order
        each = np.arange(BATCH)
        alive &= free[each, choice]
        here, heading = there[each, choice], angle[each, choice]
        corners.append(here)
    return np.stack(corners, axis=1), alive


def _free_legs(
    task: Task, here: Float64[np.ndarray, "tours 3"], there: Float64[np.ndarray, "tours choices 3"]
) -> Bool[np.ndarray, "tours choices"]:
    count = math.ceil(task.knobs.waypoints.leg_m[1] / _LOOK_M) + 1
    share = np.linspace(0.0, 1.0, count)[:, None]
    points = here[:, None, None] + share * (there - here[:, None])[:, :, None]
    return np.asarray(~task.airspace.blocked(points).any(axis=2))


def _polyline(
    corners: Float64[np.ndarray, "corners 3"], task: Task, speed_mps: float
) -> Float64[np.ndarray, "points 3"]:
    """Points along the legs, as long as the task needs; the faster, the wider apart: that rounds the corners more."""
    legs = np.linalg.norm(np.diff(corners, axis=0), axis=1)
    way = np.concatenate([[0.0], np.cumsum(legs)])
    step = max(task.step_m, min(0.4 * speed_mps, 0.2 * task.knobs.waypoints.leg_m[0] + 2.0))
    along = np.arange(0.0, min(1.25 * task.way_m + 6.0 * step, way[-1]), step)
    return np.stack([np.interp(along, way, column) for column in corners.T], axis=1)
