"""Houses along the coastal road: lots on both sides where the land is level enough, fronts to the road."""

from __future__ import annotations

import numpy as np
import shapely

from scenegen.buildings.building import Building, Volume, outline_of
from scenegen.buildings.styles import Kind, Roof, draw_style
from scenegen.geometry.placement import along, rectangles
from scenegen.maps.coastline.layout import Layout
from scenegen.maps.coastline.relief import ROAD_HALF_M
from scenegen.maps.coastline.workshop import CoastWorkshop

_BELOW_M, _STEP_M = 0.8, 0.2
_STEEPEST_M = 2.4
GARDEN_M = 4.0
"""Width of the garden around a house [m]."""


def draw_houses(layout: Layout, shop: CoastWorkshop, rng: np.random.Generator) -> list[Building]:
    """Draw houses and claim their ground; a few have a second storey's worth of guests: inns with flat roofs."""
    wanted = round(rng.uniform(*shop.knobs.houses))
    count = 9 * wanted
    line = shapely.get_coordinates(layout.road)
    line = line[np.abs(line).max(axis=1) < shop.coast.half_m]
    cluster = rng.uniform(0.1, 0.9, 3) * shapely.LineString(line).length
    mark = cluster[rng.integers(3, size=count)] + rng.normal(0.0, 60.0, count)
    mark = np.clip(mark, 5.0, shapely.LineString(line).length - 5.0)
    inn = rng.uniform(size=count) < 0.12
    long = np.where(inn, rng.uniform(18.0, 26.0, count), rng.uniform(9.5, 14.5, count))
    deep = np.where(inn, rng.uniform(10.0, 13.0, count), rng.uniform(7.5, 9.8, count))
    side = np.where(rng.uniform(size=count) < 0.25, 1.0, -1.0)
    row = np.where(rng.uniform(size=count) < 0.7, 0.0, rng.uniform(18.0, 50.0, count))
    away = ROAD_HALF_M + rng.uniform(5.5, 9.0, count) + deep / 2 + row * (side < 0)
    xy, heading = along(line, mark, side * away)
    heading = heading + np.where(side > 0, np.pi, 0.0) + rng.normal(0.0, 0.05, count)
    shapes = rectangles(xy, long, deep, heading)
    ring = shapely.get_coordinates(shapes).reshape(count, 5, 2)
    ground = shop.relief(ring.reshape(-1, 2)).reshape(count, 5)
    level = (np.ptp(ground, axis=1) < _STEEPEST_M) & (ground.min(axis=1) > 2.0)
    good = np.flatnonzero(level & shop.coast.inside(xy, 22.0) & _dry(ring, shop))
    free = good[shop.claims.free(shapely.buffer(shapes[good], GARDEN_M, join_style="mitre"))]
    chosen = free[shop.claims.take(shapely.buffer(shapes[free], GARDEN_M, join_style="mitre"))][:wanted]
    inn[chosen[:1]] = True  # every village has one
    return [
        _house(ring[k, :4], float(ground[k].max()), float(ground[k].min()), bool(inn[k]), shop, rng)
        for k in chosen
    ]


def _dry(ring: np.ndarray, shop: CoastWorkshop) -> np.ndarray:
    """Footprints behind dunes and cliff edges."""
    sq = shop.coast.offset(ring.reshape(-1, 2))
    behind = sq[:, 1] > shop.coast.back(sq[:, 0]) + 6.0
    return np.asarray(behind.reshape(len(ring), 5).all(axis=1))


def _house(
    ring: np.ndarray, high_m: float, low_m: float, inn: bool, shop: CoastWorkshop, rng: np.random.Generator
) -> Building:
    kind = Kind.APARTMENTS if inn else Kind.HOUSE
    choice = rng.uniform()
    form = Roof.FLAT if inn else Roof.GABLE if choice < 0.65 else Roof.HIP if choice < 0.9 else Roof.FLAT
    style = draw_style(kind, form, shop.palette, rng)
    storeys = int(rng.integers(2, 4)) if inn else int(rng.choice([1, 1, 2]))
    floor = high_m + _STEP_M
    rings = (
        np.asarray(shapely.get_coordinates(shapely.orient_polygons(shapely.Polygon(ring)).exterior)[:-1]),
    )
    volume = Volume(rings, floor, storeys, floor - low_m + _BELOW_M, form)
    return Building(kind, shop.builder.new_objects(), style, (volume,), outline_of(rings))
