"""Crown outlines: how wide at each height, what lies inside, how far a branch may grow."""

from __future__ import annotations

import numpy as np
from jaxtyping import Float64

from scenegen.parts.vegetation.habits import Outline

_SAMPLES = 24
_NARROWEST = 0.04


def half_width(outline: Outline, z: Float64[np.ndarray, "*any"]) -> Float64[np.ndarray, "*any"]:
    """Half-width of the outline at heights z (both as shares of the tree's height); zero above and below it."""
    t = (z - outline.base) / (1.0 - outline.base)
    below = (outline.widest - t) / max(outline.widest, 1e-6)
    above = (t - outline.widest) / max(1.0 - outline.widest, 1e-6)
    away = np.clip(np.maximum(below, above), 0.0, 1.0)
    inside = (t >= 0.0) & (t <= 1.0)
    width = (1.0 - away**outline.roundness) ** (1.0 / outline.roundness)
    return np.asarray(outline.radius * np.where(inside, np.maximum(width, _NARROWEST), 0.0))


def side_area(outline: Outline) -> float:
    """Area of the outline seen from the side, for a tree of unit height."""
    z = np.linspace(outline.base, 1.0, 200)
    return float(2.0 * half_width(outline, z).mean() * (1.0 - outline.base))


def room(
    outline: Outline, start: Float64[np.ndarray, "rays 3"], direction: Float64[np.ndarray, "rays 3"]
) -> Float64[np.ndarray, "rays"]:
    """Distance from points inside the crown to where rays leave it; marched in steps, so good to some per cent."""
    step = np.linspace(0.0, 1.0, _SAMPLES + 1)[1:] * max(2.0 * outline.radius, 1.0 - outline.base)
    points = start[:, None, :] + direction[:, None, :] * step[None, :, None]
    inside = np.hypot(points[..., 0], points[..., 1]) < half_width(outline, points[..., 2])
    reached = np.where(np.logical_and.accumulate(inside, axis=1), step, 0.0).max(axis=1)
    return np.asarray(np.maximum(reached, 0.4 * step[0]))


def pull_inside(
    outline: Outline, points: Float64[np.ndarray, "points 3"], share: float = 1.0
) -> Float64[np.ndarray, "points 3"]:
    """Points moved horizontally and down until they lie inside the outline, narrowed to a share of its width."""
    moved = points.copy()
    moved[:, 2] = np.clip(points[:, 2], outline.base, 0.995)
    reach = np.hypot(moved[:, 0], moved[:, 1])
    moved[:, :2] *= np.minimum(share * half_width(outline, moved[:, 2]) / np.maximum(reach, 1e-9), 1.0)[
        :, None
    ]
    return moved
