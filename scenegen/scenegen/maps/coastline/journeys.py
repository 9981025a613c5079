"""What moves on the coast: cars on the road, walkers along the beach and on the pier, boats off shore."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import shapely
from jaxtyping import Float64

from scenegen.maps.coastline.layout import Layout
from scenegen.maps.coastline.sea import Sea
from scenegen.maps.coastline.workshop import CoastWorkshop
from scenegen.movers.drive import drive
from scenegen.movers.mover import Mover
from scenegen.movers.rounds import there_and_back
from scenegen.movers.sail import sail
from scenegen.movers.stroll import stroll

_LANE_M, _ABREAST_M, _COURSE_M = 1.75, 0.55, 16.0
_ASTERN_M = 7.0
_CELL_M = 4.0
_USUAL_PEOPLE = 90.0


@dataclass(frozen=True, eq=False)
class Journeys:
    """The lines of all journeys, drawn and claimed before anything else looks for a place.

    Attributes
    ----------
    road : float64 (points, 2)
        Round on both lanes [m].
    walks : tuple of float64 (points, 2)
        Rounds along the water's edge.
    pier : float64 (points, 2)
        Round on the deck.
    courses : tuple of float64 (points, 2)
        Rounds of boats.
    """

    road: Float64[np.ndarray, "points 2"]
    walks: tuple[Float64[np.ndarray, "_ 2"], ...]
    pier: Float64[np.ndarray, "deck 2"]
    courses: tuple[Float64[np.ndarray, "_ 2"], ...]


def plan_journeys(layout: Layout, shop: CoastWorkshop, rng: np.random.Generator) -> Journeys:
    """Draw the lines and claim the beach and the water they need."""
    coast = shop.coast
    line = shapely.get_coordinates(layout.road)
    near = line[np.abs(line).max(axis=1) < coast.half_m + 120.0]
    walks = [w for w in _along_the_edge(layout, shop) if shop.claims.take(np.array([w.buffer(1.6)]), 0.2)[0]]
    courses = _off_shore(layout, shop, rng)
    return Journeys(
        road=there_and_back(near, _LANE_M),
        walks=tuple(there_and_back(shapely.get_coordinates(w), _ABREAST_M) for w in walks),
        pier=_deck_round(layout),
        courses=tuple(courses),
    )


def depart(
    plan: Journeys, layout: Layout, sea: Sea, shop: CoastWorkshop, rng: np.random.Generator
) -> tuple[Mover, ...]:
    """Put people, cars and boats on their rounds."""
    road_rng, beach_rng, pier_rng, boat_rng = rng.spawn(4)

    def deck(xy: np.ndarray) -> np.ndarray:
        return np.full(len(xy), layout.pier_deck_m)

    def water(xy: np.ndarray) -> np.ndarray:
        return sea.height(xy, np.full(len(xy), _CELL_M))

    traffic = road_rng.uniform(*shop.knobs.traffic_per_100_m)
    movers = list(drive([plan.road], traffic, shop, road_rng, speed_mps=(9.0, 15.0)))
    crowd = shop.knobs.people[1] / _USUAL_PEOPLE
    for way in plan.walks:
        movers += stroll([way], crowd * beach_rng.uniform(0.5, 2.5), shop, beach_rng)
    movers += stroll([plan.pier], crowd * pier_rng.uniform(0.5, 2.0), shop, pier_rng, ground=deck)
    busy = boat_rng.uniform(*shop.knobs.sailing_per_km)
    for course in plan.courses:
        movers += sail([course], busy, shop, boat_rng, water=water, wave_height_m=sea.waves.significant_m)
    return tuple(movers)


def _along_the_edge(layout: Layout, shop: CoastWorkshop) -> list[shapely.LineString]:
    """Stretches of wet sand between pier, breakwater and cliffs, at least forty metres long."""
    coast = shop.coast
    s = np.arange(-1.35 * coast.half_m, 1.35 * coast.half_m, 3.0)
    xy = coast.plan(s, 0.55 * coast.wet(s))
    blocked = shapely.union_all([shapely.LineString(layout.pier).buffer(6.0), layout.mound.line.buffer(12.0)])
    open_sand = coast.inside(xy, 6.0) & (coast.cliff(s) < 0.04) & ~shapely.contains_xy(blocked, xy)
    cuts = np.flatnonzero(np.diff(np.concatenate([[False], open_sand, [False]]).astype(int))).reshape(-1, 2)
    return [shapely.LineString(xy[i:j]) for i, j in cuts if j - i > 14]


def _deck_round(layout: Layout) -> np.ndarray:
    """Up the middle of the pier and back, clear of lamps and benches."""
    start, end = layout.pier
    ahead = (end - start) / np.linalg.norm(end - start)
    return there_and_back(np.array([start + 4.0 * ahead, end - 4.0 * ahead]), 0.42)


def _off_shore(layout: Layout, shop: CoastWorkshop, rng: np.random.Generator) -> list[np.ndarray]:
    """Rounds parallel to the shore, beyond pier and breakwater."""
    coast = shop.coast
    built = np.concatenate([layout.pier, shapely.get_coordinates(layout.mound.line)])
    out = float(coast.offset(built)[:, 1].min()) - _COURSE_M - 12.0
    found = []
    for distance in (out - rng.uniform(0.0, 20.0), out - rng.uniform(60.0, 110.0)):
        s = np.arange(-1.2 * coast.half_m, 1.2 * coast.half_m, 12.0)
        shore = coast.shore(s)
        t = np.convolve(np.pad(shore, 12, mode="edge"), np.ones(25) / 25, mode="valid") + distance
        xy = coast.frame.world(np.column_stack([s, t]))
        xy = xy[coast.inside(xy, 24.0 + _COURSE_M) & (shop.relief(xy) < -2.5)]
        if len(xy) < 10 or np.linalg.norm(np.diff(xy, axis=0), axis=1).max() > 60.0:
            continue
        line = shapely.LineString(xy)
        if shop.claims.take(np.array([line.buffer(_COURSE_M + _ASTERN_M)]), 3.0)[0]:
            found.append(there_and_back(xy, _COURSE_M))
    return found
