"""The field: sports grounds in rolling farmland, from one generator."""

from __future__ import annotations

import numpy as np
import shapely

from scenegen.buildings.roof_gear import draw_roof_gear
from scenegen.buildings.shells import build_shells
from scenegen.climate.season import Season
from scenegen.geometry.builder import GeometryBuilder
from scenegen.geometry.placement import rectangles
from scenegen.maps.field.country import lay_out_country
from scenegen.maps.field.crowd import build_crowd
from scenegen.maps.field.fences import build_fences
from scenegen.maps.field.goals import build_benches, build_corner_flags, build_goals
from scenegen.maps.field.grounds import lay_out_grounds
from scenegen.maps.field.houses import plan_houses
from scenegen.maps.field.knobs import FieldKnobs
from scenegen.maps.field.masts import build_flags, build_masts, build_power_line
from scenegen.maps.field.outskirts import far_objects
from scenegen.maps.field.pylons import build_pylons
from scenegen.maps.field.relief import draw_land, height_field, level
from scenegen.maps.field.stands import build_stand
from scenegen.maps.field.terrain import build_terrain
from scenegen.maps.field.traffic import build_traffic
from scenegen.maps.field.workshop import FieldWorkshop
from scenegen.materials.palette import PaletteBuilder
from scenegen.world import World

_MARGIN_M = 12.0
_VARIANTS = (
    ("asphalt_aged", 3), ("grass_watered", 1), ("artificial_turf", 1), ("grass_dry", 4), ("soil_dry", 3),
    ("soil_wet", 2), ("steel_painted", 2), ("steel_galv_post", 2), ("timber_weathered", 2),
    ("plastic_dark", 2), ("vehicle_glass", 1), ("netting_polymer", 2), ("cable_weathered", 2),
)  # fmt: skip
"""Materials of which fewer plain variants are drawn than usual: the others are mown, painted or worn."""


def build_field(knobs: FieldKnobs, season: Season, rng: np.random.Generator) -> World:
    """Build one field world.

    Parameters
    ----------
    knobs : FieldKnobs
    season : Season
        Decides what is in leaf.
    rng : numpy.random.Generator
        The only source of randomness; each subsystem gets a child of its own, so that none disturbs another.
    """
    (
        own,
        plan_rng,
        land_rng,
        hills,
        skins,
        houses_rng,
        ground,
        walls,
        gear_rng,
        sport,
        posts_rng,
        cars_rng,
        crowd_rng,
        far,
    ) = rng.spawn(14)
    half = 0.5 * own.uniform(*knobs.extent_m)
    palette, builder = PaletteBuilder(skins), GeometryBuilder()
    _draw_palette(palette)
    grounds = lay_out_grounds(knobs, plan_rng)
    country = lay_out_country(grounds, half, knobs, land_rng)
    land = draw_land(own.uniform(*knobs.relief_m), own.uniform(*knobs.hills_m), hills)
    ponds = () if country.pond is None else (country.pond,)
    relief = level(land, (*grounds.platforms, country.farm.yard, *ponds))
    shop = FieldWorkshop(relief, palette, builder, season, knobs, own.uniform(*knobs.dry_share))

    houses = plan_houses(grounds, country, relief, shop, houses_rng)
    gear = draw_roof_gear(houses, gear_rng)
    footprints = [h.footprint for h in houses] + [s.outline() for s in grounds.stands]
    builder.add(build_terrain(grounds, country, footprints, half, shop, ground))
    builder.add(build_shells(houses, gear.plans, walls), *gear.parts)
    seats = []
    for stand in grounds.stands:
        parts, places = build_stand(stand, shop, sport)
        builder.add(*parts)
        seats.append(places)
    for pitch in grounds.pitches:
        builder.add(*build_goals(pitch, shop, sport), build_corner_flags(pitch, shop, sport))
        builder.add(*build_benches(pitch, pitch.main and grounds.track, shop, sport))
    masts, mast_feet = build_masts(grounds, shop, posts_rng)
    line, pole_feet = build_power_line(country, half, shop, posts_rng)
    builder.add(*masts, *line, *build_flags(grounds, shop, posts_rng))
    if country.pylons is not None:
        builder.add(*build_pylons(country.pylons, shop, posts_rng))
    builder.add(*build_fences(grounds, country, shop, posts_rng))
    cars, car_places = build_traffic(grounds, country, half, shop, cars_rng)
    posts = np.concatenate([mast_feet, pole_feet])
    cars_plan = rectangles(
        car_places[:, :2], np.full(len(car_places), 5.2), np.full(len(car_places), 2.4), car_places[:, 2]
    )
    obstacles = np.array([*shapely.points(posts), *cars_plan, *footprints], dtype=object)
    people, people_count = build_crowd(grounds, seats, obstacles, shop, crowd_rng)
    distant, groves, farm_houses = far_objects(country, half, shop, far)
    builder.add(*cars, *people, *distant)
    merged = builder.merge()
    inner = half - _MARGIN_M
    return World(
        map="field",
        mesh=merged.mesh,
        face_surface=merged.face_surface,
        face_semantic=merged.face_semantic,
        face_object=merged.face_object,
        corner_site=merged.corner_site,
        sites=merged.sites,
        palette=palette.surfaces(),
        ground=height_field(relief, half + 60.0, 4.0),
        flight_box_m=((-inner, -inner, 0.0), (inner, inner, knobs.flight_ceiling_m)),
        counts=(
            ("pitches", len(grounds.pitches)),
            ("stands", len(grounds.stands)),
            ("buildings", len(houses) + farm_houses),
            ("cars", len(car_places)),
            ("people", people_count),
            ("groves", groves),
        ),
    )


def _draw_palette(palette: PaletteBuilder) -> None:
    """Draw these first, in a fixed order, so that no part draws more of them."""
    for name, count in _VARIANTS:
        palette.variants(name, count)
