"""What parcels look like: surfaces of meadows and crops, mown swaths, tramlines, dry patches."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
import shapely

from scenegen.classes import Semantic
from scenegen.geometry.ground import Region
from scenegen.maps.field.country import Cover, Parcel
from scenegen.maps.field.workshop import FieldWorkshop

_DETAIL_M = 340.0
_SWATH_M = {
    Cover.HAY: (5.0, 8.0),
    Cover.STUBBLE: (7.0, 12.0),
    Cover.CROP: (18.0, 26.0),
    Cover.PLOUGHED: (9.0, 16.0),
}
_TRAM_M = 0.7


def parcel_regions(parcels: Sequence[Parcel], shop: FieldWorkshop, rng: np.random.Generator) -> list[Region]:
    """Ground of all parcels; near ones with the marks of machines and of drought."""
    regions = []
    for parcel in parcels:
        plain, second = _surfaces(parcel.cover, shop, rng)
        semantic = int(Semantic.SOIL if parcel.cover is Cover.PLOUGHED else Semantic.GRASS)
        owner = shop.builder.new_objects()
        regions.append(Region(parcel.outline, plain, semantic, owner))
        if shapely.distance(parcel.outline, shapely.Point(0.0, 0.0)) > _DETAIL_M:
            continue
        if parcel.cover in _SWATH_M:
            swath = rng.uniform(*_SWATH_M[parcel.cover])
            regions += [Region(s, second, semantic, owner) for s in _swaths(parcel, swath)]
            if parcel.cover is Cover.CROP:
                soil, tram = shop.palette.pick("soil_dry", rng), shop.builder.new_objects()
                regions += [Region(s, soil, int(Semantic.SOIL), tram) for s in _tramlines(parcel, swath)]
        else:
            regions += [Region(s, second, semantic, owner) for s in _patches(parcel, rng)]
    return regions


def _surfaces(cover: Cover, shop: FieldWorkshop, rng: np.random.Generator) -> tuple[int, int]:
    """Two palette indices of a cover."""
    palette = shop.palette
    dry, green = palette.variants("grass_dry"), palette.only("grass_watered")
    away = palette.special("grass_watered", "mown away", solar_absorptance=0.73)
    one, two = rng.choice(len(dry), 2, replace=False)
    if cover is Cover.PLOUGHED:
        wet, bare = palette.variants("soil_wet", 2), palette.variants("soil_dry", 3)
        return (
            (wet[0], wet[1])
            if rng.uniform() < 0.4
            else (bare[int(rng.integers(3))], bare[int(rng.integers(3))])
        )
    if cover in (Cover.STUBBLE, Cover.HAY, Cover.WOOD):
        return dry[int(one)], dry[int(two)]
    if cover is Cover.CROP and rng.uniform() < 0.45:
        return dry[int(one)], dry[int(two)]
    if cover is Cover.MEADOW and rng.uniform() < shop.dryness:
        return dry[int(one)], dry[int(two)] if rng.uniform() < 0.6 else green
    return green, away if cover is Cover.CROP else dry[int(one)]


def _across(parcel: Parcel, pitch_m: float) -> tuple[np.ndarray, np.ndarray, np.ndarray, float]:
    """A parcel's middle, its long direction, the places of lines across it, and half its length."""
    middle = shapely.get_coordinates(parcel.outline.centroid)[0]
    along = np.array([np.cos(parcel.heading_rad), np.sin(parcel.heading_rad)])
    ring = shapely.get_coordinates(parcel.outline.exterior) - middle
    side = ring @ np.array([-along[1], along[0]])
    return (
        middle,
        along,
        np.arange(side.min() + 0.5 * pitch_m, side.max(), pitch_m),
        float(np.abs(ring @ along).max()),
    )


def _swaths(parcel: Parcel, width_m: float) -> list[shapely.Polygon]:
    """Every second of the strips a machine leaves along a parcel, clear of its headland."""
    middle, along, offset, reach = _across(parcel, 2 * width_m)
    left = np.array([-along[1], along[0]])
    starts = middle + offset[:, None] * left
    corners = [starts + s * reach * along + t * width_m * left for s, t in ((-1, 0), (1, 0), (1, 1), (-1, 1))]
    headland = parcel.outline.buffer(-width_m, join_style="mitre")
    parts = shapely.get_parts(shapely.intersection(shapely.polygons(np.stack(corners, axis=1)), headland))
    keep = (shapely.get_type_id(parts) == 3) & (shapely.area(parts) > 60.0)
    return list(parts[keep])


def _tramlines(parcel: Parcel, pitch_m: float) -> list[shapely.Polygon]:
    """Bare wheel tracks in the middle of every second strip."""
    middle, along, offset, reach = _across(parcel, 2 * pitch_m)
    left = np.array([-along[1], along[0]])
    starts = middle + (offset + 0.5 * pitch_m)[:, None] * left
    lines = shapely.linestrings(np.stack([starts - reach * along, starts + reach * along], axis=1))
    parts = shapely.get_parts(shapely.intersection(lines, parcel.outline.buffer(-1.2 * pitch_m)))
    parts = parts[(shapely.get_type_id(parts) == 1) & (shapely.length(parts) > 20.0)]
    return list(shapely.buffer(parts, _TRAM_M / 2, cap_style="flat"))


def _patches(parcel: Parcel, rng: np.random.Generator) -> list[shapely.Polygon]:
    """Irregular patches of other growth, apart from each other."""
    found: list[shapely.Polygon] = []
    x0, y0, x1, y1 = parcel.outline.bounds
    room = parcel.outline.buffer(-4.0)
    for _ in range(min(3 + int(parcel.outline.area / 1500.0), 16)):
        shape = blob(rng.uniform((x0, y0), (x1, y1)), rng.uniform(3.0, 13.0), rng)
        if room.contains(shape) and not any(shape.dwithin(other, 3.0) for other in found):
            found.append(shape)
    return found


def blob(centre: np.ndarray, radius_m: float, rng: np.random.Generator) -> shapely.Polygon:
    """A smooth irregular outline."""
    angle = np.linspace(0.0, 2 * np.pi, 20, endpoint=False)
    shape = np.ones(20)
    for k in (2, 3, 4):
        shape = shape + rng.uniform(0.05, 0.3) / k * np.cos(k * angle + rng.uniform(0.0, 2 * np.pi))
    stretch, turn = rng.uniform(0.6, 1.0), rng.uniform(0.0, np.pi)
    ring = radius_m * shape[:, None] * np.column_stack([np.cos(angle), stretch * np.sin(angle)])
    c, s = np.cos(turn), np.sin(turn)
    return shapely.Polygon(centre + ring @ np.array([[c, s], [-s, c]]))
