"""The lattice of the sea: a fine square in the middle, coarser strips and corners around it, out to the horizon.

Strips have every third line of the square only; along the seams the square's points lie on the straight lines between
those of the strips, so that there is no crack.
"""

from __future__ import annotations

import numpy as np
from jaxtyping import Float64, Int64

from scenegen.maps.coastline.shape import FAR_M

_CELLS = 150
"""Cells across half the square: 2.7 m on a square of 800 m; what is shorter, the ripples of the water show."""
_SKIP = 3
_FIRST_M, _GROWTH = 5.0, 1.065
_SITE_CELLS = 14


def sea_lattice(
    half_m: float,
) -> tuple[Float64[np.ndarray, "points 2"], Int64[np.ndarray, "quads 4"], Int64[np.ndarray, "quads"]]:
    """Points [m], quads, and the block of cells each quad belongs to, which share a thermal site.

    Parameters
    ----------
    half_m : float
        Half the side of the fine square.
    """
    inner, tail = _inner(half_m), _tail(half_m)
    axes = (-tail[::-1], inner, tail)
    points, quads, blocks = [], [], []
    first = count = 0
    for k, along_y in enumerate(axes):
        for n, along_x in enumerate(axes):
            x = along_x[::_SKIP] if n == 1 and k != 1 else along_x
            y = along_y[::_SKIP] if k == 1 and n != 1 else along_y
            east, north = (g.ravel() for g in np.meshgrid(x, y))
            i, j = (g.ravel() for g in np.meshgrid(np.arange(len(x) - 1), np.arange(len(y) - 1)))
            corner = first + j * len(x) + i
            points.append(np.column_stack([east, north]))
            quads.append(corner[:, None] + np.array([0, 1, len(x) + 1, len(x)]))
            blocks.append(count + (j // _SITE_CELLS) * len(x) + i // _SITE_CELLS)
            first, count = first + len(east), count + len(east)
    return np.concatenate(points), np.concatenate(quads), np.concatenate(blocks)


def cell_size_m(xy: Float64[np.ndarray, "points 2"], half_m: float) -> Float64[np.ndarray, "points"]:
    """Size [m] of the cells around points of the lattice."""
    beyond = np.maximum(np.abs(xy).max(axis=1) - half_m, 0.0)
    fine = half_m / _CELLS
    return np.where(beyond > 0.0, np.maximum(_SKIP * fine, _FIRST_M + (_GROWTH - 1.0) * beyond), fine)


def level_seams(
    xy: Float64[np.ndarray, "points 2"], height_m: Float64[np.ndarray, "points"], half_m: float
) -> Float64[np.ndarray, "points"]:
    """Heights [m] with those along the seams of the square interpolated between the lines of the strips."""
    height, lines = height_m.copy(), _inner(half_m)
    for axis in (0, 1):
        for side in (-half_m, half_m):
            seam = np.flatnonzero((xy[:, axis] == side) & (np.abs(xy[:, 1 - axis]) <= half_m))
            place = xy[seam, 1 - axis]
            known = np.isin(place, lines[::_SKIP])
            order = np.argsort(place[known], kind="stable")
            if known.any():
                height[seam] = np.interp(place, place[known][order], height_m[seam][known][order])
    return height


def _inner(half_m: float) -> np.ndarray:
    """Lines of the fine square, symmetrical to the last bit."""
    right = half_m * np.arange(1, _CELLS + 1) / _CELLS
    return np.concatenate([-right[::-1], [0.0], right])


def _tail(half_m: float) -> np.ndarray:
    """Lines from the edge of the square to the horizon, ever farther apart."""
    lines, width = [half_m], _FIRST_M
    while lines[-1] < FAR_M:
        lines.append(lines[-1] + width if lines[-1] + 1.5 * width < FAR_M else FAR_M)
        width *= _GROWTH
    return np.array(lines)
