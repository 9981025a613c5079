"""The ground plan of the city: far land, streets, sidewalks, yards, and holes under buildings."""

from __future__ import annotations

import numpy as np
import shapely

from scenegen.classes import Semantic
from scenegen.geometry.ground import Region, drape
from scenegen.geometry.part import Part
from scenegen.geometry.planar import triangulate
from scenegen.geometry.scatter import contact_points, graded_points
from scenegen.maps.city.districts import Block, Layout
from scenegen.maps.city.markings import marking_quads
from scenegen.maps.city.outskirts import FAR_M, far_regions
from scenegen.maps.city.park import ParkPlan, park_regions
from scenegen.maps.city.streets import StreetPlan
from scenegen.maps.city.uses import Use
from scenegen.maps.city.workshop import CityWorkshop

KERB_M = 0.12
_GROUND_POINTS, _POINTS_PER_BUILDING = 81_000, 70
_CONTACT_SPACING_M = 1.2
_TUCK_M = 0.01


def build_terrain(
    plan: StreetPlan,
    layout: Layout,
    parks: dict[int, ParkPlan],
    shop: CityWorkshop,
    rng: np.random.Generator,
) -> Part:
    """All ground, from the middle of the city to the far edge.

    Parameters
    ----------
    plan, layout, parks
        What was drawn so far; parks by block index.
    shop : CityWorkshop
    rng : numpy.random.Generator
    """
    dry_share = rng.uniform(*shop.knobs.dry_lawn_share)
    regions = far_regions(plan, shop, rng)
    regions += _streets(plan, shop, rng)
    for k, block in enumerate(layout.blocks):
        regions += _block_regions(block, dry_share, shop, rng)
        if k in parks:
            regions += park_regions(parks[k], shop, rng)
    regions += _paths(layout, shop, rng)
    holes = shapely.union_all([b.footprint for b in layout.buildings]).buffer(-_TUCK_M, join_style="mitre")
    solid = list(getattr(holes, "geoms", [holes]))
    regions += [Region(p, regions[0].surface, 0, 0, hole=True) for p in solid]
    spacing = _ground_spacing(plan.outline.area - holes.area, len(layout.buildings))
    half = float(np.abs(plan.outline.bounds).max())
    points = np.concatenate(
        [
            contact_points(solid, _CONTACT_SPACING_M, 0.9),
            graded_points(plan.outline.buffer(3.0), FAR_M, spacing, rng),
        ]
    )
    outlines = [r.outline for r in regions]
    along = np.array([_CONTACT_SPACING_M if r.hole else 1.05 * spacing for r in regions])
    return drape(triangulate(outlines, points, along, (half * 1.03, 0.11)), regions, shop.relief)


def _ground_spacing(open_m2: float, buildings: int) -> float:
    """Spacing of the lattice [m] (2/sqrt(3)/s^2 points per m^2): what buildings leave of the budget."""
    points = max(_GROUND_POINTS - _POINTS_PER_BUILDING * buildings, 40_000)
    return float(np.sqrt(2 / np.sqrt(3) * open_m2 / points))


def _streets(plan: StreetPlan, shop: CityWorkshop, rng: np.random.Generator) -> list[Region]:
    road = shop.builder.new_objects()
    paint = shop.palette.special("asphalt_aged", "paint", solar_absorptance=0.55)
    marking = shop.builder.new_objects()
    regions = [Region(plan.outline, shop.palette.pick("asphalt_aged", rng), int(Semantic.ROAD), road)]
    quads = shapely.polygons(marking_quads(plan, rng))
    return regions + [Region(q, paint, int(Semantic.ROAD_MARKING), marking, lumped=True) for q in quads]


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
