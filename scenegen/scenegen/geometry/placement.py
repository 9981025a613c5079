"""Placing things in the plan: oriented rectangles, distances along lines, roads that lead out, and keeping apart."""

from __future__ import annotations

import numpy as np
import shapely
from jaxtyping import Bool, Float64


def rectangles(
    centre: Float64[np.ndarray, "items 2"],
    length_m: Float64[np.ndarray, "items"],
    width_m: Float64[np.ndarray, "items"],
    heading_rad: Float64[np.ndarray, "items"],
) -> np.ndarray:
    """Oriented rectangles as an array of shapely polygons."""
    unit = np.array([[-1, -1], [1, -1], [1, 1], [-1, 1]]) / 2
    local = unit[None] * np.stack([length_m, width_m], axis=1)[:, None, :]
    c, s = np.cos(heading_rad)[:, None], np.sin(heading_rad)[:, None]
    x = c * local[..., 0] - s * local[..., 1] + centre[:, :1]
    y = s * local[..., 0] + c * local[..., 1] + centre[:, 1:]
    return np.asarray(shapely.polygons(np.stack([x, y], axis=-1)))


def first_come(shapes: np.ndarray) -> Bool[np.ndarray, "items"]:
    """Which shapes may stay when each must not touch an earlier one that stays."""
    tree = shapely.STRtree(shapes)
    later, earlier = tree.query(shapes, predicate="intersects")
    stays = np.ones(len(shapes), bool)
    order = np.lexsort((earlier, later))
    for a, b in zip(later[order].tolist(), earlier[order].tolist(), strict=True):
        if b < a and stays[b]:
            stays[a] = False
    return stays


def clear_of(shapes: np.ndarray, obstacles: np.ndarray, gap_m: float = 0.0) -> Bool[np.ndarray, "items"]:
    """Which shapes keep a distance from all obstacles."""
    if not len(obstacles) or not len(shapes):
        return np.ones(len(shapes), bool)
    hit = shapely.STRtree(obstacles).query(shapes, predicate="dwithin", distance=gap_m)[0]
    clear = np.ones(len(shapes), bool)
    clear[hit] = False
    return clear


def along(
    line: Float64[np.ndarray, "points 2"],
    distance_m: Float64[np.ndarray, "items"],
    offset_m: Float64[np.ndarray, "items"],
) -> tuple[Float64[np.ndarray, "items 2"], Float64[np.ndarray, "items"]]:
    """Points and headings at distances along a polyline, moved to its right by an offset."""
    step = np.diff(line, axis=0)
    length = np.linalg.norm(step, axis=1)
    mark = np.concatenate([[0.0], np.cumsum(length)])
    k = np.clip(np.searchsorted(mark, distance_m, side="right") - 1, 0, len(length) - 1)
    t = (distance_m - mark[k]) / length[k]
    heading = np.arctan2(step[k, 1], step[k, 0])
    right = np.column_stack([np.sin(heading), -np.cos(heading)])
    return line[k] + step[k] * t[:, None] + right * offset_m[:, None], heading


def roads_out(
    exits: Float64[np.ndarray, "exits 2 2"],
    far_m: float,
    sway_m: float,
    bend_m: float,
    tuck_m: float,
    points: int,
) -> np.ndarray:
    """Centre lines of the roads that leave a place, as an array of shapely lines.

    Parameters
    ----------
    exits : float64 (exits, 2, 2)
        Point and unit direction in which a street leaves.
    far_m : float
        Half the side of the square that is land at all [m]; roads end beyond it.
    sway_m, bend_m : float
        How far a road bends aside, and over what way (of a radian) [m].
    tuck_m : float
        How far a road begins inside the place [m].
    points : int
        Of each line.
    """
    t = np.linspace(-tuck_m, 2.0 * far_m, points)
    lines = []
    for start, direction in exits:
        across = np.array([-direction[1], direction[0]])
        sway = sway_m * (1 - np.cos(t / bend_m)) * np.sign(start @ across + 1e-9)
        lines.append(shapely.LineString(start + t[:, None] * direction + sway[:, None] * across))
    return np.array(lines, dtype=object)
