"""Directions a drone weighs: a grid over what it sees, some to the sides and back, the goal's, and the last one's."""

from __future__ import annotations

import numpy as np
from jaxtyping import Float64

_AHEAD_DEG = np.arange(-42.0, 43.0, 6.0), np.array([-20.0, -12.0, -6.0, 0.0, 6.0, 12.0, 20.0])
_ASIDE_DEG = (
    np.array([-150.0, -120.0, -90.0, -60.0, 60.0, 90.0, 120.0, 150.0, 180.0]),
    np.array([-10.0, 0.0, 15.0]),
)


def fan(
    yaw_rad: float,
    goal: Float64[np.ndarray, "3"],
    heading: Float64[np.ndarray, "3"] | None,
) -> Float64[np.ndarray, "fan 3"]:
    """Unit vectors of the world.

    Parameters
    ----------
    yaw_rad : float
        Heading of the nose.
    goal : float64 (3,)
        Unit vector to the goal.
    heading : float64 (3,) or None
        Direction chosen last.
    """
    parts = [_grid(yaw_rad, *_AHEAD_DEG), _grid(yaw_rad, *_ASIDE_DEG), goal[None]]
    if heading is not None:
        parts.append(heading[None])
    return np.concatenate(parts)


def _grid(yaw_rad: float, aside_deg: np.ndarray, up_deg: np.ndarray) -> Float64[np.ndarray, "grid 3"]:
    turn, rise = (a.ravel() for a in np.meshgrid(yaw_rad + np.deg2rad(aside_deg), np.deg2rad(up_deg)))
    return np.stack([np.cos(turn) * np.cos(rise), np.sin(turn) * np.cos(rise), np.sin(rise)], axis=1)
