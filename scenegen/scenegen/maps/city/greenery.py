"""Trees in streets, yards and parks; hedges before houses and shrubs in beds."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import shapely
from jaxtyping import Float64, Int64

from scenegen.geometry.part import Part
from scenegen.geometry.placement import along, clear_of, first_come
from scenegen.maps.city.districts import Layout
from scenegen.maps.city.park import ParkPlan
from scenegen.maps.city.streets import KERB_M
from scenegen.maps.city.uses import Use
from scenegen.maps.city.workshop import CityWorkshop
from scenegen.parts.vegetation.plant import crown_radius_m, hedges, plant, shrubs, triangles

_FLORA = (
    (
        33.0,
        {"palm": 5, "maple": 3, "poplar": 1, "pine": 1},
        {"palm": 3, "olive": 3, "cypress": 2, "pine": 3, "oak": 1},
    ),
    (
        44.0,
        {"maple": 6, "lime": 3, "poplar": 1},
        {"oak": 3, "maple": 2, "olive": 1, "cypress": 2, "pine": 2, "poplar": 1},
    ),
    (
        56.0,
        {"lime": 5, "maple": 5, "oak": 1, "poplar": 1},
        {"oak": 2, "lime": 2, "maple": 3, "birch": 3, "spruce": 2, "fir": 1, "pine": 1, "poplar": 1},
    ),
    (90.0, {"lime": 4, "birch": 4, "maple": 1}, {"birch": 5, "spruce": 4, "pine": 3, "lime": 1}),
)
"""Trees of streets and of gardens up to a latitude [deg], with their weights; one kind to a street."""
_HEDGE_HEIGHTS_M, _HEDGE_WIDTH_M, _PATH_M = (0.95, 1.25, 1.6), 0.8, 0.7
_MOST_TRIANGLES = 250_000
"""For all trees of a city: the more there are, the plainer they are."""


@dataclass(frozen=True, eq=False)
class _Spots:
    """Where trees might stand.

    Attributes
    ----------
    xy : float64 (spots, 2)
    height_m : float64 (spots,)
    kind : int64 (spots,)
        Into the names of the flora, street trees first.
    """

    xy: Float64[np.ndarray, "spots 2"]
    height_m: Float64[np.ndarray, "spots"]
    kind: Int64[np.ndarray, "spots"]


def build_greenery(
    layout: Layout,
    parks: dict[int, ParkPlan],
    posts: np.ndarray,
    shop: CityWorkshop,
    rng: np.random.Generator,
) -> tuple[list[Part], int]:
    """Trees, hedges and shrubs as parts, and the number of trees.

    Parameters
    ----------
    layout, parks
        What the plan holds; parks by block index.
    posts : float64 (posts, 2)
        Lamps and signs that crowns keep clear of.
    shop : CityWorkshop
    rng : numpy.random.Generator
    """
    spots_rng, tree_rng, hedge_rng, bed_rng = rng.spawn(4)
    names, spots = _tree_spots(layout, parks, shop, spots_rng)
    parts, count = _trees(names, spots, layout, posts, shop, tree_rng)
    parts += _hedges(layout, shop, hedge_rng)
    parts += _beds(parks, shop, bed_rng)
    return parts, count


def _trees(
    names: list[str],
    spots: _Spots,
    layout: Layout,
    posts: np.ndarray,
    shop: CityWorkshop,
    rng: np.random.Generator,
) -> tuple[list[Part], int]:
    radius = np.array([float(crown_radius_m(name, 1.0)) for name in names])[spots.kind] * spots.height_m
    free = _free(spots.xy, radius, layout, posts)
    position = np.column_stack([spots.xy, shop.relief(spots.xy) + KERB_M])
    detail = min(1.0, _MOST_TRIANGLES / max(triangles(spots.height_m[free]), 1))
    parts: list[Part] = []
    for k, (name, child) in enumerate(zip(names, rng.spawn(len(names)), strict=True)):
        mine = free & (spots.kind == k)
        if mine.any():
            parts += plant(name, position[mine], spots.height_m[mine], shop, child, detail)
    return parts, int(free.sum())


def _paving(layout: Layout) -> np.ndarray:
    """Paths to doors and car parks."""
    fronts = [b.front for b in layout.buildings if b.front is not None]
    paths = [shapely.LineString(f).buffer(1.5) for f in fronts if np.linalg.norm(f[1] - f[0]) > 0.5]
    return np.array([*paths, *(lot.area for b in layout.blocks for lot in b.car_parks)], dtype=object)


def _free(xy: np.ndarray, radius: np.ndarray, layout: Layout, posts: np.ndarray) -> np.ndarray:
    """Trees whose crown is clear of walls, posts and earlier crowns, and whose trunk stands on no paving."""
    crowns = shapely.buffer(shapely.points(xy), radius, quad_segs=4)
    footprints = np.array([b.footprint for b in layout.buildings], dtype=object)
    keep = clear_of(crowns, footprints, 0.3) & clear_of(crowns, shapely.points(posts), 0.2)
    keep &= clear_of(shapely.points(xy), _paving(layout), 0.6)
    smaller = shapely.buffer(shapely.points(xy), 0.8 * radius, quad_segs=4)
    index = np.flatnonzero(keep)
    keep[index] = first_come(smaller[index])
    return np.asarray(keep)


def _tree_spots(
    layout: Layout, parks: dict[int, ParkPlan], shop: CityWorkshop, rng: np.random.Generator
) -> tuple[list[str], _Spots]:
    """Names of the species that grow here, and candidate places with heights and kinds."""
    in_streets, in_gardens = next(row[1:] for row in _FLORA if abs(shop.season.latitude_deg) <= row[0])
    street, garden = _weights(in_streets), _weights(in_gardens)
    yard_rate = rng.uniform(*shop.knobs.yard_trees_per_1000_m2)
    park_rate = rng.uniform(*shop.knobs.park_trees_per_1000_m2)
    places, heights, kinds = [np.zeros((0, 2))], [np.zeros(0)], [np.zeros(0, np.int64)]
    for k, block in enumerate(layout.blocks):
        if rng.uniform() < 0.75 and block.use is not Use.INDUSTRY:
            xy = _row(block.outline, rng.uniform(*shop.knobs.street_tree_spacing_m))
            places.append(xy)
            heights.append(rng.uniform(5.0, 8.5) * rng.uniform(0.85, 1.15, len(xy)))
            kinds.append(np.full(len(xy), rng.choice(len(street), p=street)))
        if k in parks:
            area, rate, tall = parks[k].free(), park_rate, (7.0, 17.0)
        else:
            area, tall = block.yard.buffer(-2.0), (4.5, 10.5)
            rate = yard_rate * {Use.INDUSTRY: 0.15, Use.OFFICES: 0.5}.get(block.use, 1.0)
        if area.is_empty:
            continue
        x0, y0, x1, y1 = area.bounds
        xy = rng.uniform((x0, y0), (x1, y1), (int(rate * (x1 - x0) * (y1 - y0) / 1000), 2))
        xy = xy[shapely.contains_xy(area, xy)]
        places.append(xy)
        heights.append(rng.uniform(*tall, len(xy)))
        kinds.append(len(street) + rng.choice(len(garden), len(xy), p=garden))
    names = [*in_streets, *in_gardens]
    merged = list(dict.fromkeys(names))
    kind = np.array([merged.index(n) for n in names])[np.concatenate(kinds)]
    return merged, _Spots(np.concatenate(places), np.concatenate(heights), kind)


def _weights(mix: dict[str, int]) -> np.ndarray:
    weight = np.array(list(mix.values()), np.float64)
    return np.asarray(weight / weight.sum())


def _row(outline: shapely.Polygon, spacing_m: float) -> Float64[np.ndarray, "spots 2"]:
    """Places of street trees around a block."""
    line = shapely.get_coordinates(outline.buffer(-1.0, join_style="mitre").exterior)
    mark = np.arange(6.0, shapely.LineString(line).length - 3.0, spacing_m)
    return along(line, mark, np.zeros(len(mark)))[0]


def _hedges(layout: Layout, shop: CityWorkshop, rng: np.random.Generator) -> list[Part]:
    """Hedges along the fronts of homes, with a gap where a path crosses."""
    lines, style = [], []
    for block in layout.blocks:
        if block.use not in (Use.HOMES, Use.ESTATE):
            continue
        for lot in block.lots:
            if lot.frontage_m < 8.0 or rng.uniform() < 0.68:
                continue
            ends = lot.world(np.array([[0.8, 0.75], [lot.frontage_m - 0.8, 0.75]]))
            lines.append(
                shapely.intersection(shapely.LineString(ends), lot.area.buffer(-0.5 * _HEDGE_WIDTH_M - 0.05))
            )
            style.append(int(rng.integers(len(_HEDGE_HEIGHTS_M))))
    found = _outside(np.array(lines, dtype=object), _paving(layout))
    parts: list[Part] = []
    for k, (height, child) in enumerate(zip(_HEDGE_HEIGHTS_M, rng.spawn(len(_HEDGE_HEIGHTS_M)), strict=True)):
        pieces = [
            shapely.get_coordinates(piece)
            for line, own in zip(found, style, strict=True)
            if own == k
            for piece in shapely.get_parts(line)
            if piece.length > 1.5
        ]
        parts += hedges(pieces, height, _HEDGE_WIDTH_M, shop, child, KERB_M)
    return parts


def _outside(lines: np.ndarray, areas: np.ndarray) -> np.ndarray:
    """What is left of each line when a margin around all areas is taken out."""
    left = lines.copy()
    if len(lines) and len(areas):
        wide = shapely.buffer(areas, _PATH_M)
        line, area = shapely.STRtree(wide).query(lines, predicate="intersects")
        for i, j in zip(line.tolist(), area.tolist(), strict=True):
            left[i] = shapely.difference(left[i], wide[j])
    return left


def _beds(parks: dict[int, ParkPlan], shop: CityWorkshop, rng: np.random.Generator) -> list[Part]:
    """Shrubs in the beds of parks."""
    places, sizes = [np.zeros((0, 2))], [np.zeros((0, 3))]
    for park in parks.values():
        for bed in park.beds:
            x0, y0, x1, y1 = bed.bounds
            xy = rng.uniform((x0, y0), (x1, y1), (8, 2))
            xy = xy[shapely.contains_xy(bed.buffer(-0.5), xy)]
            places.append(xy)
            sizes.append(rng.uniform(0.9, 1.8, (len(xy), 1)) * rng.uniform(0.8, 1.1, (len(xy), 3)))
    xy, size = np.concatenate(places), np.concatenate(sizes)
    position = np.column_stack([xy, shop.relief(xy) + KERB_M])
    return shrubs(position, size, rng.uniform(0.0, 2 * np.pi, len(xy)), shop, rng)
