"""The street network: the plan is cut by a few arterials, then divided and divided again, and finally bent."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import shapely
from jaxtyping import Float64
from shapely.ops import split

ARTERIAL_WIDTH_M = 15.0
COLLECTOR_WIDTH_M = 11.0
SIDE_WIDTH_M = 9.0

_CHORD_M = 14.0
_CORNER_RADIUS_M = 5.0


@dataclass(frozen=True, eq=False)
class Street:
    """A street's centre line.

    Attributes
    ----------
    line : float64 (points, 2)
        [m].
    width_m : float
        Kerb to kerb.
    """

    line: Float64[np.ndarray, "points 2"]
    width_m: float


@dataclass(frozen=True, eq=False)
class StreetPlan:
    """Streets and the blocks between them (kerb lines, corners rounded)."""

    outline: shapely.Polygon
    streets: tuple[Street, ...]
    blocks: tuple[shapely.Polygon, ...]


def draw_streets(
    extent_m: float, block_area_m2: tuple[float, float], bend_m: float, rng: np.random.Generator
) -> StreetPlan:
    """Draw a network on a square around the origin.

    Parameters
    ----------
    extent_m : float
        Side of the square.
    block_area_m2 : (float, float)
        Range of the area at which division stops.
    bend_m : float
        Amplitude of the bend laid over all lines.
    rng : numpy.random.Generator
    """
    square = shapely.box(-extent_m / 2, -extent_m / 2, extent_m / 2, extent_m / 2)
    cells, cuts = _divide(square, block_area_m2, rng)
    bend = _Bend.draw(bend_m, rng)
    cells = [_bent(cell, bend) for cell in cells]
    outline = _bent(square, bend)
    ring = Street(shapely.get_coordinates(outline.exterior), COLLECTOR_WIDTH_M)
    streets = (ring, *(Street(bend(_dense(line)), width) for line, width in cuts))
    carriageway = shapely.union_all(
        [shapely.LineString(s.line).buffer(s.width_m / 2, quad_segs=4) for s in streets], grid_size=0.001
    )
    blocks = (_block(cell, carriageway) for cell in cells)
    return StreetPlan(
        outline.buffer(COLLECTOR_WIDTH_M / 2, join_style="mitre"), streets, tuple(b for b in blocks if b is not None)
    )


def _divide(
    square: shapely.Polygon, block_area_m2: tuple[float, float], rng: np.random.Generator
) -> tuple[list[shapely.Polygon], list[tuple[np.ndarray, float]]]:
    """Cells and the lines (with widths) that cut them, largest first."""
    heading = rng.uniform(0.0, np.pi)
    reach = 0.12 * np.sqrt(square.area)
    cuts: list[tuple[np.ndarray, float]] = []
    cells = [square]
    for angle in (heading, heading + rng.uniform(0.33, 0.62) * np.pi):
        cells = [piece for c in cells for piece in _cut(c, rng.uniform(-reach, reach, 2), angle, ARTERIAL_WIDTH_M, cuts)]
    done: list[shapely.Polygon] = []
    while cells:
        cell = cells.pop(0)
        if cell.area < np.exp(rng.uniform(*np.log(block_area_m2))) * 1.45:
            done.append(cell)
            continue
        middle, angle = _short_way(cell, rng)
        width = COLLECTOR_WIDTH_M if cell.area > 90e3 else SIDE_WIDTH_M
        pieces = _cut(cell, middle, angle, width, cuts)
        if len(pieces) < 2 or min(p.area for p in pieces) < 0.22 * cell.area:
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
    tilt = rng.normal(0.0, 0.07) if rng.uniform() < 0.8 else rng.uniform(-0.3, 0.3)
    return shapely.get_coordinates(cell.centroid)[0] + shift, float(np.arctan2(across[1], across[0]) + tilt)


def _cut(
    cell: shapely.Polygon, point: np.ndarray, angle: float, width_m: float, cuts: list[tuple[np.ndarray, float]]
) -> list[shapely.Polygon]:
    """Split a cell by a line; notes the part of the line inside the cell."""
    step = 3000.0 * np.array([np.cos(angle), np.sin(angle)])
    line = shapely.LineString([point - step, point + step])
    inside = shapely.intersection(line, cell)
    if inside.geom_type != "LineString" or inside.length < 20.0:
        return [cell]
    pieces = [g for g in split(cell, line).geoms if g.area > 1.0]
    if len(pieces) == 2 and min(p.area for p in pieces) >= 0.05 * cell.area:
        cuts.append((shapely.get_coordinates(inside), width_m))
        return pieces
    return [cell]


@dataclass(frozen=True, eq=False)
class _Bend:
    """A smooth displacement of the plane, so that streets and blocks bend together."""

    wave_vector: np.ndarray
    phase: np.ndarray
    shift_m: np.ndarray

    @staticmethod
    def draw(amplitude_m: float, rng: np.random.Generator) -> _Bend:
        length = rng.uniform(320.0, 620.0, 4)
        heading = rng.uniform(0.0, 2 * np.pi, 4)
        vector = (2 * np.pi / length)[:, None] * np.column_stack([np.cos(heading), np.sin(heading)])
        direction = rng.uniform(0.0, 2 * np.pi, 4)
        shift = 0.6 * amplitude_m * np.column_stack([np.cos(direction), np.sin(direction)])
        return _Bend(vector, rng.uniform(0.0, 2 * np.pi, 4), shift)

    def __call__(self, xy: np.ndarray) -> np.ndarray:
        angle = xy[:, :1] * self.wave_vector[:, 0] + xy[:, 1:] * self.wave_vector[:, 1] + self.phase
        wave = np.sin(angle)
        return xy + np.column_stack([(wave * self.shift_m[:, k]).sum(axis=1) for k in (0, 1)])


def _dense(xy: np.ndarray) -> np.ndarray:
    return np.asarray(shapely.get_coordinates(shapely.segmentize(shapely.LineString(xy), _CHORD_M)))


def _bent(polygon: shapely.Polygon, bend: _Bend) -> shapely.Polygon:
    return shapely.Polygon(bend(_dense(shapely.get_coordinates(polygon.exterior))))


def _block(cell: shapely.Polygon, carriageway: shapely.Geometry) -> shapely.Polygon | None:
    """What streets leave of a cell, corners rounded; None where too little is left."""
    rest = cell.difference(carriageway)
    rounded = rest.buffer(-_CORNER_RADIUS_M, join_style="mitre").buffer(_CORNER_RADIUS_M, quad_segs=3)
    pieces = [g for g in getattr(rounded, "geoms", [rounded]) if g.area > 400.0]
    if not pieces:
        return None
    largest = max(pieces, key=lambda g: g.area)
    return shapely.Polygon(largest.exterior).simplify(0.15)
