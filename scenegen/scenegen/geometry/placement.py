"""Placing things in the plan: oriented rectangles, distances along lines, and keeping things apart."""

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
