"""The city: streets, blocks, buildings, ground, greenery, traffic and the land around, from one generator."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import shapely

from scenegen.buildings.roof_gear import RoofGear, draw_roof_gear
from scenegen.buildings.shells import build_shells
from scenegen.climate.season import Season
from scenegen.geometry.builder import GeometryBuilder
from scenegen.geometry.relief import draw_relief, sample_height_field
from scenegen.maps.city.districts import Layout, lay_out
from scenegen.maps.city.furniture import Furniture, build_furniture, plan_furniture
from scenegen.maps.city.girder import build_viaduct
from scenegen.maps.city.greenery import build_greenery
from scenegen.maps.city.knobs import CityKnobs
from scenegen.maps.city.motion import plan_motion
from scenegen.maps.city.outskirts import FarPlan, far_objects, plan_far
from scenegen.maps.city.overhead import Overhead, build_overhead, plan_overhead
from scenegen.maps.city.park import ParkPlan, plan_park
from scenegen.maps.city.people import build_people
from scenegen.maps.city.stops import Stops, plan_stops
from scenegen.maps.city.streets import StreetPlan, draw_streets
from scenegen.maps.city.terrain import build_terrain
from scenegen.maps.city.traffic import Traffic, build_traffic, plan_traffic
from scenegen.maps.city.uses import Use
from scenegen.maps.city.viaduct import Viaduct, plan_viaduct
from scenegen.maps.city.workshop import CityWorkshop
from scenegen.materials.palette import PaletteBuilder
from scenegen.world import World

_MARGIN_M = 12.0
_BENCH_M = 1.1
"""Reach of a bench from its middle."""
_POST_M = 0.35
"""Radius that a post or a bin takes from people who stand about."""


@dataclass(frozen=True, eq=False)
class _Plans:
    """Everything that stands somewhere, before it becomes geometry."""

    streets: StreetPlan
    layout: Layout
    parks: dict[int, ParkPlan]
    gear: RoofGear
    stops: Stops
    traffic: Traffic
    viaduct: Viaduct | None
    furniture: Furniture
    overhead: Overhead
    land: FarPlan


def build_city(knobs: CityKnobs, season: Season, rng: np.random.Generator) -> World:
    """Build one city.

    Parameters
    ----------
    knobs : CityKnobs
    season : Season
        Decides what is in leaf.
    rng : numpy.random.Generator
        The only source of randomness; each subsystem gets a child of its own, so that none disturbs another.
    """
    own, network, hills, skins, for_plans, for_parts, on = rng.spawn(7)
    extent, bend_m = own.uniform(*knobs.extent_m), own.uniform(*knobs.street_bend_m)
    palette, builder = PaletteBuilder(skins), GeometryBuilder()
    palette.variants("asphalt_aged", 3)  # the fourth is its paint
    streets = draw_streets(extent, knobs.block_area_m2, bend_m, network)
    relief = draw_relief(hills, hills.uniform(*knobs.relief_m), (280.0, 900.0))
    shop = CityWorkshop(relief, palette, builder, season, knobs)
    plans = _plan(streets, shop, for_plans)
    counts = _build(plans, shop, for_parts)
    movers = plan_motion(streets, shop, on)
    half = _inner_half(streets.outline)
    return builder.merge().world(
        map="city",
        palette=palette.surfaces(),
        ground=sample_height_field(relief, float(np.abs(streets.outline.bounds).max()) + 60.0, 5.0),
        flight_box_m=((-half, -half, 0.0), (half, half, knobs.flight_ceiling_m)),
        counts=(
            *counts,
            ("vehicles that drive", sum(m.kind != "person" for m in movers)),
            ("people who walk", sum(m.kind == "person" for m in movers)),
        ),
        movers=movers,
    )


def _plan(streets: StreetPlan, shop: CityWorkshop, rng: np.random.Generator) -> _Plans:
    """Place everything, the large first: what comes later keeps clear of it."""
    lots, for_parks, on_roofs, at_stops, cars, rail, posts, wired, far = rng.spawn(9)
    layout = lay_out(streets, shop, lots)
    parks = {k: plan_park(b.yard, for_parks) for k, b in enumerate(layout.blocks) if b.use is Use.PARK}
    stops = plan_stops(streets, shop, at_stops)
    viaduct = plan_viaduct(streets, shop, rail)
    covered = None if viaduct is None else viaduct.street
    furniture = plan_furniture(streets, parks, stops, covered, posts)
    return _Plans(
        streets,
        layout,
        parks,
        draw_roof_gear(layout.buildings, on_roofs),
        stops,
        plan_traffic(streets, layout, stops, shop.knobs, cars),
        viaduct,
        furniture,
        plan_overhead(streets, np.concatenate([furniture.posts(), stops.places()]), covered, shop, wired),
        plan_far(streets, far),
    )


def _build(plans: _Plans, shop: CityWorkshop, rng: np.random.Generator) -> tuple[tuple[str, int], ...]:
    """Make parts of all plans and hand them to the builder; returns what was built."""
    ground, walls, cars, posts, crowd, green, far = rng.spawn(7)
    streets, layout, parks, add = plans.streets, plans.layout, plans.parks, shop.builder.add
    standing = plans.traffic.outlines()
    if plans.viaduct is not None:
        standing = np.concatenate([standing, plans.viaduct.outlines(streets.outline)])
        add(*build_viaduct(plans.viaduct, streets, shop))
    terrain = build_terrain(streets, layout, parks, standing, plans.land.outlines(), shop, ground)
    add(terrain, build_shells(layout.buildings, plans.gear.plans, walls), *plans.gear.parts)
    add(*build_traffic(plans.traffic, shop, cars), *build_furniture(plans.furniture, shop, posts))
    add(*build_overhead(plans.overhead, shop))
    at_kerb = np.concatenate([plans.furniture.posts(), plans.overhead.places()])
    benches = shapely.buffer(shapely.points(plans.furniture.rows["bench"][:, :2]), _BENCH_M)
    taken = np.concatenate(
        [
            shapely.buffer(shapely.points(at_kerb), _POST_M, quad_segs=2),
            benches,
            plans.stops.outlines(),
            plans.traffic.outlines(),
        ]
    )
    people, people_at = build_people(streets, parks, plans.stops, taken, shop, crowd)
    trees, tree_count = build_greenery(
        layout, parks, np.concatenate([at_kerb, people_at, plans.stops.places()]), shop, green
    )
    add(*people, *trees, *far_objects(plans.land, streets, terrain, shop, far))
    return (
        ("streets", len(streets.streets)),
        ("blocks", len(layout.blocks)),
        ("parks", len(parks)),
        ("buildings", len(layout.buildings)),
        ("viaducts", int(plans.viaduct is not None)),
        ("vehicles that stand", len(plans.traffic.spots)),
        ("bus stops", len(plans.stops.shelters)),
        ("lamps, lights, signs and poles", len(at_kerb)),
        ("people who stay", len(people_at)),
        ("trees", tree_count),
    )


def _inner_half(outline: shapely.Polygon) -> float:
    """Half the side [m] of the largest upright square around the origin inside the detailed part."""
    reach = np.linspace(50.0, 600.0, 276)
    inner = outline.buffer(-_MARGIN_M)
    fits = [inner.contains(shapely.box(-r, -r, r, r)) for r in reach]
    return float(reach[int(np.argmin(fits)) - 1])
