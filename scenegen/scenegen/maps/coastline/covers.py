"""What people and plants have made of the land: fields, heath, road, paths, car park, paint, breakwater."""

from __future__ import annotations

import numpy as np
import shapely

from scenegen.classes import Semantic
from scenegen.geometry.ground import Region
from scenegen.geometry.placement import along, clear_of, first_come, rectangles
from scenegen.maps.coastline.layout import LIGHTHOUSE_YARD_M, Layout
from scenegen.maps.coastline.relief import ROAD_HALF_M
from scenegen.maps.coastline.shape import FAR_M
from scenegen.maps.coastline.strips import blobs
from scenegen.maps.coastline.workshop import CoastWorkshop

_ROAD_END_M = 2200.0
_COVERS = ("grass_watered", "grass_dry", "soil_dry", "grass_dry", "soil_wet", "grass_watered")


def fields(layout: Layout, shop: CoastWorkshop, rng: np.random.Generator) -> list[Region]:
    """Fields and meadows behind the road, larger with distance."""
    coast, count = shop.coast, 110
    reach = np.concatenate(
        [rng.uniform(45.0, 420.0, 30), 420.0 + 7000.0 * rng.uniform(0.0, 1.0, count - 30) ** 1.6]
    )
    s = rng.uniform(-1.0, 1.0, count) * (1.2 * coast.half_m + 0.9 * reach)
    size = np.clip(0.16 * reach + rng.uniform(26.0, 60.0, count), 30.0, 600.0)
    centre = coast.frame.world(np.column_stack([s, coast.road(s) + reach]))
    turn = coast.frame.heading_rad + 0.5 * np.sin(s / 900.0) + rng.normal(0.0, 0.05, count)
    shapes = rectangles(centre, size, size * rng.uniform(0.45, 0.9, count), turn)
    held = np.array([layout.road.buffer(ROAD_HALF_M + 14.0), layout.car_park.buffer(12.0)], dtype=object)
    keep = clear_of(shapes, held) & first_come(shapes) & (np.abs(centre).max(axis=1) < FAR_M - 700.0)
    fields = shop.builder.new_objects(count)
    regions = []
    for k in np.flatnonzero(keep):
        name = _COVERS[int(rng.integers(len(_COVERS)))]
        semantic = Semantic.SOIL if name.startswith("soil") else Semantic.GRASS
        regions.append(Region(shapes[k], shop.palette.pick(name, rng), int(semantic), fields + int(k)))
    return regions


def heath(layout: Layout, shop: CoastWorkshop, rng: np.random.Generator) -> list[Region]:
    """Patches of thicker, drier or trodden growth on the open land."""
    coast, count = shop.coast, 800
    s = rng.uniform(-1.4, 1.4, count) * coast.half_m
    q = coast.back(s) + 9.0 + rng.uniform(0.0, 1.0, count) ** 1.4 * 1.3 * coast.half_m
    size = rng.uniform(1.5, 6.0, count) + rng.uniform(0.0, 1.0, count) ** 3 * 9.0
    xy = coast.plan(s, q)
    patches = blobs(xy, size, rng)
    held = [layout.road.buffer(ROAD_HALF_M + 1.0), layout.car_park.buffer(1.0), layout.drive.buffer(2.0)]
    keep = coast.inside(xy, 4.0) & clear_of(patches, np.array(held, dtype=object)) & first_come(patches)
    owner = shop.builder.new_objects(count)
    regions = []
    for k in np.flatnonzero(keep):
        name = ("grass_dry", "grass_watered", "grass_dry", "soil_dry")[int(rng.integers(4))]
        semantic = Semantic.SOIL if name == "soil_dry" else Semantic.GRASS
        regions.append(Region(patches[k], shop.palette.pick(name, rng), int(semantic), owner + int(k)))
    return regions


def roads(layout: Layout, shop: CoastWorkshop, rng: np.random.Generator) -> list[Region]:
    """Track, paths, car park, carriageway and its paint."""
    first = shop.builder.new_objects(6)
    gravel, paved = shop.palette.pick("soil_dry", rng), shop.palette.pick("concrete_pavement", rng)
    asphalt = shop.palette.pick("asphalt_aged", rng)
    paint = shop.palette.special("asphalt_aged", "paint", solar_absorptance=0.55)
    yard = shapely.Point(layout.lighthouse[:2]).buffer(LIGHTHOUSE_YARD_M - 0.8, quad_segs=5)
    walk, road = int(Semantic.SIDEWALK), int(Semantic.ROAD)
    entry = layout.car_park.union(_gateway(layout)).buffer(0.0)
    regions = [
        Region(layout.drive.buffer(1.5, cap_style="flat", quad_segs=2), gravel, int(Semantic.SOIL), first),
        Region(yard, paved, walk, first + 1),
        Region(layout.path.buffer(0.9, cap_style="flat"), paved, walk, first + 2),
        Region(entry, asphalt, road, first + 3),
    ]
    edge = shapely.box(-_ROAD_END_M, -_ROAD_END_M, _ROAD_END_M, _ROAD_END_M)
    strip = layout.road.buffer(ROAD_HALF_M, cap_style="flat", quad_segs=2).intersection(edge)
    regions += [Region(p, asphalt, road, first + 4) for p in shapely.get_parts(strip)]
    dashes = _dashes(layout, shop)
    return regions + [Region(d, paint, int(Semantic.ROAD_MARKING), first + 5, lumped=True) for d in dashes]


def _gateway(layout: Layout) -> shapely.Polygon:
    """The drive from the road into the car park."""
    middle = shapely.get_coordinates(layout.car_park.centroid)[0]
    nearest = shapely.get_coordinates(layout.road.interpolate(layout.road.project(layout.car_park.centroid)))[
        0
    ]
    return shapely.LineString([nearest, middle]).buffer(3.4, cap_style="flat")


def _dashes(layout: Layout, shop: CoastWorkshop) -> np.ndarray:
    """The broken line in the middle of the detailed road, and the bays of the car park."""
    line = shapely.get_coordinates(layout.road)
    near = line[np.abs(line).max(axis=1) < shop.coast.half_m + 60.0]
    start = np.arange(4.0, shapely.LineString(near).length - 8.0, 9.0)
    a, _ = along(near, start, np.zeros(len(start)))
    b, _ = along(near, start + 3.0, np.zeros(len(start)))
    rows = [_bars(a, b, 0.14)]
    c, s = np.cos(layout.car_park_heading_rad), np.sin(layout.car_park_heading_rad)
    turn, middle = np.array([[c, s], [-s, c]]), shapely.get_coordinates(layout.car_park.centroid)[0]
    x = np.arange(-20.4, 20.5, 2.72)
    for y0, y1 in ((3.2, 7.9), (-7.9, -3.2)):
        use = x[np.abs(x) > 4.5] if y0 < 0 else x
        rows.append(
            _bars(
                np.column_stack([use, 0 * use + y0]) @ turn + middle,
                np.column_stack([use, 0 * use + y1]) @ turn + middle,
                0.1,
            )
        )
    return np.asarray(shapely.polygons(np.concatenate(rows)))


def _bars(a: np.ndarray, b: np.ndarray, width_m: float) -> np.ndarray:
    step = (b - a) / np.linalg.norm(b - a, axis=1)[:, None]
    side = np.column_stack([step[:, 1], -step[:, 0]]) * width_m / 2
    return np.stack([a + side, b + side, b - side, a - side], axis=1)


def breakwater(layout: Layout, rock: str, shop: CoastWorkshop, rng: np.random.Generator) -> list[Region]:
    """Core of rock down to below the water, and a paved crown."""
    mound, first = layout.mound, shop.builder.new_objects(2)
    core = mound.line.buffer(mound.half_m + (mound.crown_m + 1.6) / mound.slope, quad_segs=4)
    crown = mound.line.buffer(mound.half_m - 0.2, quad_segs=3)
    concrete = shop.palette.pick("concrete_pavement", rng)
    return [
        Region(core.simplify(0.2), shop.palette.pick(rock, rng), int(Semantic.BARRIER), first),
        Region(crown.simplify(0.05), concrete, int(Semantic.BARRIER), first + 1),
    ]
