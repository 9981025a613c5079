"""Point clouds for triangulations: a jittered hexagonal lattice, graded towards the distance."""

from __future__ import annotations

import numpy as np
from jaxtyping import Float64


def hexagonal(
    x0: float, y0: float, x1: float, y1: float, spacing_m: float, rng: np.random.Generator, jitter: float = 0.18
) -> Float64[np.ndarray, "points 2"]:
    """Jittered hexagonal lattice over a rectangle.

    Parameters
    ----------
    x0, y0, x1, y1 : float
        [m].
    spacing_m : float
        Distance between neighbours [m].
    rng : numpy.random.Generator
    jitter : float
        Largest shift of a point, over the spacing.
    """
    rise = spacing_m * np.sqrt(3) / 2
    x, y = np.meshgrid(np.arange(x0, x1, spacing_m), np.arange(y0, y1, rise))
    x = x + 0.5 * spacing_m * (np.arange(len(x)) % 2)[:, None]
    points = np.column_stack([x.ravel(), y.ravel()])
    return points + rng.uniform(-jitter, jitter, points.shape) * spacing_m


def graded_points(
    half_m: float, far_m: float, spacing_m: float, rng: np.random.Generator, growth: float = 2.0
) -> Float64[np.ndarray, "points 2"]:
    """Fine lattice on a square, then ever coarser square rings out to `far_m`."""
    points = [hexagonal(-half_m, -half_m, half_m, half_m, spacing_m, rng)]
    inner, spacing = half_m, spacing_m
    while inner < far_m:
        spacing = min(spacing * growth, far_m / 12)
        outer = min(inner + 5 * spacing, far_m)
        ring = hexagonal(-outer, -outer, outer, outer, spacing, rng)
        reach = np.abs(ring).max(axis=1)
        points.append(ring[(reach > inner + 0.3 * spacing) & (reach < far_m - 1.0)])
        inner = outer
    return np.concatenate(points)
