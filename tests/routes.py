"""Routes, and what was flown of them, for the tests of flights."""

from __future__ import annotations

import numpy as np

from scenegen.foundation.rng import stream
from scenegen_flythrough.quadrotor.limits import QuadrotorLimits
from scenegen_flythrough.quadrotor.motion import Motion
from scenegen_flythrough.quadrotor.pilotage import Wind, pilot
from scenegen_flythrough.route import Route
from scenegen_flythrough.trajectory import Trajectory

WINDY = Wind(np.array([5.0, -3.0]), 10.0)


def bend(step_m: float = 2.0) -> np.ndarray:
    """60 m east, then 60 m north."""
    leg = np.arange(0.0, 60.0, step_m)
    east = np.stack([leg, np.zeros_like(leg), np.full_like(leg, 20.0)], axis=1)
    north = np.stack([np.full_like(leg, 60.0), leg, np.full_like(leg, 20.0)], axis=1)
    return np.concatenate([east, north])


def motion_of(route: np.ndarray, wind: Wind = WINDY, speed: float = 12.0) -> Motion:
    motion = pilot(Route(route, speed, 0.0), wind, QuadrotorLimits(), 25.0, stream(3, "gusts"))
    assert motion is not None
    return motion


def positions(trajectory: Trajectory) -> np.ndarray:
    return trajectory.world_from_camera[:, :3, 3]


def solid_distance(boxes: np.ndarray, points: np.ndarray) -> np.ndarray:
    """Distance to solid axis-aligned boxes, by the closed form; zero inside."""
    gap = np.maximum(boxes[None, :, 0] - points[:, None], points[:, None] - boxes[None, :, 1])
    return np.linalg.norm(np.maximum(gap, 0.0), axis=2).min(axis=1)
