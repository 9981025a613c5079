"""Conforming triangulation of a plane cut into regions.

Lines of the plan are noded on a fixed grid, split until every segment has an empty diametral circle, and
thrown into one Delaunay triangulation together with free points. A segment whose diametral circle is empty
is an edge of the Delaunay triangulation (Gabriel's criterion), so the result conforms to the plan without
any constrained solver, and there are no T-junctions. Triangles get their region by flood fill: components
of the dual graph cut along the plan's lines.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
import shapely
from jaxtyping import Bool, Float64, Int64
from scipy.sparse import coo_matrix
from scipy.sparse.csgraph import connected_components
from scipy.spatial import Delaunay, cKDTree

GRID_M = 0.001
"""Plan coordinates are rounded to this grid when lines are noded [m]."""

_SHORTEST_M = 0.02
_ROUNDS = 24
_NONE = np.zeros((0, 2))
_FREE_GAP, _ROW_GAP = 1.5, 1.0
"""Distance of free points and of rows from line points, in halves of the segments there."""
_ROWS_APART_M, _ROW_CLEARANCE_M = 0.5, 1.5


@dataclass(frozen=True, eq=False)
class Triangulation:
    """Triangles of the plane, counter-clockwise, with the region each belongs to (-1: outside all)."""

    points: Float64[np.ndarray, "points 2"]
    triangles: Int64[np.ndarray, "triangles 3"]
    region: Int64[np.ndarray, "triangles"]


def triangulate(
    regions: Sequence[shapely.Polygon],
    free_points: Float64[np.ndarray, "free 2"],
    line_spacing_m: float | Float64[np.ndarray, "regions"],
    far_spacing: tuple[float, float] = (1e9, 0.0),
    rows: Float64[np.ndarray, "rows 2"] = _NONE,
) -> Triangulation:
    """Triangulate a stack of polygons; where they overlap, the last one wins.

    Parameters
    ----------
    regions : sequence of shapely.Polygon
        Painted in order; holes are respected.
    free_points : float64 (free, 2)
        Points wanted inside regions, in order of preference; those too close to a line are dropped.
    line_spacing_m : float or float64 (regions,)
        Largest distance between points along the outline of each region [m]; the finest one holds where
        they meet.
    far_spacing : (float, float)
        Distance from the origin [m] beyond which the spacing along lines grows, and the growth per metre.
    rows : float64 (rows, 2)
        Points wanted in rows beside lines; they may lie nearer to a line than free points, which keep clear of them.
    """
    points, segments = _node(regions)
    spacing = _spacing(points, segments, regions, line_spacing_m)
    points, segments = _densify(points, segments, spacing, far_spacing)
    points, segments = _make_gabriel(points, segments)
    beside = _apart(_clear_free(points, segments, rows, _ROW_GAP))
    free = _clear_free(points, segments, _beyond_rows(free_points, beside), _FREE_GAP)
    everything = np.concatenate([points, beside, free])
    triangles = _delaunay(everything)
    return Triangulation(everything, triangles, _label(everything, triangles, segments, regions))


def _node(regions: Sequence[shapely.Polygon]) -> tuple[np.ndarray, np.ndarray]:
    """Unique points and segments of all region outlines, crossing only at points."""
    merged = shapely.unary_union(shapely.boundary(np.asarray(regions, dtype=object)), grid_size=GRID_M)
    lines = shapely.get_parts(merged)
    xy, line = shapely.get_coordinates(lines, return_index=True)
    key, index = np.unique(np.rint(xy / GRID_M).astype(np.int64), axis=0, return_inverse=True)
    same = line[1:] == line[:-1]
    pairs = np.sort(np.stack([index[:-1][same], index[1:][same]], axis=1), axis=1)
    pairs = np.unique(pairs[pairs[:, 0] != pairs[:, 1]], axis=0)
    return key * GRID_M, pairs


def _spacing(
    points: np.ndarray,
    segments: np.ndarray,
    regions: Sequence[shapely.Polygon],
    spacing_m: float | np.ndarray,
) -> np.ndarray:
    """Spacing wanted on each segment: the base one, or a finer one where it lies on a region's outline."""
    wanted = np.broadcast_to(np.asarray(spacing_m, np.float64), (len(regions),))
    result = np.full(len(segments), wanted.max())
    middle = shapely.points((points[segments[:, 0]] + points[segments[:, 1]]) / 2)
    for value in np.unique(wanted)[::-1][1:]:
        lines = shapely.boundary(np.asarray(regions, dtype=object)[wanted == value])
        near = shapely.STRtree(lines).query(middle, predicate="dwithin", distance=2 * GRID_M)[0]
        result[near] = value
    return result


def _densify(
    points: np.ndarray, segments: np.ndarray, spacing_m: np.ndarray, far: tuple[float, float]
) -> tuple[np.ndarray, np.ndarray]:
    """Split segments into equal pieces no longer than the spacing wanted where they lie."""
    a, b = points[segments[:, 0]], points[segments[:, 1]]
    reach = np.linalg.norm((a + b) / 2, axis=1) - np.linalg.norm(b - a, axis=1) / 2
    wanted = spacing_m + np.maximum(reach - far[0], 0.0) * far[1]
    pieces = np.maximum(np.ceil(np.linalg.norm(b - a, axis=1) / wanted - 1e-9).astype(np.int64), 1)
    return _split(points, segments, pieces)


def _split(points: np.ndarray, segments: np.ndarray, pieces: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Cut each segment into `pieces` equal parts."""
    item = np.repeat(np.arange(len(segments)), pieces - 1)
    start = np.concatenate([[0], np.cumsum(pieces - 1)])
    step = np.arange(len(item)) - start[item] + 1
    t = (step / pieces[item])[:, None]
    new = points[segments[item, 0]] * (1 - t) + points[segments[item, 1]] * t
    piece_item = np.repeat(np.arange(len(segments)), pieces)
    piece_start = np.concatenate([[0], np.cumsum(pieces)])
    k = np.arange(len(piece_item)) - piece_start[piece_item]
    inner = len(points) + start[piece_item] + k
    first = np.where(k == 0, segments[piece_item, 0], inner - 1)
    last = np.where(k == pieces[piece_item] - 1, segments[piece_item, 1], inner)
    return np.concatenate([points, new]), np.stack([first, last], axis=1)


def _make_gabriel(points: np.ndarray, segments: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Split segments whose diametral circle holds a line point."""
    first, start = cKDTree(points), len(points)
    middle, radius = _circles(points, segments)
    nearest, _ = first.query(middle)
    for _ in range(_ROUNDS):
        bad = (nearest < radius - 1e-7) & (radius > _SHORTEST_M)
        if not bad.any():
            break
        before = len(points)
        points, segments = _split(points, segments, 1 + bad.astype(np.int64))
        middle, radius = _circles(points, segments)
        # A whole segment was clear of all older points; halves have to ask for those again.
        nearest, _ = cKDTree(points[before:]).query(middle, distance_upper_bound=float(radius.max()))
        half = segments.max(axis=1) >= before
        for older in (first, cKDTree(points[start:])):
            nearest[half] = np.minimum(nearest[half], older.query(middle[half])[0])
    return points, segments


def _clear_free(points: np.ndarray, segments: np.ndarray, free: np.ndarray, gap: float) -> np.ndarray:
    """Free points outside all diametral circles, and not within `gap` half-segments of any line point."""
    if not len(free):
        return free
    middle, radius = _circles(points, segments)
    reach = np.zeros(len(points))
    np.maximum.at(reach, segments.ravel(), np.repeat(radius, 2))
    distance, index = cKDTree(points).query(free)
    free = free[distance > np.maximum(gap * reach[index], 0.3)]
    if not len(free):
        return free
    nearest, _ = cKDTree(free).query(middle)
    close = nearest < radius + 1e-7
    inside = cKDTree(free).query_ball_point(middle[close], radius[close] + 1e-7)
    return np.delete(free, np.unique([k for hits in inside for k in hits]).astype(np.int64), axis=0)


def _apart(rows: np.ndarray) -> np.ndarray:
    """Row points without those that nearly meet an earlier one, where rows of neighbours cross."""
    pairs = cKDTree(rows).query_pairs(_ROWS_APART_M, output_type="ndarray") if len(rows) else _NONE
    return np.delete(rows, np.unique(pairs.max(axis=1).astype(np.int64)), axis=0) if len(pairs) else rows


def _beyond_rows(free: np.ndarray, rows: np.ndarray) -> np.ndarray:
    """Free points that keep their distance from row points."""
    if len(rows) < 2:
        return free
    tree = cKDTree(rows)
    apart = tree.query(rows, k=2)[0][:, 1]
    distance, index = tree.query(free)
    return np.asarray(free[distance > np.minimum(apart[index], _ROW_CLEARANCE_M)])


def _circles(points: np.ndarray, segments: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    a, b = points[segments[:, 0]], points[segments[:, 1]]
    return (a + b) / 2, np.linalg.norm(b - a, axis=1) / 2


def _delaunay(points: np.ndarray) -> np.ndarray:
    """Delaunay triangles, counter-clockwise, in an order that does not depend on the library's traversal.

    GEOS answers in coordinates, which are those put in, to the bit: sorting finds their indices. It takes half the
    time of Qhull, and its predicates are exact.
    """
    try:
        triangles = _by_geos(points)
    except (
        shapely.GEOSException
    ):  # it walks from triangle to triangle and, once in some hundred worlds, loses its way
        triangles = Delaunay(points).simplices.astype(np.int64)
    a, b, c = (points[triangles[:, k]] for k in range(3))
    doubled = (b[:, 0] - a[:, 0]) * (c[:, 1] - a[:, 1]) - (b[:, 1] - a[:, 1]) * (c[:, 0] - a[:, 0])
    triangles[doubled < 0] = triangles[doubled < 0][:, [0, 2, 1]]
    lowest = np.argmin(triangles, axis=1)[:, None]
    triangles = np.take_along_axis(triangles, (lowest + np.arange(3)) % 3, axis=1)
    return np.asarray(triangles[np.argsort(triangles[:, 0] * len(points) + triangles[:, 1], kind="stable")])


def _by_geos(points: np.ndarray) -> np.ndarray:
    """Corners of the Delaunay triangles that GEOS finds."""
    rings = shapely.get_coordinates(shapely.delaunay_triangles(shapely.linestrings(points)))
    corners = rings.reshape(-1, 4, 2)[:, :3]
    key = np.ascontiguousarray(points, np.float64).view(np.complex128).ravel()
    order = np.argsort(key, kind="stable")
    found = np.searchsorted(key[order], np.ascontiguousarray(corners).view(np.complex128).ravel())
    return np.asarray(order[found].reshape(-1, 3))


def _label(
    points: np.ndarray, triangles: np.ndarray, segments: np.ndarray, regions: Sequence[shapely.Polygon]
) -> np.ndarray:
    """Region of each triangle: flood fill bounded by the plan's lines, one query per component."""
    edge = np.sort(triangles[:, [0, 1, 1, 2, 2, 0]].reshape(-1, 2), axis=1)
    code = edge[:, 0] * len(points) + edge[:, 1]
    walls = np.sort(segments, axis=1)
    blocked = _member(code, np.sort(walls[:, 0] * len(points) + walls[:, 1]))
    owner = np.repeat(np.arange(len(triangles)), 3)
    order = np.argsort(code, kind="stable")
    pair = code[order][1:] == code[order][:-1]
    left, right = order[:-1][pair], order[1:][pair]
    open_edge = ~blocked[left]
    a, b = owner[left[open_edge]], owner[right[open_edge]]
    graph = coo_matrix((np.ones(len(a), np.int8), (a, b)), shape=(len(triangles), len(triangles)))
    _, component = connected_components(graph, directed=False)
    return np.asarray(_component_regions(points, triangles, component, regions)[component])


def _member(values: np.ndarray, ordered: np.ndarray) -> Bool[np.ndarray, "values"]:
    """Whether each value occurs in a sorted array."""
    place = np.minimum(np.searchsorted(ordered, values), len(ordered) - 1)
    return np.asarray(ordered[place] == values)


def _component_regions(
    points: np.ndarray, triangles: np.ndarray, component: np.ndarray, regions: Sequence[shapely.Polygon]
) -> np.ndarray:
    """Topmost region at the in-centre of the roundest triangle of each component."""
    a, b, c = (points[triangles[:, k]] for k in range(3))
    la, lb, lc = (np.linalg.norm(d, axis=1) for d in (b - c, c - a, a - b))
    around = la + lb + lc
    centre = (la[:, None] * a + lb[:, None] * b + lc[:, None] * c) / around[:, None]
    doubled = np.abs((b[:, 0] - a[:, 0]) * (c[:, 1] - a[:, 1]) - (b[:, 1] - a[:, 1]) * (c[:, 0] - a[:, 0]))
    radius = doubled / around
    order = np.lexsort((radius, component))
    last = np.concatenate([component[order][1:] != component[order][:-1], [True]])
    best = order[last]
    tree = shapely.STRtree(np.asarray(regions, dtype=object))
    which, region = tree.query(shapely.points(centre[best]), predicate="intersects")
    result = np.full(len(best), -1, np.int64)
    np.maximum.at(result, which, region)
    return result
