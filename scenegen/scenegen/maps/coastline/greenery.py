"""Trees and shrubs: groves behind the road, palms where it is warm, scrub on dunes' backs and cliff tops."""

from __future__ import annotations

import numpy as np
import shapely

from scenegen.geometry.part import Part
from scenegen.maps.coastline.relief import ROAD_HALF_M
from scenegen.maps.coastline.workshop import CoastWorkshop
from scenegen.parts.vegetation.plant import crown_radius_m, plant, shrubs

# Species by the latitude [deg] up to which they are taken, with their weights; after the coasts of Europe.
_FLORA = (
    (30.0, {"palm": 6, "olive": 2, "pine": 2}),
    (44.0, {"pine": 5, "olive": 3, "palm": 2, "poplar": 1}),
    (52.0, {"pine": 4, "oak": 2, "poplar": 2, "birch": 1}),
    (60.0, {"pine": 3, "birch": 3, "oak": 1, "spruce": 2}),
    (90.0, {"birch": 3, "spruce": 4, "pine": 2}),
)
_HEIGHT_M = {"palm": (5.0, 10.0), "olive": (3.5, 6.5)}
_ANY_HEIGHT_M = (5.0, 11.0)
_MOST_TREES, _MOST_SHRUBS = 230, 750
_DETAIL = 0.65
"""Share of the usual triangles of a tree: flights seldom come near them."""


def build_greenery(shop: CoastWorkshop, rng: np.random.Generator) -> tuple[list[Part], dict[str, int]]:
    """Trees and shrubs as parts, and their numbers."""
    tree_rng, shrub_rng = rng.spawn(2)
    trees, tree_count = _trees(shop, tree_rng)
    bushes, shrub_count = _shrubs(shop, shrub_rng)
    return [*trees, *bushes], {"trees": tree_count, "shrubs": shrub_count}


def _trees(shop: CoastWorkshop, rng: np.random.Generator) -> tuple[list[Part], int]:
    coast = shop.coast
    xy = rng.uniform(-coast.half_m, coast.half_m, (9000, 2))
    st = coast.frame.local(xy)
    behind = st[:, 1] - coast.road(st[:, 0]) - ROAD_HALF_M
    scattered = np.sin(xy[:, 0] / 31.0) + np.sin(xy[:, 1] / 27.0) + np.sin((xy[:, 0] + 1.3 * xy[:, 1]) / 44.0)
    likely = (behind > 6.0) & (scattered + rng.normal(0.0, 0.7, len(xy)) > 0.7)
    area = (behind > 6.0).mean() * (2 * coast.half_m) ** 2
    wanted = min(round(rng.uniform(*shop.knobs.trees_per_1000_m2) * area / 1000.0), _MOST_TREES)
    xy = xy[likely & coast.inside(xy, 4.0)]
    flora = next(mix for limit, mix in _FLORA if abs(shop.season.latitude_deg) <= limit)
    names = list(flora)
    weight = np.array([flora[n] for n in names], np.float64)
    kind = rng.choice(len(names), len(xy), p=weight / weight.sum())
    low, high = (np.array([_HEIGHT_M.get(n, _ANY_HEIGHT_M)[k] for n in names])[kind] for k in (0, 1))
    height = low + rng.uniform(0.0, 1.0, len(xy)) * (high - low)
    radius = np.concatenate(
        [crown_radius_m(names[k], np.array([h])) for k, h in zip(kind, height, strict=True)]
    )
    crowns = shapely.buffer(shapely.points(xy), radius + 0.15, quad_segs=4)
    chosen = np.flatnonzero(shop.claims.take(crowns[: 6 * wanted], 0.6))[:wanted]
    parts = []
    for k, name in enumerate(names):
        mine = chosen[kind[chosen] == k]
        if len(mine):
            position = np.column_stack([xy[mine], shop.relief(xy[mine])])
            parts += plant(name, position, height[mine], shop, rng, _DETAIL)
    return parts, len(chosen)


def _shrubs(shop: CoastWorkshop, rng: np.random.Generator) -> tuple[list[Part], int]:
    coast = shop.coast
    along = rng.uniform(-1.4, 1.4, 6000) * coast.half_m
    low = np.maximum(coast.brow(along) + 3.0, 0.5 * (coast.beach(along) + coast.back(along)))
    depth = coast.road(along) - coast.shore(along) + 70.0 - low
    q = low + rng.uniform(0.0, 1.0, len(along)) ** 1.3 * depth
    xy = coast.plan(along, q)
    clump = np.sin(along / 13.0) + np.sin(q / 9.0 + along / 37.0) + np.sin((along - q) / 21.0)
    xy = xy[coast.inside(xy, 2.0) & (clump + rng.normal(0.0, 0.5, len(xy)) > 0.4)]
    area = float(np.clip(depth, 0.0, None).mean()) * 2 * coast.half_m
    wanted = min(round(rng.uniform(*shop.knobs.shrubs_per_1000_m2) * area / 1000.0), _MOST_SHRUBS)
    side = rng.uniform(0.8, 2.6, len(xy))
    size = np.column_stack(
        [side, side * rng.uniform(0.7, 1.0, len(xy)), side * rng.uniform(0.4, 0.8, len(xy))]
    )
    shapes = shapely.buffer(shapely.points(xy), 0.5 * np.hypot(size[:, 0], size[:, 1]), quad_segs=3)
    chosen = np.flatnonzero(shop.claims.take(shapes[: 6 * wanted], 0.3))[:wanted]
    position = np.column_stack([xy[chosen], shop.relief(xy[chosen])])
    heading = rng.uniform(0.0, 2 * np.pi, len(chosen))
    return shrubs(position, size[chosen], heading, shop, rng), len(chosen)
