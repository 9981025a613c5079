"""Points on the large triangles of a mesh, evenly enough to draw a coarse map of it."""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np
from jaxtyping import Float32, Float64, Int64, UInt32

from scenegen_flythrough.boxtree import parts

_MOST_ROWS = 1024
_AT_ONCE = 50_000


def inner_points(
    points: Float32[np.ndarray, "vertices 3"],
    faces: UInt32[np.ndarray, "faces 3"],
    step_m: float,
    box_m: tuple[Float64[np.ndarray, "3"], Float64[np.ndarray, "3"]],
) -> Iterator[Float32[np.ndarray, "samples 3"]]:
    """Points about a step apart on every triangle that is longer than a step along an axis and reaches into a box.

    Each large triangle is covered by rows parallel to its longest side, so that a tall pane costs its area, not its
    height squared. Between one and two steps the middles of the sides do, below one step the corners alone.

    Parameters
    ----------
    points : float32 (vertices, 3)
        Corners [m].
    faces : uint32 (faces, 3)
    step_m : float
        [m].
    box_m : (float64 (3,), float64 (3,))
        Lower and upper corner. Points of a triangle that reaches in may lie outside.

    Yields
    ------
    float32 (samples, 3)
        Batches of some fifty thousand points, at least one triangle each.
    """
    for part in parts(len(faces)):
        corners = points[faces[part]]
        high = np.maximum(np.maximum(corners[:, 0], corners[:, 1]), corners[:, 2])
        low = np.minimum(np.minimum(corners[:, 0], corners[:, 1]), corners[:, 2])
        longest = np.zeros(len(corners), np.float32)
        inside = np.ones(len(corners), np.bool_)
        for axis in range(3):
            longest = np.maximum(longest, high[:, axis] - low[:, axis])
            inside &= (high[:, axis] > box_m[0][axis]) & (low[:, axis] < box_m[1][axis])
        medium = corners[inside & (longest > step_m) & (longest <= 2 * step_m)]
        if len(medium):
            yield (0.5 * (medium + np.roll(medium, 1, axis=1))).reshape(-1, 3)
        yield from _rows(corners[inside & (longest > 2 * step_m)].astype(np.float64), step_m)


def _rows(
    corners: Float64[np.ndarray, "triangles 3 3"], step_m: float
) -> Iterator[Float32[np.ndarray, "samples 3"]]:
    """Rows of points parallel to each triangle's longest side, from it to the corner opposite."""
    side = np.stack([np.linalg.norm(corners[:, k - 2] - corners[:, k], axis=1) for k in range(3)], axis=1)
    base = np.argmax(side, axis=1)
    each = np.arange(len(corners))
    a, b, c = (corners[each, (base + k) % 3] for k in range(3))
    longest = np.maximum(side[each, base], 1e-9)
    width = np.linalg.norm(np.cross(b - a, c - a), axis=1) / longest
    columns = np.minimum(np.ceil(longest / step_m), _MOST_ROWS).astype(np.int64) + 1
    rows = np.minimum(np.ceil(width / step_m), _MOST_ROWS).astype(np.int64) + 1
    rows = np.maximum(rows, 2)
    counts = columns * rows
    ends = np.cumsum(counts)
    for first, last in _runs(ends, _AT_ONCE):
        pick = np.repeat(np.arange(first, last), counts[first:last])
        begin = ends[first:last] - counts[first:last]
        index = np.arange(begin[0], ends[last - 1]) - np.repeat(begin, counts[first:last])
        row, column = np.divmod(index, columns[pick])
        v = (row / (rows[pick] - 1))[:, None]
        u = (column / (columns[pick] - 1))[:, None] * (1.0 - v)
        yield (a[pick] + u * (b - a)[pick] + v * (c - a)[pick]).astype(np.float32)


def _runs(ends: Int64[np.ndarray, "items"], size: int) -> Iterator[tuple[int, int]]:
    """Consecutive ranges of items whose counts (cumulative: `ends`) add up to at most `size`, or one item."""
    first = 0
    while first < len(ends):
        done = int(ends[first - 1]) if first else 0
        last = max(int(np.searchsorted(ends, done + size, side="right")), first + 1)
        yield first, last
        first = last
