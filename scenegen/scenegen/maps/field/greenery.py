"""Trees, hedges and shrubs of the detailed square: woods, field boundaries, the grounds' edges, single trees."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import shapely

from scenegen.geometry.part import Part
from scenegen.geometry.placement import clear_of, first_come
from scenegen.geometry.scatter import hexagonal
from scenegen.maps.field.country import Country, Cover
from scenegen.maps.field.grounds import Grounds
from scenegen.maps.field.terrain import pond_outline
from scenegen.maps.field.workshop import FieldWorkshop
from scenegen.parts.vegetation.plant import crown_radius_m, hedges, plant, shrubs

_BROAD = ("oak", "lime", "birch", "poplar")
_WOODS = (("oak", "birch", "lime"), ("spruce", "pine"), ("oak", "birch", "spruce", "pine"))
_TALL_M = {"oak": (9.0, 17.0), "lime": (8.0, 15.0), "birch": (8.0, 15.0), "poplar": (14.0, 24.0)}
_WOOD_TALL_M = (10.0, 18.0)
_LEAF_BUDGET = 420_000
"""Triangles that trees may have; the farthest become masses first, which nothing should fly close by."""
_HEDGES_M = 1600.0
"""Metres of hedge; nearest first, since each has sixty triangles."""
_NEAR_SHARE, _NEAR_DETAIL, _FAR_DETAIL = 0.62, 0.65, 0.25
"""Trees further out than this share of the half side have fewer triangles."""


@dataclass(frozen=True, eq=False)
class _Spots:
    """Where trees are wanted: place, species, height; how close crowns may come."""

    xy: np.ndarray
    species: np.ndarray
    height_m: np.ndarray
    spread: float


def build_greenery(
    grounds: Grounds,
    country: Country,
    obstacles: np.ndarray,
    half_m: float,
    shop: FieldWorkshop,
    rng: np.random.Generator,
) -> tuple[list[Part], int, np.ndarray]:
    """All plants near enough to be flown through, the number of trees, and places where plainer ones will do.

    The last are x, y, diameter and height of masses of trees (places, 4) beyond the budget.

    Parameters
    ----------
    grounds, country
        The plan.
    obstacles : array of shapely geometries
        What crowns and bushes keep clear of: buildings, stands, posts, vehicles.
    half_m : float
        Half the side of the detailed square.
    shop : FieldWorkshop
    rng : numpy.random.Generator
    """
    square = shapely.box(-half_m, -half_m, half_m, half_m)
    paved = _paved(grounds, country)
    hedge_lines, row_lines = _boundaries(country, square, paved, shop, rng)
    wanted = [
        _along_fence(grounds, rng),
        *(_row(line, rng) for line in row_lines),
        _singles(country, half_m, shop, rng),
        _woods(country, square, rng),
    ]
    xy, species, height, rest = _free(wanted, np.array([*obstacles, *paved], dtype=object), half_m)
    parts: list[Part] = []
    position = np.column_stack([xy, shop.relief(xy)])
    near = np.linalg.norm(xy, axis=1) < _NEAR_SHARE * half_m
    for name in sorted(set(species.tolist())):
        for mine, detail in (
            ((species == name) & near, _NEAR_DETAIL),
            ((species == name) & ~near, _FAR_DETAIL),
        ):
            if mine.any():
                parts += plant(str(name), position[mine], height[mine], shop, rng, detail)
    trunks = shapely.buffer(shapely.points(xy), 0.8)
    lines = [h for line in _nearest(hedge_lines) for h in _cut(line, [*trunks, *obstacles])]
    parts += hedges(lines, float(rng.uniform(1.3, 2.6)), float(rng.uniform(1.0, 1.6)), shop, rng)
    parts += _bushes(grounds, country, np.array([*obstacles, *paved, *trunks], dtype=object), shop, rng)
    return parts, len(xy), rest


def _paved(grounds: Grounds, country: Country) -> list[shapely.Geometry]:
    """Ground where nothing grows."""
    pitches = [p.turf.outline(1.5) for p in grounds.pitches]
    half_x, half_y = grounds.half_m
    field = grounds.frame.box(-half_x - 1.5, -half_y - 1.5, half_x + 1.5, half_y + 1.5)
    walks = [shapely.LineString(p).buffer(1.6) for p in grounds.paths]
    track = shapely.LineString(country.farm.track).buffer(2.2)
    ponds = [] if country.pond is None else [pond_outline(country.pond).buffer(0.8)]
    roads = [country.carriageway.buffer(1.6), country.drive.buffer(1.2)]
    wires = [shapely.LineString(country.road).buffer(0.1), country.corridor]
    yards = [grounds.car_park.outline(1.2), grounds.forecourt.buffer(0.8), country.farm.yard.outline(0.3)]
    return [*pitches, field, *walks, track, *ponds, *roads, *wires, *yards]


def _heights(species: np.ndarray, rng: np.random.Generator) -> np.ndarray:
    span = np.array([_TALL_M.get(str(s), _WOOD_TALL_M) for s in species]).reshape(-1, 2)
    return np.asarray(span[:, 0] + rng.uniform(size=len(species)) * (span[:, 1] - span[:, 0]))


def _row(line: shapely.LineString, rng: np.random.Generator) -> _Spots:
    """Trees of one kind or a mixed row along a line, with gaps."""
    kinds = rng.choice(_BROAD, int(rng.integers(1, 3)), replace=False)
    pitch = rng.uniform(6.0, 13.0)
    mark = np.arange(rng.uniform(1.0, pitch), line.length, pitch)
    mark = mark[rng.uniform(size=len(mark)) < rng.uniform(0.5, 1.0)]
    xy = shapely.get_coordinates(shapely.line_interpolate_point(line, mark)) + rng.normal(
        0.0, 0.7, (len(mark), 2)
    )
    species = kinds[rng.integers(len(kinds), size=len(xy))]
    return _Spots(xy, species, _heights(species, rng), 0.7)


def _along_fence(grounds: Grounds, rng: np.random.Generator) -> _Spots:
    """Rows of one species along parts of the fence, as clubs plant them."""
    ring = grounds.outline.buffer(rng.uniform(3.5, 5.5), join_style="mitre").exterior
    species, pitch = str(rng.choice(["poplar", "lime", "birch", "lime"])), rng.uniform(7.0, 11.0)
    mark = np.arange(0.0, ring.length, pitch)
    stretch = (mark / rng.uniform(60.0, 110.0)).astype(np.int64)
    planted = rng.uniform(size=stretch.max() + 1) < 0.6
    xy = shapely.get_coordinates(shapely.line_interpolate_point(ring, mark[planted[stretch]]))
    names = np.full(len(xy), species)
    low, high = _TALL_M[species]
    tall = rng.uniform(low, high) * rng.uniform(0.85, 1.1, len(xy))
    return _Spots(xy, names, tall, 0.75)


def _singles(country: Country, half_m: float, shop: FieldWorkshop, rng: np.random.Generator) -> _Spots:
    """Single trees and copses on meadows, none in crops."""
    count = int(rng.uniform(*shop.knobs.trees_per_hectare) * (2 * half_m) ** 2 / 1e4)
    middle = rng.uniform(-half_m, half_m, (max(count // 5, 1), 2))
    copse = rng.uniform(size=len(middle)) < 0.35
    size = np.where(copse, rng.integers(5, 16, len(middle)), 1)
    which = np.repeat(np.arange(len(middle)), size)
    xy = middle[which] + rng.normal(size=(len(which), 2)) * np.where(copse, 7.0, 0.0)[which, None]
    meadow = shapely.union_all([p.outline for p in country.parcels if p.cover is Cover.MEADOW])
    shapely.prepare(meadow)
    xy, which = xy[shapely.contains_xy(meadow, xy)], which[shapely.contains_xy(meadow, xy)]
    kinds = np.array([*_BROAD, "oak", "pine"])
    species = kinds[rng.integers(len(kinds), size=len(middle))][which]
    return _Spots(xy, species, _heights(species, rng), 0.6)


def _woods(country: Country, square: shapely.Polygon, rng: np.random.Generator) -> _Spots:
    """Dense trees in wood parcels, up to a little beyond the square."""
    room = square.buffer(40.0, join_style="mitre")
    rows: list[tuple[np.ndarray, np.ndarray]] = []
    for parcel in country.parcels:
        wood = parcel.outline.buffer(-2.5).intersection(room)
        if parcel.cover is not Cover.WOOD or wood.is_empty:
            continue
        kinds = np.array(_WOODS[int(rng.integers(len(_WOODS)))])
        x0, y0, x1, y1 = wood.bounds
        xy = hexagonal(x0, y0, x1, y1, rng.uniform(6.0, 7.5), rng, 0.35)
        xy = xy[shapely.contains_xy(wood, xy)]
        rows.append((xy, kinds[rng.integers(len(kinds), size=len(xy))]))
    xy = np.concatenate([np.zeros((0, 2)), *(r[0] for r in rows)])
    species = np.concatenate([np.zeros(0, "U8"), *(r[1] for r in rows)])
    return _Spots(xy, species, rng.uniform(*_WOOD_TALL_M, len(xy)), 0.45)


def _free(
    wanted: list[_Spots], obstacles: np.ndarray, half_m: float
) -> tuple[np.ndarray, np.ndarray, np.ndarray, np.ndarray]:
    """Trees that keep clear of obstacles and earlier trees; where there are too many, the farthest become masses."""
    xy = np.concatenate([s.xy for s in wanted])
    species = np.concatenate([s.species.astype("U8") for s in wanted])
    height = np.concatenate([s.height_m for s in wanted])
    spread = np.concatenate([np.full(len(s.xy), s.spread) for s in wanted])
    radius = np.zeros(len(xy))
    for name in np.unique(species):
        mine = species == name
        radius[mine] = crown_radius_m(str(name), height[mine])
    points = shapely.points(xy)
    keep = clear_of(shapely.buffer(points, radius, quad_segs=4), obstacles, 0.4)
    index = np.flatnonzero(keep)
    keep[index] = first_come(shapely.buffer(points[index], (spread * radius)[index], quad_segs=4))
    index = np.flatnonzero(keep)
    reach = np.linalg.norm(xy, axis=1)
    index = index[np.argsort(reach[index], kind="stable")]
    detail = np.where(reach[index] < _NEAR_SHARE * half_m, _NEAR_DETAIL, _FAR_DETAIL)
    faces = detail * np.array([640, 1050, 1900])[np.searchsorted((7.0, 12.0), height[index])]
    paid = np.cumsum(faces) < _LEAF_BUDGET
    rest, index = index[~paid], np.sort(index[paid])
    masses = np.column_stack([xy[rest], 1.1 * height[rest], height[rest]])
    return xy[index], species[index], height[index], masses


def _boundaries(
    country: Country,
    square: shapely.Polygon,
    paved: list[shapely.Geometry],
    shop: FieldWorkshop,
    rng: np.random.Generator,
) -> tuple[list[shapely.LineString], list[shapely.LineString]]:
    """Boundaries of fields with a hedge, and those with a row of trees, outside everything paved."""
    share = rng.uniform(*shop.knobs.hedge_share)
    closed = shapely.union_all([g for g in paved if not g.is_empty]).buffer(2.5)
    room = square.buffer(30.0, join_style="mitre").difference(closed)
    found: tuple[list[shapely.LineString], list[shapely.LineString]] = ([], [])
    for line in country.boundaries:
        drawn = rng.uniform(size=2)
        if len(line) < 2 or drawn[0] > 1.5 * share:
            continue
        for piece in shapely.get_parts(shapely.LineString(line).intersection(room)):
            if piece.geom_type == "LineString" and piece.length > 12.0:
                found[int(drawn[1] > 0.55)].append(piece)
    return found


def _nearest(lines: list[shapely.LineString]) -> list[shapely.LineString]:
    """The lines nearest to the origin, as many as the budget allows."""
    order = np.argsort([line.distance(shapely.Point(0.0, 0.0)) for line in lines], kind="stable")
    length = np.cumsum([lines[k].length for k in order])
    return [lines[k] for k in order[length < _HEDGES_M]]


def _cut(line: shapely.LineString, obstacles: list[shapely.Geometry]) -> list[np.ndarray]:
    """What obstacles leave of a line, as polylines."""
    near = [o for o in obstacles if o.dwithin(line, 2.0)]
    rest = line.difference(shapely.union_all(near).buffer(1.3)) if near else line
    pieces = [p for p in shapely.get_parts(rest) if p.geom_type == "LineString" and p.length > 4.0]
    return [shapely.get_coordinates(p) for p in pieces]


def _bushes(
    grounds: Grounds, country: Country, taken: np.ndarray, shop: FieldWorkshop, rng: np.random.Generator
) -> list[Part]:
    """Shrubs around the clubhouse, between the car park and the fence, at the pond's shore."""
    rings = [grounds.clubhouse.outline(2.2).exterior, grounds.car_park.outline(2.6).exterior]
    if country.pond is not None:
        rings.append(pond_outline(country.pond).buffer(2.2).exterior)
    rows = [np.zeros((0, 2))]
    for ring in rings:
        mark = np.arange(0.0, ring.length, 2.4)
        mark = mark[rng.uniform(size=len(mark)) < 0.5]
        rows.append(shapely.get_coordinates(shapely.line_interpolate_point(ring, mark)))
    xy = np.concatenate(rows)
    size = (
        rng.uniform(0.9, 2.0, (len(xy), 1)) * rng.uniform(0.8, 1.2, (len(xy), 3)) * np.array([1.0, 1.0, 0.8])
    )
    discs = shapely.buffer(shapely.points(xy), 0.6 * size[:, :2].max(axis=1))
    keep = clear_of(discs, taken, 0.2)
    keep[np.flatnonzero(keep)] = first_come(discs[keep])
    xy, size = xy[keep], size[keep]
    position = np.column_stack([xy, shop.relief(xy)])
    parts: list[Part] = shrubs(position, size, rng.uniform(0.0, 2 * np.pi, len(xy)), shop, rng)
    return parts
