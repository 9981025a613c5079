"""Footprints: rectangle, L, U, courtyard, T, cross-wise stepped slab; drawn in a unit frame and laid into a rectangle."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
import shapely

Shape = Callable[[float, float, np.random.Generator], list[tuple[float, float]]]


def _rectangle(a: float, b: float, rng: np.random.Generator) -> list[tuple[float, float]]:
    return [(0, 0), (a, 0), (a, b), (0, b)]


def _l_shape(a: float, b: float, rng: np.random.Generator) -> list[tuple[float, float]]:
    x, y = a * rng.uniform(0.38, 0.6), b * rng.uniform(0.38, 0.6)
    return [(0, 0), (a, 0), (a, y), (x, y), (x, b), (0, b)]


def _u_shape(a: float, b: float, rng: np.random.Generator) -> list[tuple[float, float]]:
    left, right, y = a * rng.uniform(0.26, 0.34), a * rng.uniform(0.66, 0.74), b * rng.uniform(0.35, 0.5)
    return [(0, 0), (a, 0), (a, b), (right, b), (right, y), (left, y), (left, b), (0, b)]


def _t_shape(a: float, b: float, rng: np.random.Generator) -> list[tuple[float, float]]:
    left, right, y = a * rng.uniform(0.2, 0.33), a * rng.uniform(0.64, 0.8), b * rng.uniform(0.45, 0.6)
    return [(0, 0), (a, 0), (a, y), (right, y), (right, b), (left, b), (left, y), (0, y)]


def _stepped(a: float, b: float, rng: np.random.Generator) -> list[tuple[float, float]]:
    x, y = a * rng.uniform(0.4, 0.6), b * rng.uniform(0.18, 0.3)
    return [(0, 0), (x, 0), (x, y), (a, y), (a, b), (a - x, b), (a - x, b - y), (0, b - y)]


_SHAPES: tuple[tuple[Shape, float, float], ...] = (
    # shape, weight, smallest side [m] at which it makes sense
    (_rectangle, 0.42, 0.0),
    (_l_shape, 0.22, 15.0),
    (_u_shape, 0.14, 21.0),
    (_t_shape, 0.10, 17.0),
    (_stepped, 0.12, 15.0),
)


def draw_footprint(
    centre: np.ndarray, length_m: float, width_m: float, heading_rad: float, rng: np.random.Generator
) -> shapely.Polygon:
    """Draw a footprint inside an oriented rectangle, mirrored at random; counter-clockwise, without holes."""
    side = min(length_m, width_m)
    weights = np.array([w if side >= least else 0.0 for _, w, least in _SHAPES])
    shape = _SHAPES[int(rng.choice(len(_SHAPES), p=weights / weights.sum()))][0]
    ring = np.array(shape(length_m, width_m, rng)) - np.array([length_m, width_m]) / 2
    ring *= np.where(rng.uniform(size=2) < 0.5, -1.0, 1.0)
    c, s = np.cos(heading_rad), np.sin(heading_rad)
    return shapely.Polygon(ring @ np.array([[c, s], [-s, c]]) + centre).normalize()


def street_heading(lot: shapely.Polygon) -> float:
    """Heading of the longest side of a lot [rad]."""
    xy = shapely.get_coordinates(lot.simplify(1.0).exterior)
    sides = np.diff(xy, axis=0)
    longest = sides[int(np.argmax(np.linalg.norm(sides, axis=1)))]
    return float(np.arctan2(longest[1], longest[0]))
