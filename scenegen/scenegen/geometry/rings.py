"""Closed rings: round an axis; in the plan their offsets with mitres, and strips along them."""

from __future__ import annotations

import numpy as np
from jaxtyping import Float64


def around(axis: Float64[np.ndarray, "3"], sides: int, turned: float = 0.0) -> Float64[np.ndarray, "sides 3"]:
    """Unit vectors across a unit axis, evenly around it; `turned` is the place of the first, in steps."""
    helper = np.array([1.0, 0.0, 0.0]) if abs(axis[2]) > 0.9 else np.array([0.0, 0.0, 1.0])
    u = np.cross(helper, axis)
    u /= np.linalg.norm(u)
    v = np.cross(axis, u)
    angle = 2 * np.pi * (np.arange(sides) + turned) / sides
    return np.asarray(np.cos(angle)[:, None] * u + np.sin(angle)[:, None] * v)


def inset(ring: Float64[np.ndarray, "points 2"], distance_m: float) -> Float64[np.ndarray, "points 2"]:
    """Ring moved to its left by a distance (outwards if negative), mitred; same number of points.

    Mitres longer than about twice the distance are cut short.
    """
    before, after = ring - np.roll(ring, 1, axis=0), np.roll(ring, -1, axis=0) - ring
    before = before / np.linalg.norm(before, axis=1)[:, None]
    after = after / np.linalg.norm(after, axis=1)[:, None]
    half = (before + after) / 2
    left = np.column_stack([-half[:, 1], half[:, 0]])
    return np.asarray(ring + left * (distance_m / np.maximum((left**2).sum(axis=1), 0.2))[:, None])


def strip(
    below: Float64[np.ndarray, "points 2"],
    below_m: float,
    above: Float64[np.ndarray, "points 2"],
    above_m: float,
) -> Float64[np.ndarray, "points 4 3"]:
    """Quads between two rings of equal size at two heights, one per edge, facing the right of the rings."""
    after_below, after_above = np.roll(below, -1, axis=0), np.roll(above, -1, axis=0)
    heights = (below_m, below_m, above_m, above_m)
    plan = (below, after_below, after_above, above)
    return np.stack(
        [np.column_stack([p, np.full(len(p), h)]) for p, h in zip(plan, heights, strict=True)], axis=1
    )
