"""Footprints: rectangle, L, U, T, stepped slab and courtyard, laid into a rectangle of a lot's frame."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
import shapely
from jaxtyping import Float64

Ring = list[tuple[float, float]]
Shape = Callable[[float, float, np.random.Generator], Ring]


def _rectangle(a: float, b: float, rng: np.random.Generator) -> Ring:
    return [(0, 0), (a, 0), (a, b), (0, b)]


def _l_shape(a: float, b: float, rng: np.random.Generator) -> Ring:
    x, y = a * rng.uniform(0.38, 0.6), b * rng.uniform(0.38, 0.6)
    return [(0, 0), (a, 0), (a, y), (x, y), (x, b), (0, b)]


def _u_shape(a: float, b: float, rng: np.random.Generator) -> Ring:
    left, right, y = a * rng.uniform(0.26, 0.34), a * rng.uniform(0.66, 0.74), b * rng.uniform(0.35, 0.5)
    return [(0, 0), (a, 0), (a, b), (right, b), (right, y), (left, y), (left, b), (0, b)]


def _t_shape(a: float, b: float, rng: np.random.Generator) -> Ring:
    left, right, y = a * rng.uniform(0.2, 0.33), a * rng.uniform(0.64, 0.8), b * rng.uniform(0.45, 0.6)
    return [(0, 0), (a, 0), (a, y), (right, y), (right, b), (left, b), (left, y), (0, y)]


def _stepped(a: float, b: float, rng: np.random.Generator) -> Ring:
    x, y = a * rng.uniform(0.4, 0.6), b * rng.uniform(0.18, 0.3)
    return [(0, 0), (x, 0), (x, y), (a, y), (a, b), (a - x, b), (a - x, b - y), (0, b - y)]


_SHAPES: tuple[tuple[Shape, float, float], ...] = (
    # shape, weight, smallest side [m] at which it makes sense
    (_rectangle, 0.36, 0.0),
    (_l_shape, 0.24, 16.0),
    (_u_shape, 0.16, 22.0),
    (_t_shape, 0.10, 18.0),
    (_stepped, 0.14, 16.0),
)
_COURT_SIDE_M = 27.0


def rectangle_ring(x0: float, y0: float, length_m: float, depth_m: float) -> Float64[np.ndarray, "4 2"]:
    """Counter-clockwise rectangle."""
    return np.array([[x0, y0], [x0 + length_m, y0], [x0 + length_m, y0 + depth_m], [x0, y0 + depth_m]])


def draw_rings(
    length_m: float, depth_m: float, rng: np.random.Generator
) -> list[Float64[np.ndarray, "points 2"]]:
    """Outer ring and courtyards of a footprint inside ``[0, length] x [0, depth]``, front at y = 0.

    Parameters
    ----------
    length_m, depth_m : float
    rng : numpy.random.Generator
    """
    side = min(length_m, depth_m)
    if side >= _COURT_SIDE_M and rng.uniform() < 0.45:
        wing = side * rng.uniform(0.3, 0.38)
        court = rectangle_ring(wing, wing, length_m - 2 * wing, depth_m - 2 * wing)
        return [rectangle_ring(0.0, 0.0, length_m, depth_m), court]
    weights = np.array([w if side >= least else 0.0 for _, w, least in _SHAPES])
    shape = _SHAPES[int(rng.choice(len(_SHAPES), p=weights / weights.sum()))][0]
    ring = np.array(shape(length_m, depth_m, rng), np.float64)
    if rng.uniform() < 0.5:
        ring = ring[::-1] * np.array([-1.0, 1.0]) + np.array([length_m, 0.0])
    return [ring]


def polygon_of(rings: list[Float64[np.ndarray, "points 2"]]) -> shapely.Polygon:
    """Polygon of an outer ring and courtyards."""
    return shapely.Polygon(rings[0], rings[1:])
