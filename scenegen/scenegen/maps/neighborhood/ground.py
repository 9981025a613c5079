"""The ground plan: far land, commons, gardens, streets, driveways and pools, with holes under houses."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
import shapely

from scenegen.classes import Semantic
from scenegen.geometry.fineness import Fineness, ground_below
from scenegen.geometry.ground import Region, drape
from scenegen.geometry.part import Part
from scenegen.geometry.planar import Triangulation, triangulate
from scenegen.geometry.scatter import contact_points
from scenegen.maps.neighborhood.markings import marking_quads
from scenegen.maps.neighborhood.outskirts import far_regions
from scenegen.maps.neighborhood.parcels import Parcel
from scenegen.maps.neighborhood.streets import FAR_M, KERB_M, StreetPlan
from scenegen.maps.neighborhood.workshop import NeighborhoodWorkshop

_FINENESS = Fineness(
    lattice_m=(3.0, 4.6), near_m=3.5, wall_row_m=(1.9, 1.0), line_m=3.4, car_line_m=1.6, road_grain_m=0.7,
    grain_m=1.1,
)  # fmt: skip
_CAR_ROW, _FENCE_ROW = (2.0, 0.7), (2.6, 0.8)
"""Spacing, distance of rows of points around cars and along fences."""
_TUCK_M, _SILL_M, _GRID_M = 0.01, 0.15, 0.002
_WATER_BELOW_M = 0.14


def build_ground(
    plan: StreetPlan,
    parcels: Sequence[Parcel],
    holes: Sequence[shapely.Polygon],
    cars: np.ndarray,
    borders: np.ndarray,
    shop: NeighborhoodWorkshop,
    rng: np.random.Generator,
) -> tuple[Part, Triangulation]:
    """All ground, from the middle to the far edge, and the plan of its mesh.

    Parameters
    ----------
    plan : StreetPlan
    parcels : sequence of Parcel
    holes : sequence of shapely.Polygon
        Where houses, porches and sheds stand.
    cars : array of shapely.Polygon
        Plan of each standing car.
    borders : array of shapely.LineString
        Fences and hedges: they cast shadows on both sides.
    shop : NeighborhoodWorkshop
    rng : numpy.random.Generator
    """
    regions = far_regions(plan, shop, rng)
    regions += _commons(plan, shop, rng)
    regions += _lawns(parcels, shop, rng)
    regions += _streets(plan, shop, rng)
    regions += _paving(parcels, plan, shop, rng)
    regions += _pools(parcels, shop, rng)
    regions += ground_below(shapely.buffer(cars, -_SILL_M, join_style="mitre"), regions)
    solid = shapely.union_all(np.asarray(holes, dtype=object), grid_size=_GRID_M)
    whole = list(shapely.get_parts(shapely.buffer(solid, -_TUCK_M, join_style="mitre")))
    regions += [Region(p, regions[0].surface, 0, 0, hole=True) for p in whole]
    regions = _FINENESS.grained(regions)
    half = float(np.abs(plan.outline.bounds).max())
    strips = shapely.buffer(borders, 0.05, cap_style="flat")
    plane = triangulate(
        [r.outline for r in regions],
        _FINENESS.lattice(plan.outline, whole, [cars, borders], FAR_M, rng),
        np.array([_FINENESS.line_spacing(r) for r in regions]),
        (half * 1.03, 0.2),
        np.concatenate([contact_points(list(cars), *_CAR_ROW), contact_points(list(strips), *_FENCE_ROW)]),
    )
    return drape(plane, regions, shop.relief), plane


def _commons(plan: StreetPlan, shop: NeighborhoodWorkshop, rng: np.random.Generator) -> list[Region]:
    """Everything inside the outline that will be neither street nor garden."""
    skin = shop.palette.pick("grass_dry" if rng.uniform() < 0.6 else "grass_watered", rng)
    return [Region(plan.outline, skin, int(Semantic.GRASS), shop.builder.new_objects(), KERB_M)]


def _lawns(parcels: Sequence[Parcel], shop: NeighborhoodWorkshop, rng: np.random.Generator) -> list[Region]:
    """One lawn per lot, of one of a few kinds."""
    regions = []
    first = shop.builder.new_objects(len(parcels))
    for k, parcel in enumerate(parcels):
        skin = shop.palette.pick("grass_dry" if parcel.dry else "grass_watered", rng)
        regions.append(Region(parcel.lot.area, skin, int(Semantic.GRASS), first + k, KERB_M))
    return regions


def _streets(plan: StreetPlan, shop: NeighborhoodWorkshop, rng: np.random.Generator) -> list[Region]:
    """Sidewalks, then verges, then the carriageway on top."""
    pavement, asphalt = shop.palette.pick("concrete_pavement", rng), shop.palette.pick("asphalt_aged", rng)
    grass = shop.palette.pick("grass_dry" if rng.uniform() < 0.5 else "grass_watered", rng)
    walk, verge, road = shop.builder.new_objects(), shop.builder.new_objects(), shop.builder.new_objects()
    public = shapely.intersection(plan.front, plan.outline)  # not across the roads that leave
    regions = [
        Region(p, pavement, int(Semantic.SIDEWALK), walk, KERB_M)
        for p in shapely.get_parts(public)
        if p.geom_type == "Polygon"
    ]
    if plan.verge_m > 0:
        strip = plan.carriageway.buffer(plan.verge_m, quad_segs=4).simplify(0.05)
        regions += [
            Region(p, grass, int(Semantic.GRASS), verge, KERB_M)
            for p in shapely.get_parts(strip.intersection(public))
            if p.geom_type == "Polygon"
        ]
    regions.append(Region(plan.carriageway, asphalt, int(Semantic.ROAD), road))
    paint = shop.palette.special("asphalt_aged", "paint", solar_absorptance=0.55)
    marking, quads = shop.builder.new_objects(), shapely.polygons(marking_quads(plan, rng))
    return regions + [
        Region(q, paint, int(Semantic.ROAD_MARKING), marking, lumped=True, merge_m=_FINENESS.line_m)
        for q in quads
    ]


def _paving(
    parcels: Sequence[Parcel], plan: StreetPlan, shop: NeighborhoodWorkshop, rng: np.random.Generator
) -> list[Region]:
    """Driveways, paths, patios, copings and beds; each house has its own, its paving of one kind."""
    regions = []
    for parcel in parcels:
        if not parcel.paved():
            continue
        owner = shop.builder.new_objects()
        stone = shop.palette.pick("concrete_pavement", rng)
        tar = rng.uniform() < 0.3
        drive = shop.palette.pick("asphalt_aged", rng) if tar else stone
        garden = parcel.garden
        for outline, skin, semantic in (
            (parcel.driveway, drive, Semantic.ROAD if tar else Semantic.SIDEWALK),
            (parcel.path, stone, Semantic.SIDEWALK),
            (garden.patio, stone, Semantic.SIDEWALK),
            (garden.coping, stone, Semantic.SIDEWALK),
            (garden.bed, shop.palette.pick("soil_wet", rng), Semantic.SOIL),
        ):
            if outline is not None:
                regions.append(Region(outline, skin, int(semantic), owner, KERB_M))
    return regions


def _pools(parcels: Sequence[Parcel], shop: NeighborhoodWorkshop, rng: np.random.Generator) -> list[Region]:
    """Water a little below the coping."""
    regions = []
    for parcel in parcels:
        pool = parcel.garden.pool
        if pool is not None:
            level = float(shop.relief(shapely.get_coordinates(pool.exterior)).min()) + KERB_M - _WATER_BELOW_M
            skin = shop.palette.special("water_fresh_or_sea", "pool")  # the heat balance knows the season
            owner = shop.builder.new_objects()
            regions.append(Region(pool, skin, int(Semantic.WATER), owner, level, absolute=True))
    return regions
