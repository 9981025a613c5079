"""The field: sports grounds in rolling farmland, from one generator."""

from __future__ import annotations

import numpy as np
import shapely

from scenegen.buildings.roof_gear import draw_roof_gear
from scenegen.buildings.shells import build_shells
from scenegen.climate.season import Season
from scenegen.geometry.builder import GeometryBuilder
from scenegen.geometry.relief import sample_height_field
from scenegen.maps.field.bales import build_bales
from scenegen.maps.field.country import lay_out_country
from scenegen.maps.field.crowd import build_crowd
from scenegen.maps.field.equipment import build_equipment
from scenegen.maps.field.greenery import build_greenery
from scenegen.maps.field.grounds import lay_out_grounds
from scenegen.maps.field.houses import plan_houses
from scenegen.maps.field.knobs import FieldKnobs
from scenegen.maps.field.moving import build_movers
from scenegen.maps.field.outskirts import far_objects
from scenegen.maps.field.relief import draw_land, level
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
    own, plan, land_rng, hills, skins, homes, ground, walls = rng.spawn(8)
    gear_rng, put_up, cars_rng, sit, far, go, hay, green = rng.spawn(8)
    half = 0.5 * own.uniform(*knobs.extent_m)
    palette, builder = PaletteBuilder(skins), GeometryBuilder()
    for name, count in _VARIANTS:  # in a fixed order, before any part draws more of them
        palette.variants(name, count)
    grounds = lay_out_grounds(knobs, plan)
    country = lay_out_country(grounds, half, knobs, land_rng)
    land = draw_land(own.uniform(*knobs.relief_m), own.uniform(*knobs.hills_m), hills)
    ponds = () if country.pond is None else (country.pond,)
    relief = level(land, (*grounds.platforms, country.farm.yard, *ponds))
    shop = FieldWorkshop(relief, palette, builder, season, knobs, own.uniform(*knobs.dry_share))

    houses = plan_houses(grounds, country, relief, shop, homes)
    gear = draw_roof_gear(houses, gear_rng)
    footprints = [h.footprint for h in houses] + [s.outline() for s in grounds.stands]
    builder.add(build_terrain(grounds, country, footprints, half, shop, ground))
    builder.add(build_shells(houses, gear.plans, walls), *gear.parts)
    equipment = build_equipment(grounds, country, half, shop, put_up)
    cars, car_plans = build_traffic(grounds, country, shop, cars_rng)
    water = [pond.outline() for pond in ponds]
    taken = np.array([*shapely.points(equipment.feet), *car_plans, *footprints, *water], dtype=object)
    people, people_count = build_crowd(grounds, equipment.seats, taken, shop, sit)
    bales, bale_plans = build_bales(
        country, _occupied(taken, grounds.outline, country.corridor), half, shop, hay
    )
    heads = [*shapely.points(equipment.feet), *car_plans, *footprints, *bale_plans]
    plants, tree_count, masses = build_greenery(
        grounds, country, np.array(heads, dtype=object), half, shop, green
    )
    distant, groves, farm_houses = far_objects(country, masses, half, shop, far)
    builder.add(*equipment.parts, *cars, *people, *bales, *plants, *distant)
    movers = build_movers(grounds, country, half, shop, go)
    inner = half - _MARGIN_M
    return builder.merge().world(
        map="field",
        palette=palette.surfaces(),
        ground=sample_height_field(relief, half + 60.0, 4.0),
        flight_box_m=((-inner, -inner, 0.0), (inner, inner, knobs.flight_ceiling_m)),
        counts=(
            ("pitches", len(grounds.pitches)),
            ("stands", len(grounds.stands)),
            ("buildings", len(houses) + farm_houses),
            ("cars", len(car_plans)),
            ("people", people_count),
            ("movers", len(movers)),
            ("hay bales", len(bale_plans)),
            ("trees", tree_count),
            ("groves", groves),
        ),
        movers=movers,
    )


def _occupied(taken: np.ndarray, *areas: shapely.Geometry) -> np.ndarray:
    """What stands somewhere, together with areas that are no use to a farmer."""
    return np.array([*taken, *(a for a in areas if not a.is_empty)], dtype=object)
