"""What moves through the neighborhood: cars round the blocks and out of town, walkers and joggers on sidewalks."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import shapely
import shapely.ops
from jaxtyping import Float64
from shapely.geometry.polygon import orient

from scenegen.maps.neighborhood.streets import CARRIAGEWAY_M, KERB_M, StreetPlan, road_lines
from scenegen.maps.neighborhood.workshop import NeighborhoodWorkshop
from scenegen.movers.drive import drive
from scenegen.movers.mover import Mover
from scenegen.movers.rounds import there_and_back
from scenegen.movers.stroll import stroll

LANE_M = 1.6
"""Middle of a lane, right of the centre line."""

_DRIVEN = 0.55
"""Share of kerbs along which one drives; cars park along the others."""
_OUT_M, _EXIT_M = 120.0, 14.0
_SHORTEST_M = 60.0
_TURN_M, _FROM_ROAD_M = 3.0, 2.0
_ABREAST_M = 0.42
_JOGGED = 0.2
_MIX = {"car": 0.9, "van": 0.1}


@dataclass(frozen=True, eq=False)
class Rounds:
    """The lines of all movers, drawn before anything else looks for a place.

    Attributes
    ----------
    lanes, walks : tuple of float64 (points, 2)
        Closed lines in the direction of travel [m].
    """

    lanes: tuple[Float64[np.ndarray, "_ 2"], ...]
    walks: tuple[Float64[np.ndarray, "_ 2"], ...]

    def lane_lines(self) -> np.ndarray:
        """Lanes as shapely lines: nothing stands there."""
        return np.array([shapely.linearrings(ring) for ring in self.lanes], dtype=object)

    def walk_lines(self) -> np.ndarray:
        """Walks as shapely lines."""
        return np.array([shapely.linearrings(ring) for ring in self.walks], dtype=object)


def plan_rounds(plan: StreetPlan, rng: np.random.Generator) -> Rounds:
    """Draw the ways of all movers.

    Every kerb is one closed line: around a block, dead ends that cut into it included, or around all of them. Who
    keeps to the kerb at the right stays on one such line and meets nobody who keeps to another; so each kerb either
    has traffic or parked cars.

    Parameters
    ----------
    plan : StreetPlan
    rng : numpy.random.Generator
    """
    order, turns = rng.spawn(2)
    lanes = _lanes(plan)
    chosen = order.permutation(len(lanes))[: max(round(_DRIVEN * len(lanes)), 1)]
    return Rounds(tuple(lanes[k] for k in sorted(chosen.tolist())), tuple(_walks(plan, turns)))


def set_out(
    plan: StreetPlan, rounds: Rounds, shop: NeighborhoodWorkshop, rng: np.random.Generator
) -> tuple[Mover, ...]:
    """Put cars and people on their rounds."""
    rates, cars, pace, walkers, joggers = rng.spawn(5)
    street_m = sum(float(np.linalg.norm(np.diff(line, axis=0), axis=1).sum()) for line in plan.lines)
    lane_m = sum(float(shapely.length(line)) for line in rounds.lane_lines())
    share = rates.uniform(*shop.knobs.moving_cars_per_km) * street_m / 1000.0 / max(lane_m, 1.0)
    movers = drive(rounds.lanes, 100.0 * share, shop, cars, speed_mps=(6.0, 10.5), mix=_MIX)
    people = rates.uniform(*shop.knobs.walkers_per_100_m)
    runs = pace.uniform(size=len(rounds.walks)) < _JOGGED
    slow = [way for way, run in zip(rounds.walks, runs, strict=True) if not run]
    fast = [way for way, run in zip(rounds.walks, runs, strict=True) if run]
    movers += stroll(slow, people, shop, walkers, lift_m=KERB_M)
    return movers + stroll(fast, people, shop, joggers, speed_mps=(2.4, 3.6), lift_m=KERB_M)


def _lanes(plan: StreetPlan) -> list[np.ndarray]:
    """The lane along each kerb, with the kerb on the right; those that leave turn round out of town."""
    far = road_lines(plan.exits)
    roads = [
        shapely.buffer(shapely.ops.substring(line, 0.0, _OUT_M), CARRIAGEWAY_M / 2, cap_style="flat")
        for line in far
    ]
    paved = shapely.union_all([plan.carriageway, *roads], grid_size=0.001)
    inside = paved.buffer(LANE_M - CARRIAGEWAY_M / 2, quad_segs=6)
    whole = max(shapely.get_parts(inside), key=lambda p: float(shapely.area(p)))
    rings = [orient(whole, 1.0).exterior, *orient(whole, 1.0).interiors]
    return [shapely.get_coordinates(ring) for ring in rings if ring.length > _SHORTEST_M]


def _walks(plan: StreetPlan, rng: np.random.Generator) -> list[np.ndarray]:
    """The middle of each sidewalk: around blocks one way or the other, between exits there and back."""
    wide = plan.carriageway.buffer(plan.verge_m + 0.5 * plan.walk_m, quad_segs=4)
    walk = max(shapely.get_parts(wide), key=lambda p: float(shapely.area(p)))
    ways = []
    for hole in walk.interiors:
        turn = 1.0 if rng.uniform() < 0.5 else -1.0
        block = shapely.Polygon(hole).buffer(-_TURN_M).buffer(_TURN_M)
        if block.geom_type == "Polygon" and block.exterior.length > _SHORTEST_M and block.area > 500.0:
            ways.append(shapely.get_coordinates(orient(block, turn).exterior))
    ends = shapely.buffer(shapely.points(plan.exits[:, 0]), _EXIT_M + CARRIAGEWAY_M)
    roads = shapely.buffer(road_lines(plan.exits), CARRIAGEWAY_M / 2 + _FROM_ROAD_M, cap_style="flat")
    rim = shapely.difference(walk.exterior, shapely.union_all([*ends, *roads]))
    if rim.geom_type == "MultiLineString":
        rim = shapely.line_merge(rim)
    for piece in shapely.get_parts(rim):
        if piece.length > _SHORTEST_M:
            ways.append(there_and_back(shapely.get_coordinates(piece.simplify(0.05)), _ABREAST_M))
    return ways
