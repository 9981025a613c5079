"""The coastline: land and sea, what the sea has left, and what people have built there, from one generator."""

from __future__ import annotations

import numpy as np

from scenegen.climate.sea import sea_surface_K
from scenegen.climate.season import Season
from scenegen.geometry.builder import GeometryBuilder
from scenegen.maps.coastline.claims import Claims
from scenegen.maps.coastline.ground import build_ground
from scenegen.maps.coastline.horizon import build_horizon
from scenegen.maps.coastline.journeys import depart, plan_journeys
from scenegen.maps.coastline.knobs import CoastlineKnobs
from scenegen.maps.coastline.layout import lay_out
from scenegen.maps.coastline.marram import build_marram
from scenegen.maps.coastline.relief import draw_coast_relief, solid_heights
from scenegen.maps.coastline.sea import build_sea, draw_sea
from scenegen.maps.coastline.shape import draw_coast
from scenegen.maps.coastline.things import build_things, hold_layout
from scenegen.maps.coastline.workshop import CoastWorkshop
from scenegen.materials.palette import PaletteBuilder
from scenegen.world import World

_MARGIN_M = 12.0
_ROCKS = ("granite", "basalt", "limestone_marble")


def build_coastline(knobs: CoastlineKnobs, season: Season, rng: np.random.Generator) -> World:
    """Build one coast.

    Parameters
    ----------
    knobs : CoastlineKnobs
    season : Season
        Decides what is in leaf and how warm the sea is.
    rng : numpy.random.Generator
        The only source of randomness; each subsystem gets a child of its own, so that none disturbs another.
    """
    shape, land, lots, water, ground, skins, grass, moving, far, *others = rng.spawn(18)
    coast = draw_coast(knobs, shape)
    palette, builder = PaletteBuilder(skins), GeometryBuilder()
    palette.variants("asphalt_aged", 3)  # the fourth is its paint
    rock = _ROCKS[int(ground.integers(len(_ROCKS)))]
    layout, relief = lay_out(draw_coast_relief(coast, knobs, land), knobs, lots)
    shop = CoastWorkshop(relief, palette, builder, season, knobs, coast, relief.natural, Claims())
    sea = draw_sea(relief, knobs, sea_surface_K(season), water)
    hold_layout(layout, shop)
    plan = plan_journeys(layout, shop, moving)
    things = build_things(layout, rock, sea, shop, others)
    land_part = build_ground(layout, things, rock, sea.temperature_K, shop, ground)
    builder.add(land_part, build_sea(sea, shop), *things.parts)
    builder.add(*build_marram(land_part, shop, grass), *build_horizon(rock, land_part, shop, far))
    movers = depart(plan, layout, sea, shop, moving)
    half = coast.half_m - _MARGIN_M
    return builder.merge().world(
        map="coastline",
        palette=palette.surfaces(),
        ground=solid_heights(relief, coast.half_m + 40.0, 2.0),
        flight_box_m=((-half, -half, 0.0), (half, half, knobs.flight_ceiling_m)),
        counts=(*things.counts, ("movers", len(movers))),
        movers=movers,
    )
