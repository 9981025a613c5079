"""The ground plan of a field world: land, roads, grounds, pitches, and holes under whatever is built."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
import shapely

from scenegen.classes import Semantic
from scenegen.geometry.ground import Region, drape
from scenegen.geometry.part import Part
from scenegen.geometry.planar import triangulate
from scenegen.geometry.scatter import contact_points, hexagonal
from scenegen.maps.field.country import FAR_M, ROAD_HALF_M, Country, offset_line, ribbon
from scenegen.maps.field.covers import blob, parcel_regions
from scenegen.maps.field.frame import Plot
from scenegen.maps.field.grounds import Grounds
from scenegen.maps.field.pitch import pitch_regions
from scenegen.maps.field.track import track_regions
from scenegen.maps.field.workshop import FieldWorkshop

_TUCK_M = 0.01
_CONTACT_M = 1.2
_PATH_HALF_M = 1.2
_BANK_M = 0.25
_LINE_SPACING_M, _FINE_LINE_M = 6.0, 3.0
_GROUNDS_M, _NEAR_M = 2.7, 4.6
_BANDS = ((1.7, 12.0), (4.2, 30.0), (1e9, 65.0))


def build_terrain(
    grounds: Grounds,
    country: Country,
    footprints: Sequence[shapely.Polygon],
    half_m: float,
    shop: FieldWorkshop,
    rng: np.random.Generator,
) -> Part:
    """All ground, from the pitches to the far edge.

    Parameters
    ----------
    grounds, country
        The plan.
    footprints : sequence of shapely.Polygon
        Plans of buildings and stands: there is no ground below.
    half_m : float
        Half the side of the detailed square.
    shop : FieldWorkshop
    rng : numpy.random.Generator
    """
    land = shop.builder.new_objects()
    everywhere = shapely.box(-FAR_M, -FAR_M, FAR_M, FAR_M)
    coarse = [Region(everywhere, shop.palette.pick("grass_dry", rng), int(Semantic.GRASS), land)]
    coarse += parcel_regions(country.parcels, shop, rng)
    coarse += _grounds_regions(grounds, shop, rng) + _country_regions(country, shop, rng)
    fine = track_regions(grounds.frame, shop, rng) if grounds.track else []
    for pitch in grounds.pitches:
        fine += pitch_regions(pitch, shop, rng)
    fine += _markings(grounds, country, half_m, shop)
    holes = shapely.union_all(list(footprints)).buffer(-_TUCK_M, join_style="mitre")
    solid = list(shapely.get_parts(holes))
    hollow = [Region(p, coarse[0].surface, 0, 0, hole=True) for p in solid]
    regions = [*coarse, *fine, *hollow]
    spacing = np.repeat([_LINE_SPACING_M, _FINE_LINE_M, _CONTACT_M], [len(coarse), len(fine), len(hollow)])
    points = np.concatenate([contact_points(solid, _CONTACT_M, 0.9), _lattice(grounds, half_m, rng)])
    plan = triangulate([r.outline for r in regions], points, spacing, (1.1 * half_m, 0.16))
    return drape(plan, regions, shop.relief)


def _lattice(grounds: Grounds, half_m: float, rng: np.random.Generator) -> np.ndarray:
    """Points fine in the grounds, coarser in the detailed square, coarser still in bands around it."""
    outline = grounds.outline.buffer(12.0)
    shapely.prepare(outline)
    x0, y0, x1, y1 = outline.bounds
    fine = hexagonal(x0, y0, x1, y1, _GROUNDS_M, rng)
    rows = [fine[shapely.contains_xy(outline, fine)]]
    square = hexagonal(-half_m, -half_m, half_m, half_m, _NEAR_M, rng)
    rows.append(square[~shapely.contains_xy(outline, square)])
    inner = half_m
    for factor, spacing in _BANDS:
        outer = min(factor * half_m, FAR_M - 0.4 * spacing)
        ring = hexagonal(-outer, -outer, outer, outer, spacing, rng)
        reach = np.abs(ring).max(axis=1)
        rows.append(
            ring[(reach > inner + 0.4 * spacing) & (reach < outer) & ~shapely.contains_xy(outline, ring)]
        )
        inner = outer
    return np.concatenate(rows)


def _grounds_regions(grounds: Grounds, shop: FieldWorkshop, rng: np.random.Generator) -> list[Region]:
    """Lawn, paving, car park and footpaths."""
    lawn_name = "grass_dry" if rng.uniform() < shop.dryness else "grass_watered"
    lawn = shop.palette.pick(lawn_name, rng)
    paving, asphalt = shop.palette.pick("concrete_pavement", rng), shop.palette.pick("asphalt_aged", rng)
    gravel = shop.palette.pick("soil_dry", rng) if rng.uniform() < 0.35 else asphalt
    green, paved, parking, walks = (shop.builder.new_objects() for _ in range(4))
    walk, road = int(Semantic.SIDEWALK), int(Semantic.ROAD)
    apron = [s.outline(1.6) for s in grounds.stands]
    regions = [Region(grounds.outline, lawn, int(Semantic.GRASS), green)]
    worn = shop.palette.pick("grass_dry", rng)
    room = grounds.outline.buffer(-3.0)
    for _ in range(14):
        spot = blob(rng.uniform(room.bounds[:2], room.bounds[2:]), rng.uniform(1.5, 5.0), rng)
        if room.contains(spot):
            regions.append(Region(spot, worn, int(Semantic.GRASS), green))
    regions += [Region(p, paving, walk, walks) for p in _walks(grounds)]
    regions += [
        Region(p, paving, walk, paved)
        for p in shapely.get_parts(shapely.union_all([grounds.forecourt, *apron]))
    ]
    return [*regions, Region(grounds.car_park.outline(0.8), gravel, road, parking)]


def _walks(grounds: Grounds) -> list[shapely.Polygon]:
    """Footpaths, and a gravelled strip around the main field where it has no track."""
    lines = [
        shapely.LineString(p).buffer(_PATH_HALF_M, cap_style="flat", join_style="mitre")
        for p in grounds.paths
    ]
    half_x, half_y = grounds.half_m
    ring = Plot(grounds.frame, half_x + 0.9, half_y + 0.9)
    if not grounds.track:
        lines.append(ring.outline().difference(ring.outline(-0.9)))
    return list(shapely.get_parts(shapely.union_all(lines))) if lines else []


def _country_regions(country: Country, shop: FieldWorkshop, rng: np.random.Generator) -> list[Region]:
    """Farmyard and track, pond, road and drive."""
    soil, asphalt = shop.palette.pick("soil_dry", rng), shop.palette.pick("asphalt_aged", rng)
    yard, road, water = (shop.builder.new_objects() for _ in range(3))
    dirt = int(Semantic.SOIL)
    track = shapely.LineString(country.farm.track).buffer(1.6, cap_style="flat")
    regions = [Region(p, soil, dirt, yard) for p in (country.farm.yard.outline(), track)]
    if country.pond is not None:
        outline = pond_outline(country.pond)
        level = float(shop.relief(shapely.get_coordinates(outline)).min()) - _BANK_M
        skin = shop.palette.special("water_fresh_or_sea", "pond")
        bank = shop.palette.pick("soil_wet", rng)
        regions.append(Region(outline.buffer(1.1), bank, dirt, shop.builder.new_objects()))
        regions.append(Region(outline, skin, int(Semantic.WATER), water, level, absolute=True))
    regions.append(Region(ribbon(country.road, -ROAD_HALF_M - 0.9, ROAD_HALF_M + 0.9), soil, dirt, yard))
    return regions + [
        Region(p, asphalt, int(Semantic.ROAD), road) for p in (country.drive, country.carriageway)
    ]


def pond_outline(plot: Plot) -> shapely.Polygon:
    """Shore of the pond of a platform: a bean."""
    angle = np.linspace(0.0, 2 * np.pi, 32, endpoint=False)
    reach = 0.86 + 0.12 * np.cos(2 * angle + 0.7) - 0.1 * np.sin(3 * angle)
    ring = reach[:, None] * np.column_stack([np.cos(angle) * plot.half_x_m, np.sin(angle) * plot.half_y_m])
    return shapely.Polygon(plot.frame.world(ring))


def _markings(grounds: Grounds, country: Country, half_m: float, shop: FieldWorkshop) -> list[Region]:
    """Dashes and edge lines on the country road, bays in the car park."""
    paint = shop.palette.special("asphalt_aged", "paint", solar_absorptance=0.55)
    owner, mark = shop.builder.new_objects(), int(Semantic.ROAD_MARKING)
    near = np.abs(country.road).max(axis=1) < 1.15 * half_m
    road = country.road[np.flatnonzero(near)[0] : np.flatnonzero(near)[-1] + 1]
    edge = ROAD_HALF_M - 0.25
    quads = [_pieces(road, -0.06, 0.06)[::3], _pieces(road, -edge - 0.06, -edge + 0.06)]
    quads += [
        _pieces(road, edge - 0.06, edge + 0.06),
        grounds.car_park.frame.world(bay_lines(grounds.car_park)),
    ]
    return [Region(q, paint, mark, owner, lumped=True) for q in shapely.polygons(np.concatenate(quads))]


def _pieces(line: np.ndarray, left_m: float, right_m: float) -> np.ndarray:
    """Quads between two offsets to the right of a line, one per step (quads, 4, 2)."""
    left, right = offset_line(line, left_m), offset_line(line, right_m)
    return np.stack([right[:-1], right[1:], left[1:], left[:-1]], axis=1)


def bay_lines(car_park: Plot) -> np.ndarray:
    """Lines between bays of every module of a car park, in its frame (quads, 4, 2)."""
    half_x, half_y = car_park.half_x_m, car_park.half_y_m
    x = np.arange(-half_x, half_x + 0.1, 2.7)
    quads = []
    for low in np.arange(-half_y, half_y - 1.0, 16.6):
        for y0, y1 in ((low, low + 5.0), (low + 11.6, low + 16.6)):
            corners = [(x - 0.05, y0), (x + 0.05, y0), (x + 0.05, y1), (x - 0.05, y1)]
            quads.append(np.stack([np.column_stack([u, np.full(len(u), v)]) for u, v in corners], axis=1))
    return np.concatenate(quads)
