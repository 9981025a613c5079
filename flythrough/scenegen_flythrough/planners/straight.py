"""Heads for the goal whatever it sees: the floor that every other planner must rise above."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from jaxtyping import Float32, Float64

from scenegen_flythrough.loop.pilot import Command, Observation

_ARRIVAL_S = 1.0
"""Slows down over the last second of the way."""


@dataclass(frozen=True)
class Straight:
    """A straight line at cruise speed."""

    cruise_mps: float = 6.0
    name: str = "straight"

    def memory(self) -> None:
        """Remembers nothing."""

    def plan(
        self, depth_m: Float32[np.ndarray, "n rows columns"], seen: Observation, memory: Sequence[None]
    ) -> Command:
        """Fly at the goal."""
        return Command(*towards(seen, self.cruise_mps))


def towards(
    seen: Observation, speed_mps: float
) -> tuple[Float64[np.ndarray, "n 3"], Float64[np.ndarray, "n"]]:
    """Velocity and heading straight at the goal; the heading stays where the goal lies above or below."""
    way = seen.goal_m - seen.position_m
    left = np.linalg.norm(way, axis=1, keepdims=True)
    speed = np.minimum(speed_mps, left / _ARRIVAL_S)
    heading = np.where(np.hypot(way[:, 0], way[:, 1]) > 0.5, np.arctan2(way[:, 1], way[:, 0]), seen.yaw_rad)
    return way / np.maximum(left, 1e-9) * speed, heading
