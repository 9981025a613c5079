"""All that stands on a coast, in the order in which it claims its ground."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
import shapely

from scenegen.buildings.roof_gear import draw_roof_gear
from scenegen.buildings.shells import build_shells
from scenegen.geometry.ground import Region
from scenegen.geometry.part import Part
from scenegen.geometry.placement import rectangles
from scenegen.maps.coastline.boats import build_boats
from scenegen.maps.coastline.cars import build_cars
from scenegen.maps.coastline.folk import build_folk
from scenegen.maps.coastline.gardens import build_gardens
from scenegen.maps.coastline.greenery import build_greenery
from scenegen.maps.coastline.houses import draw_houses
from scenegen.maps.coastline.huts import build_huts, draw_huts, standing_height
from scenegen.maps.coastline.layout import LIGHTHOUSE_YARD_M, Layout
from scenegen.maps.coastline.lighthouse import build_lighthouse
from scenegen.maps.coastline.pier import HEAD_M, WIDTH_M, build_pier
from scenegen.maps.coastline.relief import ROAD_HALF_M
from scenegen.maps.coastline.roadside import build_roadside
from scenegen.maps.coastline.rocks import build_armour, build_rocks
from scenegen.maps.coastline.sea import Sea
from scenegen.maps.coastline.workshop import CoastWorkshop


@dataclass(frozen=True, eq=False)
class Things:
    """Parts, the holes they leave in the ground, the stones that hide it, gardens, and what was built."""

    parts: tuple[Part, ...]
    holes: tuple[shapely.Polygon, ...]
    stones: np.ndarray
    lawns: tuple[Region, ...]
    counts: tuple[tuple[str, int], ...]


def hold_layout(layout: Layout, shop: CoastWorkshop) -> None:
    """Claim the ground of what has been laid out."""
    mound = layout.mound
    shop.claims.hold(
        layout.road.buffer(ROAD_HALF_M),
        layout.drive.buffer(1.7),
        layout.path.buffer(1.1),
        layout.car_park.buffer(0.5),
        mound.line.buffer(mound.half_m + (mound.crown_m + 2.0) / mound.slope),
        shapely.LineString(layout.pier).buffer(WIDTH_M / 2 + 0.6, cap_style="flat"),
        shapely.Point(layout.pier[1]).buffer(HEAD_M[0]),
        shapely.Point(layout.lighthouse[:2]).buffer(LIGHTHOUSE_YARD_M + 0.5),
    )


def build_things(
    layout: Layout, rock: str, sea: Sea, shop: CoastWorkshop, rngs: Sequence[np.random.Generator]
) -> Things:
    """Build everything but ground and sea.

    Parameters
    ----------
    layout : Layout
    rock : str
        Material of this coast's rock.
    sea : Sea
        On which boats float.
    shop : CoastWorkshop
    rngs : sequence of numpy.random.Generator
        One for each subsystem.
    """
    house_rng, shell_rng, hut_rng, tower_rng, pier_rng, wall_rng, rock_rng, road_rng, life_rng = rngs
    car_rng, boat_rng, folk_rng, green_rng = life_rng.spawn(4)
    houses = draw_houses(layout, shop, house_rng)
    lawns, fences = build_gardens(houses, layout, shop, house_rng)
    rows = draw_huts(shop, hut_rng)
    parts = [build_lighthouse(layout, shop, tower_rng), *build_pier(layout, shop, pier_rng)]
    parts += build_armour(layout, rock, shop.builder.new_objects(), shop, wall_rng)
    if houses:
        gear = draw_roof_gear(houses, shell_rng)
        parts += [build_shells(houses, gear.plans, shell_rng), *gear.parts]
    parts += build_huts(rows, standing_height(rows, shop), shop, hut_rng)
    roadside, counts = build_roadside(layout, shop, road_rng)
    cars, car_count = build_cars(layout, houses, shop, car_rng)
    rocks, stones = build_rocks(rock, shop, rock_rng)
    boats, boat_count = build_boats(layout, sea, shop, boat_rng)
    folk, folk_count = build_folk(layout, rows, shop, folk_rng)
    green, grown = build_greenery(shop, green_rng)
    parts += [*green, *fences, *roadside, *cars, *rocks, *boats, *folk]
    size = np.full(len(rows), 2.6), np.full(len(rows), 2.2)
    huts = shapely.buffer(rectangles(rows[:, :2], *size, rows[:, 2]), -0.05, join_style="mitre")
    holes = (*(b.footprint.buffer(-0.01, join_style="mitre") for b in houses), *huts)
    total = {"houses": len(houses), "huts": len(rows), "rocks": len(stones)} | counts
    total |= {"cars": car_count, "boats": boat_count, "people": folk_count} | grown
    return Things(tuple(parts), holes, stones, tuple(lawns), tuple(total.items()))
