"""Exact squared distances between points, segments and triangles, pair by pair.

A convex quadratic on a polygon is smallest either at an interior stationary point or on the boundary, so every function
below is the minimum of its boundary's distances and of the interior candidate where one exists. Each candidate is the
distance between two real points of the two shapes: rounding can never make a result smaller than the truth by more
than its last digits, and degenerate triangles and segments need no case of their own.
"""

from __future__ import annotations

import numpy as np
from jaxtyping import Bool, Float64

_PARALLEL = 1e-12  # relative squared sine below which two lines, or a line and a plane, count as parallel


def _dot(
    a: Float64[np.ndarray, "pairs 3"], b: Float64[np.ndarray, "pairs 3"]
) -> Float64[np.ndarray, "pairs"]:
    return np.asarray(a[:, 0] * b[:, 0] + a[:, 1] * b[:, 1] + a[:, 2] * b[:, 2])


def _cross(
    a: Float64[np.ndarray, "pairs 3"], b: Float64[np.ndarray, "pairs 3"]
) -> Float64[np.ndarray, "pairs 3"]:
    # np.cross costs three times as much: it moves axes and promotes dtypes for the general case.
    out = np.empty_like(a)
    out[:, 0] = a[:, 1] * b[:, 2] - a[:, 2] * b[:, 1]
    out[:, 1] = a[:, 2] * b[:, 0] - a[:, 0] * b[:, 2]
    out[:, 2] = a[:, 0] * b[:, 1] - a[:, 1] * b[:, 0]
    return out


def _divide(a: Float64[np.ndarray, "pairs"], b: Float64[np.ndarray, "pairs"]) -> Float64[np.ndarray, "pairs"]:
    return np.asarray(np.divide(a, b, out=np.zeros_like(a), where=b > 0.0))


def point_segment(
    point: Float64[np.ndarray, "pairs 3"],
    start: Float64[np.ndarray, "pairs 3"],
    end: Float64[np.ndarray, "pairs 3"],
) -> Float64[np.ndarray, "pairs"]:
    """Squared distance [m^2] of each point to its segment; a segment of length zero is a point."""
    along = end - start
    t = np.clip(_divide(_dot(point - start, along), _dot(along, along)), 0.0, 1.0)
    gap = point - start - t[:, None] * along
    return _dot(gap, gap)


def point_triangle(
    point: Float64[np.ndarray, "pairs 3"], triangle: Float64[np.ndarray, "pairs 3 3"]
) -> Float64[np.ndarray, "pairs"]:
    """Squared distance [m^2] of each point to its triangle (corners along axis 1)."""
    a, b, c = triangle[:, 0], triangle[:, 1], triangle[:, 2]
    rim = np.minimum(point_segment(point, a, b), point_segment(point, b, c))
    rim = np.minimum(rim, point_segment(point, c, a))
    return np.asarray(np.minimum(rim, _point_face(point, a, b, c)))


def segment_triangle(
    start: Float64[np.ndarray, "pairs 3"],
    end: Float64[np.ndarray, "pairs 3"],
    triangle: Float64[np.ndarray, "pairs 3 3"],
) -> Float64[np.ndarray, "pairs"]:
    """Squared distance [m^2] of each segment to its triangle; zero where it pierces the triangle."""
    a, b, c = triangle[:, 0], triangle[:, 1], triangle[:, 2]
    best = np.minimum(point_triangle(start, triangle), point_triangle(end, triangle))
    for first, second in ((a, b), (b, c), (c, a)):
        best = np.minimum(best, point_segment(first, start, end))
        best = np.minimum(best, _between_lines(start, end, first, second))
    return np.where(_pierces(start, end, a, b, c), 0.0, best)


def _point_face(
    point: Float64[np.ndarray, "pairs 3"],
    a: Float64[np.ndarray, "pairs 3"],
    b: Float64[np.ndarray, "pairs 3"],
    c: Float64[np.ndarray, "pairs 3"],
) -> Float64[np.ndarray, "pairs"]:
    """Squared distance to the foot of the perpendicular if it lies inside the triangle, else infinity."""
    e1, e2, r = b - a, c - a, point - a
    normal = _cross(e1, e2)
    area2 = _dot(normal, normal)
    u = _divide(_dot(_cross(r, e2), normal), area2)
    v = _divide(_dot(_cross(e1, r), normal), area2)
    gap = r - u[:, None] * e1 - v[:, None] * e2
    inside = (area2 > 0.0) & (u >= 0.0) & (v >= 0.0) & (u + v <= 1.0)
    return np.where(inside, _dot(gap, gap), np.inf)


def _between_lines(
    start: Float64[np.ndarray, "pairs 3"],
    end: Float64[np.ndarray, "pairs 3"],
    first: Float64[np.ndarray, "pairs 3"],
    second: Float64[np.ndarray, "pairs 3"],
) -> Float64[np.ndarray, "pairs"]:
    """Squared distance of two lines if the closest points lie inside both segments, else infinity."""
    d1, d2, r = end - start, second - first, start - first
    aa, bb, ab = _dot(d1, d1), _dot(d2, d2), _dot(d1, d2)
    ar, br = _dot(d1, r), _dot(d2, r)
    determinant = aa * bb - ab * ab
    s = _divide(ab * br - ar * bb, determinant)
    t = _divide(aa * br - ar * ab, determinant)
    gap = r + s[:, None] * d1 - t[:, None] * d2
    inside = (determinant > _PARALLEL * aa * bb) & (s >= 0.0) & (s <= 1.0) & (t >= 0.0) & (t <= 1.0)
    return np.where(inside, _dot(gap, gap), np.inf)


def _pierces(
    start: Float64[np.ndarray, "pairs 3"],
    end: Float64[np.ndarray, "pairs 3"],
    a: Float64[np.ndarray, "pairs 3"],
    b: Float64[np.ndarray, "pairs 3"],
    c: Float64[np.ndarray, "pairs 3"],
) -> Bool[np.ndarray, "pairs"]:
    """True where the segment passes through the triangle (not where it lies in its plane: the rim sees that)."""
    along, e1, e2, r = end - start, b - a, c - a, start - a
    normal = _cross(e1, e2)
    facing = -_dot(along, normal)
    sign, size = np.sign(facing), np.abs(facing)
    across = _cross(r, along)
    t = _dot(r, normal) * sign
    u = _dot(across, e2) * sign
    v = -_dot(across, e1) * sign
    inside = (t >= 0.0) & (t <= size) & (u >= 0.0) & (v >= 0.0) & (u + v <= size)
    steep = facing * facing > _PARALLEL * _dot(along, along) * _dot(normal, normal)
    return np.asarray(inside & steep)
