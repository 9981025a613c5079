"""What moves through the city: vehicles round the blocks and along the ring, people on the sidewalks."""

from __future__ import annotations

import numpy as np
import shapely
from jaxtyping import Float64
from shapely.geometry.polygon import orient

from scenegen.maps.city.streets import KERB_M, Rank, StreetPlan
from scenegen.maps.city.workshop import CityWorkshop
from scenegen.movers.drive import drive
from scenegen.movers.mover import Mover
from scenegen.movers.stroll import stroll

_LANE_M = {Rank.ARTERIAL: 5.3, Rank.COLLECTOR: 1.75, Rank.SIDE: 1.35}
"""Middle of the lane next to the kerb (or to the parked cars), right of the centre line."""
_WIDEST_M = 6.5
_TURN_M = 5.0
"""Radius of the way around a corner."""
_FROM_KERB_M = 1.85
"""Where people walk: between lamps and street trees on one side, facades on the other."""
_SHORTEST_M = 60.0
_SMALL = {"car": 0.9, "van": 0.1}
_LARGE = {"car": 0.78, "van": 0.1, "bus": 0.06, "truck": 0.06}


def plan_motion(plan: StreetPlan, shop: CityWorkshop, rng: np.random.Generator) -> tuple[Mover, ...]:
    """All movers of a city.

    Whoever drives on the right and always turns right around one block never crosses anybody's way: lanes around
    blocks (clockwise) and the outer lane of the ring road (counter-clockwise) keep apart everywhere.

    Parameters
    ----------
    plan : StreetPlan
    shop : CityWorkshop
    rng : numpy.random.Generator
    """
    rates, cars, large, walkers, ways_rng = rng.spawn(5)
    vehicles = rates.uniform(*shop.knobs.moving_cars_per_100_m)
    people = rates.uniform(*shop.knobs.people_per_100_m)
    movers = [*drive(_lanes(plan), vehicles, shop, cars, speed_mps=(7.0, 12.5), mix=_SMALL)]
    movers += drive([_ring(plan)], vehicles, shop, large, speed_mps=(9.0, 14.0), mix=_LARGE)
    return (*movers, *stroll(_sidewalks(plan, ways_rng), people, shop, walkers, lift_m=KERB_M))


def _lanes(plan: StreetPlan) -> list[Float64[np.ndarray, "_ 2"]]:
    """Lane around each block: its surroundings less what lies nearer to a centre line than the lane's middle."""
    inner = shapely.union_all(
        [shapely.LineString(s.line).buffer(_LANE_M[s.rank], quad_segs=4) for s in plan.streets]
    )
    lanes = []
    for block in plan.blocks:
        around = block.buffer(_WIDEST_M, join_style="mitre").difference(inner)
        pieces = [p for p in getattr(around, "geoms", [around]) if p.intersects(block)]
        way = max(pieces, key=lambda p: p.area).buffer(-_TURN_M).buffer(_TURN_M)
        if (
            way.geom_type == "Polygon"
            and way.contains(block.buffer(-1.0))
            and way.exterior.length > _SHORTEST_M
        ):
            lanes.append(shapely.get_coordinates(orient(way, -1.0).exterior))
    return lanes


def _ring(plan: StreetPlan) -> Float64[np.ndarray, "points 2"]:
    """Outer lane of the ring road."""
    ring = plan.streets[0]
    inside = ring.width_m / 2 - _LANE_M[ring.rank]
    way = plan.outline.buffer(-inside, join_style="mitre").buffer(-_TURN_M).buffer(_TURN_M)
    return np.asarray(shapely.get_coordinates(orient(way, 1.0).exterior))


def _sidewalks(plan: StreetPlan, rng: np.random.Generator) -> list[Float64[np.ndarray, "_ 2"]]:
    """Way around each block on its sidewalk, one way or the other."""
    ways = []
    for block, turn in zip(plan.blocks, rng.choice([-1.0, 1.0], len(plan.blocks)), strict=True):
        way = block.buffer(-_FROM_KERB_M, join_style="mitre")
        if way.geom_type == "Polygon" and way.exterior.length > _SHORTEST_M:
            ways.append(shapely.get_coordinates(orient(way, turn).exterior))
    return ways
