"""The street network: an irregular outline, cut by arterials, divided again and again, and bent."""

from __future__ import annotations

from dataclasses import dataclass
from enum import StrEnum

import numpy as np
import shapely
from jaxtyping import Float64
from shapely.ops import split

from scenegen.maps.city.bend import Bend

KERB_M = 0.12
"""Height of sidewalks and yards above the streets [m]."""
_CORNER_RADIUS_M = 4.5
_CLEAR_OF_JUNCTION_M = 5.0
_SHORTEST_LINK_M = 22.0


class Rank(StrEnum):
    """Importance of a street."""

    ARTERIAL = "arterial"
    COLLECTOR = "collector"
    SIDE = "side"


WIDTH_M = {Rank.ARTERIAL: 15.0, Rank.COLLECTOR: 11.4, Rank.SIDE: 9.2}
"""Kerb to kerb [m]."""


@dataclass(frozen=True, eq=False)
class Street:
    """A street's centre line."""

    line: Float64[np.ndarray, "points 2"]
    rank: Rank

    @property
    def width_m(self) -> float:
        """Kerb to kerb [m]."""
        return WIDTH_M[self.rank]


@dataclass(frozen=True)
class Link:
    """A stretch of street between two junctions.

    Attributes
    ----------
    street : int
        Index into the plan's streets.
    start_m, end_m : float
        Along its centre line, clear of the kerbs of crossing streets.
    """

    street: int
    start_m: float
    end_m: float


@dataclass(frozen=True, eq=False)
class StreetPlan:
    """Streets, the links between junctions, and the blocks (kerb lines with rounded corners).

    Attributes
    ----------
    outline : shapely.Polygon
        Outer kerb of the ring road; everything detailed lies inside.
    streets : tuple of Street
    links : tuple of Link
    blocks : tuple of shapely.Polygon
    exits : float64 (exits, 2, 2)
        Where arterials leave the city, and in which direction.
    """

    outline: shapely.Polygon
    streets: tuple[Street, ...]
    links: tuple[Link, ...]
    blocks: tuple[shapely.Polygon, ...]
    exits: Float64[np.ndarray, "exits 2 2"]


def draw_streets(
    extent_m: float, block_area_m2: tuple[float, float], bend_m: float, rng: np.random.Generator
) -> StreetPlan:
    """Draw a network around the origin.

    Parameters
    ----------
    extent_m : float
        Square root of the area.
    block_area_m2 : (float, float)
        Range of the area at which division stops.
    bend_m : float
        Amplitude of the bend laid over all lines.
    rng : numpy.random.Generator
    """
    border = _outline(extent_m, rng)
    cells, cuts = _divide(border, block_area_m2, rng)
    bend = Bend.draw(bend_m, rng)
    ring = Street(shapely.get_coordinates(bend.polygon(border).exterior), Rank.COLLECTOR)
    streets = (ring, *(Street(bend.line(line), rank) for line, rank in cuts))
    carriageway = shapely.union_all(
        [shapely.LineString(s.line).buffer(s.width_m / 2, quad_segs=4) for s in streets], grid_size=0.001
    )
    blocks = (_block(bend.polygon(cell), carriageway) for cell in cells)
    outline = shapely.Polygon(ring.line).buffer(ring.width_m / 2, join_style="mitre")
    return StreetPlan(
        outline=outline,
        streets=streets,
        links=tuple(_links(streets)),
        blocks=tuple(b for b in blocks if b is not None),
        exits=_exits(streets),
    )


def _outline(extent_m: float, rng: np.random.Generator) -> shapely.Polygon:
    """An irregular decagon of the wanted area, about a square with rounded corners."""
    angle = 2 * np.pi * (np.arange(10) + rng.uniform(-0.3, 0.3, 10)) / 10 + rng.uniform(0.0, np.pi)
    tilted = angle + rng.uniform(-0.25, 0.25)
    radius = (np.abs(np.cos(tilted)) ** 3.5 + np.abs(np.sin(tilted)) ** 3.5) ** (-1 / 3.5)
    ring = np.column_stack([np.cos(angle), np.sin(angle)]) * (radius * rng.uniform(0.95, 1.06, 10))[:, None]
    return shapely.Polygon(ring * (extent_m / np.sqrt(shapely.Polygon(ring).area)))


def _divide(
    border: shapely.Polygon, block_area_m2: tuple[float, float], rng: np.random.Generator
) -> tuple[list[shapely.Polygon], list[tuple[np.ndarray, Rank]]]:
    """Cells and the lines (with ranks) that cut them, largest first."""
    heading = rng.uniform(0.0, np.pi)
    reach = 0.10 * np.sqrt(border.area)
    cuts: list[tuple[np.ndarray, Rank]] = []
    cells = [border]
    for angle in (heading, heading + rng.uniform(0.36, 0.62) * np.pi):
        point = rng.uniform(-reach, reach, 2)
        cells = [piece for c in cells for piece in _cut(c, point, angle, Rank.ARTERIAL, cuts)]
    done: list[shapely.Polygon] = []
    while cells:
        cell = cells.pop(0)
        if cell.area < np.exp(rng.uniform(*np.log(block_area_m2))) * 1.45:
            done.append(cell)
            continue
        middle, angle = _short_way(cell, rng)
        rank = Rank.COLLECTOR if cell.area > 70e3 else Rank.SIDE
        pieces = _cut(cell, middle, angle, rank, cuts)
        if len(pieces) < 2:
            done.append(cell)
        else:
            cells.extend(pieces)
    return done, cuts


def _short_way(cell: shapely.Polygon, rng: np.random.Generator) -> tuple[np.ndarray, float]:
    """A point and a heading for a street across the longer side of a cell."""
    corners = shapely.get_coordinates(cell.minimum_rotated_rectangle)
    sides = np.diff(corners[:3], axis=0)
    lengths = np.linalg.norm(sides, axis=1)
    long = int(lengths[1] > lengths[0])
    shift = sides[long] * rng.uniform(-0.13, 0.13)
    across = sides[1 - long]
    tilt = rng.normal(0.0, 0.06) if rng.uniform() < 0.8 else rng.uniform(-0.25, 0.25)
    return shapely.get_coordinates(cell.centroid)[0] + shift, float(np.arctan2(across[1], across[0]) + tilt)


def _cut(
    cell: shapely.Polygon, point: np.ndarray, angle: float, rank: Rank, cuts: list[tuple[np.ndarray, Rank]]
) -> list[shapely.Polygon]:
    """Split a cell by a line and note the part inside; the cell itself if a sliver would be left."""
    step = 3000.0 * np.array([np.cos(angle), np.sin(angle)])
    line = shapely.LineString([point - step, point + step])
    inside = shapely.intersection(line, cell)
    if inside.geom_type != "LineString" or inside.length < 20.0:
        return [cell]
    pieces = [g for g in split(cell, line).geoms if g.area > 1.0]
    if len(pieces) == 2 and min(p.area for p in pieces) >= 0.2 * cell.area:
        cuts.append((shapely.get_coordinates(inside), rank))
        return pieces
    return [cell]


def _block(cell: shapely.Polygon, carriageway: shapely.Geometry) -> shapely.Polygon | None:
    """What streets leave of a cell, corners rounded; None where too little is left."""
    rest = cell.difference(carriageway)
    rounded = rest.buffer(-_CORNER_RADIUS_M, join_style="mitre").buffer(_CORNER_RADIUS_M, quad_segs=3)
    pieces = [g for g in getattr(rounded, "geoms", [rounded]) if g.area > 400.0]
    if not pieces:
        return None
    largest = max(pieces, key=lambda g: g.area)
    return shapely.Polygon(largest.exterior).simplify(0.12)


def _links(streets: tuple[Street, ...]) -> list[Link]:
    """Stretches of each street that keep clear of all others."""
    lines = np.array([shapely.LineString(s.line) for s in streets], dtype=object)
    half = np.array([s.width_m / 2 for s in streets])
    links = []
    for k, line in enumerate(lines):
        mark = np.arange(0.5, line.length, 1.5)
        points = shapely.line_interpolate_point(line, mark)
        near = shapely.distance(line, lines) < 30.0
        near[k] = False
        other = np.flatnonzero(near)
        gap = shapely.distance(points[:, None], lines[None, other]) - half[None, other]
        clear = np.concatenate([[False], (gap > _CLEAR_OF_JUNCTION_M).all(axis=1), [False]])
        edges = np.flatnonzero(clear[1:] != clear[:-1])
        for a, b in zip(edges[::2], edges[1::2], strict=True):
            if mark[b - 1] - mark[a] > _SHORTEST_LINK_M:
                links.append(Link(k, float(mark[a]), float(mark[b - 1])))
    return links


def _exits(streets: tuple[Street, ...]) -> np.ndarray:
    """Ends of arterials on the ring road, with the direction in which they go on."""
    ring = shapely.LineString(streets[0].line)
    found = []
    for street in streets[1:]:
        if street.rank is not Rank.ARTERIAL:
            continue
        for end, before in ((street.line[0], street.line[1]), (street.line[-1], street.line[-2])):
            if ring.distance(shapely.Point(end)) < 2.0:
                found.append([end, (end - before) / np.linalg.norm(end - before)])
    return np.array(found).reshape(-1, 2, 2)
