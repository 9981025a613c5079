"""Cars in the car park, on verges and before houses."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
import shapely

from scenegen.buildings.building import Building
from scenegen.geometry.part import Part
from scenegen.geometry.placement import along, rectangles
from scenegen.geometry.relief import slopes
from scenegen.maps.coastline.layout import Layout
from scenegen.maps.coastline.relief import ROAD_HALF_M
from scenegen.maps.coastline.workshop import CoastWorkshop
from scenegen.parts.vehicles.park import park, size_m

BAY_M = 2.72
"""Width of a bay of the car park [m]."""

_BAYS = 15
_ROW_M = 5.55
_VERGE_M = ROAD_HALF_M + 1.6


def build_cars(
    layout: Layout, houses: Sequence[Building], shop: CoastWorkshop, rng: np.random.Generator
) -> tuple[list[Part], int]:
    """Parked vehicles and their number."""
    wanted = round(rng.uniform(*shop.knobs.cars))
    bays = _bays(layout, rng)[: round(0.75 * wanted)]
    verge = _verge(layout, houses, shop, rng)[: wanted - len(bays)]
    rows = np.concatenate([bays, verge])
    van = (rng.uniform(size=len(rows)) < 0.14) & (np.arange(len(rows)) < len(bays))
    parts = []
    for kind, mine in (("car", ~van), ("van", van)):
        xy = rows[mine, :2]
        position = np.column_stack([xy, shop.relief(xy)])
        parts += park(kind, position, rows[mine, 2], slopes(shop.relief, xy), shop, rng)
    return parts, len(rows)


def _bays(layout: Layout, rng: np.random.Generator) -> np.ndarray:
    """Places (x, y, rad) in the middle of bays, in random order."""
    x = (np.arange(_BAYS) - (_BAYS - 1) / 2) * BAY_M
    local = np.concatenate([[(v, _ROW_M) for v in x], [(v, -_ROW_M) for v in x if abs(v) > 6.0]])
    heading = layout.car_park_heading_rad
    c, s = np.cos(heading), np.sin(heading)
    xy = local @ np.array([[c, s], [-s, c]]) + shapely.get_coordinates(layout.car_park.centroid)[0]
    nose_in = rng.uniform(size=len(xy)) < 0.7
    turn = (
        heading + np.where((local[:, 1] > 0) == nose_in, 0.5, -0.5) * np.pi + rng.normal(0.0, 0.02, len(xy))
    )
    return np.asarray(np.column_stack([xy, turn])[rng.permutation(len(xy))])


def _verge(
    layout: Layout, houses: Sequence[Building], shop: CoastWorkshop, rng: np.random.Generator
) -> np.ndarray:
    """Places (x, y, rad) half on the verge, mostly before houses."""
    line = shapely.get_coordinates(layout.road)
    line = line[np.abs(line).max(axis=1) < shop.coast.half_m]
    road = shapely.LineString(line)
    doors = [road.project(b.footprint.centroid) for b in houses]
    mark = np.concatenate(
        [np.array(doors) + rng.uniform(-5.0, 5.0, len(doors)), rng.uniform(0.1, 0.9, 12) * road.length]
    )
    mark = np.clip(mark, 8.0, road.length - 8.0)
    left = rng.uniform(size=len(mark)) < 0.6
    xy, heading = along(line, mark, np.where(left, -_VERGE_M, _VERGE_M))
    heading = heading + np.where(left, np.pi, 0.0) + rng.normal(0.0, 0.03, len(mark))
    length, width, _ = size_m("car")
    shapes = rectangles(xy, np.full(len(xy), length + 1.2), np.full(len(xy), width + 0.4), heading)
    good = shop.coast.inside(xy, 8.0)
    core = shapely.LineString(line).buffer(ROAD_HALF_M + 0.05)
    good[good] = shop.claims.take(shapely.difference(shapes[good], core), 0.3)
    return np.asarray(np.column_stack([xy, heading])[good])
