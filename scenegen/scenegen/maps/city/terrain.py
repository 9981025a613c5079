"""The ground plan of the city: far land, streets, sidewalks, yards, and holes under buildings."""

from __future__ import annotations

import numpy as np
import shapely

from scenegen.classes import Semantic
from scenegen.geometry.fineness import Fineness, ground_below
from scenegen.geometry.ground import Region, drape
from scenegen.geometry.hidden import push_out
from scenegen.geometry.part import Part
from scenegen.geometry.planar import triangulate
from scenegen.geometry.scatter import contact_points
from scenegen.maps.city.districts import Block, Layout
from scenegen.maps.city.markings import marking_quads
from scenegen.maps.city.outskirts import FAR_M, far_regions
from scenegen.maps.city.park import ParkPlan, park_regions
from scenegen.maps.city.streets import KERB_M, StreetPlan
from scenegen.maps.city.uses import Use
from scenegen.maps.city.workshop import CityWorkshop

_FINENESS = Fineness(
    lattice_m=(3.3, 5.5), near_m=3.8, wall_row_m=(1.8, 1.0), line_m=4.4, car_line_m=1.7, road_grain_m=0.6,
    grain_m=0.9, leap=3.5,
)  # fmt: skip
_FIELD_LINE_M = 12.0
"""Spacing along the outlines of fields around the city."""
_FAR_LINES_M, _FAR_TUCK_M, _FAR_ROW, _FAR_BESIDE_M = 350.0, 0.3, (14.0, 7.0), 2.5
"""Around the city: how far out plain buildings and groves have contact lines, how far these lie below them, their
rows of points, and how far beyond the sites keep clear of them."""
_SILL_M = 0.15
"""How far below a car the ground still looks out past its sill."""
_CAR_ROWS = ((1.8, 0.65), (3.6, 1.7))
"""Spacing, distance of rows of points around cars: what a car hides of the sky falls off within its height."""
_TUCK_M = 0.01


def build_terrain(
    plan: StreetPlan,
    layout: Layout,
    parks: dict[int, ParkPlan],
    cars: np.ndarray,
    far: np.ndarray,
    shop: CityWorkshop,
    rng: np.random.Generator,
) -> Part:
    """All ground, from the middle of the city to the far edge.

    Parameters
    ----------
    plan, layout, parks
        What was drawn so far; parks by block index.
    cars, far : array of shapely.Polygon
        Plan of each car, and of what stands on the land around, rectangles.
    shop : CityWorkshop
    rng : numpy.random.Generator
    """
    dry_share = rng.uniform(*shop.knobs.dry_lawn_share)
    regions = far_regions(plan, shop, rng)
    near = far[shapely.distance(plan.outline, far) < _FAR_LINES_M]
    regions += ground_below(shapely.buffer(near, -_FAR_TUCK_M, join_style="mitre"), regions)
    fields = len(regions)
    regions += _streets(plan, shop, rng)
    for k, block in enumerate(layout.blocks):
        regions += _block_regions(block, dry_share, shop, rng)
        if k in parks:
            regions += park_regions(parks[k], shop, rng)
    regions += _paths(layout, shop, rng)
    regions += ground_below(shapely.buffer(cars, -_SILL_M, join_style="mitre"), regions)
    holes = shapely.union_all([b.footprint for b in layout.buildings]).buffer(-_TUCK_M, join_style="mitre")
    solid = list(getattr(holes, "geoms", [holes]))
    regions += [Region(p, regions[0].surface, 0, 0, hole=True) for p in solid]
    half = float(np.abs(plan.outline.bounds).max())
    regions = _FINENESS.grained(regions)
    outlines = [r.outline for r in regions]
    plane = triangulate(
        outlines,
        _FINENESS.lattice(plan.outline, solid, [cars], FAR_M, rng),
        np.array([_FIELD_LINE_M if k < fields else _FINENESS.line_spacing(r) for k, r in enumerate(regions)]),
        (half * 1.03, 0.2),
        np.concatenate(
            [*(contact_points(list(cars), *row) for row in _CAR_ROWS), contact_points(list(near), *_FAR_ROW)]
        ),
    )
    return push_out(drape(plane, regions, shop.relief), far, _FAR_BESIDE_M)


def _streets(plan: StreetPlan, shop: CityWorkshop, rng: np.random.Generator) -> list[Region]:
    road = shop.builder.new_objects()
    paint = shop.palette.special("asphalt_aged", "paint", solar_absorptance=0.55)
    marking = shop.builder.new_objects()
    regions = [Region(plan.outline, shop.palette.pick("asphalt_aged", rng), int(Semantic.ROAD), road)]
    quads = shapely.polygons(marking_quads(plan, rng))
    return regions + [
        Region(q, paint, int(Semantic.ROAD_MARKING), marking, lumped=True, merge_m=_FINENESS.line_m)
        for q in quads
    ]


def _block_regions(
    block: Block, dry_share: float, shop: CityWorkshop, rng: np.random.Generator
) -> list[Region]:
    pavement = shop.palette.pick("concrete_pavement", rng)
    regions = [Region(block.outline, pavement, int(Semantic.SIDEWALK), shop.builder.new_objects(), KERB_M)]
    lawn = shop.palette.pick("grass_dry" if rng.uniform() < dry_share else "grass_watered", rng)
    asphalt = shop.palette.pick("asphalt_aged", rng)
    ground, ground_of_cars = shop.builder.new_objects(), shop.builder.new_objects()
    surface, semantic = {
        Use.INDUSTRY: (asphalt, Semantic.ROAD),
        Use.OFFICES: (pavement, Semantic.SIDEWALK),
        Use.PERIMETER: (pavement, Semantic.SIDEWALK),
    }.get(block.use, (lawn, Semantic.GRASS))
    # Terraces stand on the edge of the yard: a second line there would only split theirs.
    inner = block.yard.buffer(-6.0, join_style="mitre") if block.use is Use.PERIMETER else block.yard
    regions.append(Region(inner, surface, int(semantic), ground, KERB_M))
    if block.use is Use.PERIMETER:
        court = block.yard.buffer(-17.0, join_style="mitre")
        if court.geom_type == "Polygon" and court.area > 120.0:
            regions.append(Region(court, lawn, int(Semantic.GRASS), shop.builder.new_objects(), KERB_M))
    for lot in block.car_parks:
        bays = lot.area.buffer(-1.0, join_style="mitre")
        if bays.geom_type == "Polygon" and block.use is not Use.INDUSTRY:
            regions.append(Region(bays, asphalt, int(Semantic.ROAD), ground_of_cars, KERB_M))
    if block.use is Use.OFFICES:
        for lot in block.open_lots:
            if lot in block.car_parks:
                continue
            green = lot.area.buffer(-3.5, join_style="mitre").buffer(1.5)
            if green.geom_type == "Polygon" and green.area > 60.0 and rng.uniform() < 0.6:
                regions.append(
                    Region(green.simplify(0.3), lawn, int(Semantic.GRASS), shop.builder.new_objects(), KERB_M)
                )
    return regions


def _paths(layout: Layout, shop: CityWorkshop, rng: np.random.Generator) -> list[Region]:
    """Paved paths from the sidewalk to the doors of detached buildings on lawns."""
    pavement = shop.palette.pick("concrete_pavement", rng)
    first = shop.builder.new_objects()
    regions = []
    for building in layout.buildings:
        if building.front is None:
            continue
        door, kerb = building.front
        length = float(np.linalg.norm(door - kerb))
        if length < 1.0:
            continue
        step = (door - kerb) / length
        line = shapely.LineString([kerb - 0.6 * step, door + 0.1 * step])
        strip = line.buffer(rng.uniform(0.7, 1.4), cap_style="flat")
        regions.append(Region(strip, pavement, int(Semantic.SIDEWALK), first, KERB_M))
    return regions
