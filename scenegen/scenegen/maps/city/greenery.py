"""Trees in streets, yards and parks; hedges before houses and shrubs in beds."""

from __future__ import annotations

import numpy as np
import shapely

from scenegen.geometry.part import Part
from scenegen.geometry.placement import along, clear_of, first_come
from scenegen.geometry.template import place
from scenegen.geometry.trees import broadleaf, conifer, shrub
from scenegen.maps.city.districts import Layout
from scenegen.maps.city.park import ParkPlan
from scenegen.maps.city.uses import Use
from scenegen.maps.city.workshop import CityWorkshop

_KERB_M = 0.12
_BROADLEAVED, _CONIFERS = 5, 2
_CROWN_RADIUS = 0.38


def build_greenery(
    layout: Layout,
    parks: dict[int, ParkPlan],
    posts: np.ndarray,
    shop: CityWorkshop,
    rng: np.random.Generator,
) -> tuple[list[Part], int]:
    """Trees and shrubs as parts (one per template), and the number of trees.

    Parameters
    ----------
    layout, parks
        What the plan holds; parks by block index.
    posts : float64 (posts, 2)
        Lamps and signs that crowns keep clear of.
    shop : CityWorkshop
    rng : numpy.random.Generator
    """
    xy, height = _tree_spots(layout, parks, shop, rng)
    keep = _free(xy, _CROWN_RADIUS * height, layout, posts)
    xy, height = xy[keep], height[keep]
    parts = _trees(xy, height, shop, rng)
    hedges = _hedge_spots(layout, parks, rng)
    hedges = hedges[clear_of(shapely.buffer(shapely.points(hedges[:, :2]), 0.5), _paving(layout), 0.3)]
    skins = np.array([[shop.palette.pick("tree_crown", rng)] for _ in range(len(hedges))], np.int64).reshape(
        -1, 1
    )
    position = np.column_stack([hedges[:, :2], shop.relief(hedges[:, :2]) + _KERB_M - 0.03])
    owner = shop.builder.new_objects(len(hedges)) + np.arange(len(hedges))
    parts.append(place(shrub(rng), position, hedges[:, 2], hedges[:, 3:6], skins, owner))
    return parts, len(xy)


def _trees(
    xy: np.ndarray,
    height: np.ndarray,
    shop: CityWorkshop,
    rng: np.random.Generator,
) -> list[Part]:
    count = len(xy)
    owner = shop.builder.new_objects(count) + np.arange(count)
    broad = rng.uniform(size=count) < 0.82
    species = np.where(
        broad, rng.integers(0, _BROADLEAVED, count), _BROADLEAVED + rng.integers(0, _CONIFERS, count)
    )
    bark = np.array([shop.palette.pick("bark_trunk", rng) for _ in range(count)], np.int64)
    leaves = np.array([shop.palette.pick("tree_crown", rng) for _ in range(count)], np.int64)
    skins = np.column_stack([bark, leaves])
    position = np.column_stack([xy, shop.relief(xy) + _KERB_M])
    heading, wide = rng.uniform(0.0, 2 * np.pi, count), rng.uniform(0.8, 1.1, count)
    scale = height[:, None] * np.column_stack([wide, wide, np.ones(count)])
    parts = []
    for k in range(_BROADLEAVED + _CONIFERS):
        template = broadleaf(rng) if k < _BROADLEAVED else conifer(rng)
        mine = np.flatnonzero(species == k)
        parts.append(place(template, position[mine], heading[mine], scale[mine], skins[mine], owner[mine]))
    return parts


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
) -> tuple[np.ndarray, np.ndarray]:
    """Candidate places and heights."""
    yard_rate = rng.uniform(*shop.knobs.yard_trees_per_1000_m2)
    park_rate = rng.uniform(*shop.knobs.park_trees_per_1000_m2)
    places, heights = [], []
    for k, block in enumerate(layout.blocks):
        if rng.uniform() < 0.75 and block.use is not Use.INDUSTRY:
            line = shapely.get_coordinates(block.outline.buffer(-1.0, join_style="mitre").exterior)
            spots = np.arange(
                6.0, shapely.LineString(line).length - 3.0, rng.uniform(*shop.knobs.street_tree_spacing_m)
            )
            places.append(along(line, spots, np.zeros(len(spots)))[0])
            heights.append(rng.uniform(5.0, 8.0) * rng.uniform(0.85, 1.15, len(spots)))
        if k in parks:
            area, rate, tall = parks[k].free(), park_rate, (7.0, 16.0)
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
    return np.concatenate(places), np.concatenate(heights)


def _hedge_spots(layout: Layout, parks: dict[int, ParkPlan], rng: np.random.Generator) -> np.ndarray:
    """Shrubs (x, y, heading, length, width, height): hedges along lawns of homes, and bushes in park beds."""
    rows = [np.zeros((0, 6))]
    for block in layout.blocks:
        if block.use not in (Use.HOMES, Use.ESTATE):
            continue
        for lot in block.lots:
            if lot.frontage_m < 8.0 or rng.uniform() < 0.68:
                continue
            x = np.arange(1.2, lot.frontage_m - 1.2, 1.9)
            plan = lot.world(np.column_stack([x, np.full(len(x), 0.75)]))
            inside = shapely.contains_xy(lot.area.buffer(-0.45), plan)
            size = np.column_stack(
                [np.full(len(x), 2.1), np.full(len(x), 0.9), rng.uniform(0.9, 1.5) * np.ones(len(x))]
            )
            rows.append(np.column_stack([plan, np.full(len(x), lot.heading_rad), size])[inside])
    for park in parks.values():
        for bed in park.beds:
            x0, y0, x1, y1 = bed.bounds
            xy = rng.uniform((x0, y0), (x1, y1), (6, 2))
            xy = xy[shapely.contains_xy(bed.buffer(-0.5), xy)]
            size = rng.uniform(0.8, 1.8, (len(xy), 1)) * np.array([1.0, 1.0, 0.8])
            rows.append(np.column_stack([xy, rng.uniform(0, np.pi, len(xy)), size]))
    return np.concatenate(rows)
