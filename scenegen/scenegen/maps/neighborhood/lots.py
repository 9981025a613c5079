"""Lots: each point of a block belongs to the frontage nearest to it, so lots fan out around dead ends by themselves.

The frontage of a block is its outline. It is cut into pieces, one per lot, never near a corner: a corner lot has both
sides. A lot is the union of the Voronoi cells of close points along its piece, and no deeper than lots usually are.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import shapely
from jaxtyping import Float64
from scipy.spatial import Voronoi, cKDTree

from scenegen.buildings.lots import Lot
from scenegen.maps.neighborhood.streets import DEEPEST, StreetPlan

_PITCH_M = 1.6
_CORNER_RAD, _WINDOW_M = 0.85, 13.0
_CORNER_SIDE = 0.86
_LEAST_AREA_M2 = 230.0
_SIMPLER_M, _GRID_M = 0.35, 0.001


@dataclass(frozen=True, eq=False)
class Division:
    """Lots and what they leave.

    Attributes
    ----------
    lots : tuple of Lot
    borders : tuple of float64 (points, 2)
        Lines between two lots, and between a lot and commons; not along streets [m].
    between : int64 (borders, 2)
        The lots on both sides of each border; -1 for commons.
    """

    lots: tuple[Lot, ...]
    borders: tuple[Float64[np.ndarray, "_ 2"], ...]
    between: np.ndarray


def divide(plan: StreetPlan, width_m: float, depth_m: float, rng: np.random.Generator) -> Division:
    """Divide all blocks.

    Parameters
    ----------
    plan : StreetPlan
    width_m, depth_m : float
        Usual size of a lot.
    rng : numpy.random.Generator
    """
    rings = [plan.front.exterior, *plan.front.interiors]
    fronts = [_frontage(_block_left(r, outer=r is rings[0]), width_m, rng) for r in rings]
    first = np.cumsum([0, *(int(owner.max()) + 1 for _, owner in fronts)])
    points = np.concatenate([xy for xy, _ in fronts])
    owner = np.concatenate([mine + start for (_, mine), start in zip(fronts, first[:-1], strict=True)])
    garden = plan.outline.difference(plan.front)
    near = plan.front.boundary.buffer(DEEPEST * depth_m, quad_segs=4).simplify(0.3)
    areas, kept = _cells(points, owner, shapely.intersection(garden, near, grid_size=_GRID_M))
    if not len(areas):
        return Division((), (), np.zeros((0, 2), np.int64))
    simple = shapely.coverage_simplify(areas, _SIMPLER_M, simplify_boundary=False)
    lots = tuple(_lot(area, points[owner == k]) for area, k in zip(simple, kept, strict=True))
    borders, between = _borders(np.array([lot.area for lot in lots], dtype=object), plan)
    return Division(lots, borders, between)


def _block_left(ring: shapely.LinearRing, outer: bool) -> np.ndarray:
    """The points of a ring, closed, with the block on its left."""
    xy = shapely.get_coordinates(ring)
    return np.asarray(xy if bool(shapely.is_ccw(ring)) != outer else xy[::-1])


def _frontage(ring: np.ndarray, width_m: float, rng: np.random.Generator) -> tuple[np.ndarray, np.ndarray]:
    """Close points along a block's outline, and the lot each belongs to."""
    line = shapely.LineString(ring)
    count = max(int(line.length / _PITCH_M), 12)
    place = (np.arange(count) + 0.5) * (line.length / count)
    points = shapely.get_coordinates(shapely.line_interpolate_point(line, place))
    corners = _corners(points, place)
    side = _CORNER_SIDE * width_m
    cuts: list[float] = []
    if not len(corners):
        corners = np.array([0.0])
    after = np.append(corners[1:], corners[0] + line.length)
    for a, b in zip(corners, after, strict=True):
        room = b - a - 2 * side
        if room < 0.7 * width_m:
            cuts.append((a + b) / 2 if b - a > 1.1 * side else a + min(side, 0.8 * (b - a)))
            continue
        pieces = max(round(room / (width_m * rng.uniform(0.88, 1.12))), 1)
        steps = np.cumsum(rng.uniform(0.85, 1.15, pieces))
        cuts += [a + side, *(a + side + room * steps / steps[-1])]
    marks = np.sort(np.mod(cuts, line.length))
    return points, np.searchsorted(marks, place) % len(marks)


def _corners(points: np.ndarray, place: np.ndarray) -> np.ndarray:
    """Distances at which the outline turns sharply to the left: corners of the block."""
    step = np.roll(points, -1, axis=0) - points
    heading = np.arctan2(step[:, 1], step[:, 0])
    turn = np.angle(np.exp(1j * (heading - np.roll(heading, 1))))
    reach = max(int(_WINDOW_M / _PITCH_M / 2), 1)
    window = sum(np.roll(turn, s) for s in range(-reach, reach + 1))
    wide = np.max([np.roll(window, s) for s in range(-2 * reach, 2 * reach + 1)], axis=0)
    peaks = np.flatnonzero((window > _CORNER_RAD) & (window >= wide - 1e-12))
    if not len(peaks):
        return np.zeros(0)
    keep = np.concatenate([[True], np.diff(place[peaks]) > _WINDOW_M])
    return np.asarray(place[peaks[keep]])


def _cells(points: np.ndarray, owner: np.ndarray, room: shapely.Geometry) -> tuple[np.ndarray, np.ndarray]:
    """Areas of the lots that are large enough, and their numbers; they touch along common lines exactly."""
    far = np.abs(points).max() * 8 * np.array([[-1, -1], [1, -1], [1, 1], [-1, 1]])
    diagram = Voronoi(np.concatenate([points, far]))
    owners = np.append(owner, np.full(len(far), -1))
    a, b = owners[diagram.ridge_points].T
    edges = np.array(diagram.ridge_vertices)[(a != b) & (a >= 0) & (b >= 0)]
    walls = shapely.linestrings(diagram.vertices[edges])
    shapely.prepare(room)
    walls = walls[shapely.intersects(room, walls)]
    noded = shapely.union_all(np.append(walls, shapely.boundary(room)), grid_size=_GRID_M)
    faces = shapely.get_parts(shapely.polygonize(shapely.get_parts(noded)))
    inside = shapely.point_on_surface(faces)
    keep = shapely.intersects(room, inside) & (shapely.area(faces) > _LEAST_AREA_M2)
    faces, inside = faces[keep], inside[keep]
    number = owner[cKDTree(points).query(shapely.get_coordinates(inside))[1]]
    order = np.lexsort((-shapely.area(faces), number))
    largest = order[np.concatenate([[True], np.diff(number[order]) > 0])] if len(order) else order
    return faces[largest], number[largest]


def _lot(area: shapely.Polygon, front: np.ndarray) -> Lot:
    """A lot seen from the street: along the straightest third of its frontage, the middle one first."""
    if len(front) > 2 and np.linalg.norm(np.diff(front, axis=0), axis=1).max() > 4 * _PITCH_M:
        split = int(np.argmax(np.linalg.norm(np.diff(front, axis=0), axis=1))) + 1
        front = np.concatenate([front[split:], front[:split]])  # the outline's first point lies inside
    count = len(front)
    third = max(count // 3, 2)
    starts = [s for s in ((count - third) // 2, 0, count - third) if s >= 0]
    bend = [_bend(front[s : s + third]) - (0.15 if k == 0 else 0.0) for k, s in enumerate(starts)]
    run = front[starts[int(np.argmin(bend))] :][:third]
    along = run[-1] - run[0]
    heading = float(np.arctan2(along[1], along[0]))
    unit = along / np.linalg.norm(along)
    middle = run.mean(axis=0)
    left = (front - middle) @ unit
    return Lot(area, middle + unit * left.min(), heading, float(np.ptp(left)))


def _bend(run: np.ndarray) -> float:
    if len(run) < 3:
        return 0.0
    a, b = run[1] - run[0], run[-1] - run[-2]
    return float(abs(np.arctan2(a[0] * b[1] - a[1] * b[0], a @ b)))


def _borders(areas: np.ndarray, plan: StreetPlan) -> tuple[tuple[np.ndarray, ...], np.ndarray]:
    """Lines along which lots touch each other or commons."""
    tree = shapely.STRtree(areas)
    a, b = tree.query(areas, predicate="intersects")
    a, b = a[a < b], b[a < b]
    edges = shapely.boundary(areas)
    shared = shapely.intersection(edges[a], edges[b])
    rest = shapely.difference(edges, plan.front.buffer(0.6, quad_segs=2))
    grown = shapely.union_all(shared).buffer(0.05, quad_segs=1, cap_style="flat")
    rest = shapely.difference(rest, grown)
    lines, sides = [], []
    for pieces, one, two in ((shared, a, b), (rest, np.arange(len(areas)), np.full(len(areas), -1))):
        for geometry, p, q in zip(pieces, one, two, strict=True):
            for line in _long_lines(geometry):
                lines.append(line)
                sides.append((int(p), int(q)))
    return tuple(lines), np.array(sides, np.int64).reshape(-1, 2)


def _long_lines(geometry: shapely.Geometry) -> list[np.ndarray]:
    parts = [g for g in shapely.get_parts(geometry) if g.geom_type == "LineString"]
    if not parts:
        return []
    merged = shapely.get_parts(shapely.line_merge(shapely.multilinestrings(parts)))
    return [shapely.get_coordinates(m) for m in merged if m.length > 2.5]
