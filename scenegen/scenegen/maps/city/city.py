"""The city: streets, blocks, buildings, ground, greenery, traffic and the land around, from one generator."""

from __future__ import annotations

import numpy as np
import shapely

from scenegen.buildings.roof_gear import draw_roof_gear
from scenegen.buildings.shells import build_shells
from scenegen.climate.season import Season
from scenegen.geometry.builder import GeometryBuilder
from scenegen.geometry.relief import draw_relief, sample_height_field
from scenegen.maps.city.districts import lay_out
from scenegen.maps.city.furniture import build_furniture
from scenegen.maps.city.greenery import build_greenery
from scenegen.maps.city.knobs import CityKnobs
from scenegen.maps.city.motion import plan_motion
from scenegen.maps.city.outskirts import far_objects, plan_far
from scenegen.maps.city.park import plan_park
from scenegen.maps.city.streets import draw_streets
from scenegen.maps.city.terrain import build_terrain
from scenegen.maps.city.traffic import build_traffic, plan_traffic
from scenegen.maps.city.uses import Use
from scenegen.maps.city.workshop import CityWorkshop
from scenegen.materials.palette import PaletteBuilder
from scenegen.world import World

_MARGIN_M = 12.0


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
    (
        own,
        streets,
        hills,
        skins,
        lots,
        parks_rng,
        ground,
        walls,
        gear_rng,
        cars_rng,
        posts_rng,
        green,
        far,
        on,
    ) = rng.spawn(14)
    extent = own.uniform(*knobs.extent_m)
    palette, builder = PaletteBuilder(skins), GeometryBuilder()
    palette.variants("asphalt_aged", 3)  # the fourth is its paint
    plan = draw_streets(extent, knobs.block_area_m2, own.uniform(*knobs.street_bend_m), streets)
    relief = draw_relief(hills, hills.uniform(*knobs.relief_m), (280.0, 900.0))
    shop = CityWorkshop(relief, palette, builder, season, knobs)
    layout = lay_out(plan, shop, lots)
    parks = {k: plan_park(b.yard, parks_rng) for k, b in enumerate(layout.blocks) if b.use is Use.PARK}
    gear = draw_roof_gear(layout.buildings, gear_rng)
    traffic = plan_traffic(plan, layout, knobs, cars_rng)
    land = plan_far(plan, far)

    terrain = build_terrain(plan, layout, parks, traffic.outlines(), land.outlines(), shop, ground)
    builder.add(terrain)
    builder.add(build_shells(layout.buildings, gear.plans, walls), *gear.parts)
    cars = build_traffic(traffic, shop, cars_rng)
    furniture, posts = build_furniture(plan, parks, shop, posts_rng)
    trees, tree_count = build_greenery(layout, parks, posts, shop, green)
    builder.add(*cars, *furniture, *trees, *far_objects(land, plan, terrain, shop, far))
    movers = plan_motion(plan, shop, on)
    merged = builder.merge()
    half = _inner_half(plan.outline)
    return World(
        map="city",
        mesh=merged.mesh,
        face_surface=merged.face_surface,
        face_semantic=merged.face_semantic,
        face_object=merged.face_object,
        corner_site=merged.corner_site,
        sites=merged.sites,
        palette=palette.surfaces(),
        ground=sample_height_field(relief, float(np.abs(plan.outline.bounds).max()) + 60.0, 5.0),
        flight_box_m=((-half, -half, 0.0), (half, half, knobs.flight_ceiling_m)),
        counts=(
            ("streets", len(plan.streets)),
            ("blocks", len(layout.blocks)),
            ("parks", len(parks)),
            ("buildings", len(layout.buildings)),
            ("cars", len(traffic.spots)),
            ("lamps and signs", len(posts)),
            ("trees", tree_count),
            ("vehicles that drive", sum(m.kind != "person" for m in movers)),
            ("people who walk", sum(m.kind == "person" for m in movers)),
        ),
        movers=movers,
    )


def _inner_half(outline: shapely.Polygon) -> float:
    """Half the side [m] of the largest upright square around the origin inside the detailed part."""
    reach = np.linspace(50.0, 600.0, 276)
    inner = outline.buffer(-_MARGIN_M)
    fits = [inner.contains(shapely.box(-r, -r, r, r)) for r in reach]
    return float(reach[int(np.argmin(fits)) - 1])
