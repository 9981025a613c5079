"""Buildings of a field world: clubhouse, store, barn and farmhouse, planned with the shared building kit."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import shapely

from scenegen.buildings.building import Building, Volume
from scenegen.buildings.styles import Kind, Roof, draw_style
from scenegen.geometry.relief import Relief
from scenegen.maps.field.country import Country
from scenegen.maps.field.frame import Plot
from scenegen.maps.field.grounds import Grounds
from scenegen.maps.field.workshop import FieldWorkshop

_STEP_M, _BELOW_M = 0.16, 0.7


def plan_houses(
    grounds: Grounds, country: Country, relief: Relief, shop: FieldWorkshop, rng: np.random.Generator
) -> list[Building]:
    """All buildings of the detailed square, heated behind their windows as the palette's glass and walls are."""
    flat_club = rng.uniform() < 0.5
    club = Roof.FLAT if flat_club else Roof.HIP if rng.uniform() < 0.4 else Roof.GABLE
    storeys = 2 if flat_club and rng.uniform() < 0.5 else 1
    wishes = (
        (grounds.clubhouse, Kind.APARTMENTS if flat_club else Kind.HOUSE, club, storeys),
        (grounds.store, Kind.HOUSE, Roof.FLAT, 1),
        (country.farm.barn, Kind.SHED, Roof.GABLE, 1),
        (country.farm.house, Kind.HOUSE, Roof.GABLE, 2),
    )
    return [_building(plot, kind, form, storeys, relief, shop, rng) for plot, kind, form, storeys in wishes]


def _building(
    plot: Plot,
    kind: Kind,
    form: Roof,
    storeys: int,
    relief: Relief,
    shop: FieldWorkshop,
    rng: np.random.Generator,
) -> Building:
    """One volume on a plot, its floor a step above the highest ground at its walls."""
    style = replace(draw_style(kind, form, shop.palette, rng), balconies=False)
    outline = shapely.orient_polygons(plot.outline())
    ring = shapely.get_coordinates(outline.exterior)[:-1]
    ground = relief(shapely.get_coordinates(shapely.segmentize(outline.exterior, 3.0)))
    floor = float(ground.max()) + _STEP_M
    volume = Volume((ring,), floor, storeys, floor - float(ground.min()) + _BELOW_M, form)
    return Building(kind, shop.builder.new_objects(), style, (volume,), outline)
