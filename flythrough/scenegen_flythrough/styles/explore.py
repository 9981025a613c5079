"""Explore: wander on, look ahead, turn towards the free side."""

from __future__ import annotations

import math
from collections.abc import Iterator

import numpy as np

from scenegen_flythrough.knobs import FlightKnobs
from scenegen_flythrough.route import Route
from scenegen_flythrough.steering import Intent, wander
from scenegen_flythrough.styles.task import BATCH, Batch, Task, between

_BATCHES = 4


def draw_intent(knobs: FlightKnobs, rng: np.random.Generator) -> Intent:
    """Speed, height and camera angle of one flight, each with a generator of its own."""
    speed, height, pitch = rng.spawn(3)
    return Intent(
        between(knobs.speed_mps, speed), between(knobs.height_m, height), between(knobs.pitch_deg, pitch)
    )


class Explore:
    """Low flights between houses are as likely as the easy ones above the roofs."""

    def draw(self, task: Task, rng: np.random.Generator) -> Iterator[Batch]:
        """See `Style`."""
        intent_rng, *batch_rngs = rng.spawn(1 + _BATCHES)
        intent = draw_intent(task.knobs, intent_rng)
        margin = max(task.knobs.clearance_m, 0.1 * intent.height_m) + 1.0
        room = task.airspace.room(intent.height_m, margin)
        shape = (BATCH, max(math.ceil(task.way_m / task.step_m) + 2, 4), task.step_m)
        for batch_rng in batch_rngs:
            paths = wander(task.airspace, room, task.knobs, intent, None, shape, batch_rng)
            routes = [Route(path, intent.speed_mps, intent.mount_pitch_deg) for path in paths]
            yield Batch(routes, BATCH - len(routes))
