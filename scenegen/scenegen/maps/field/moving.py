"""What moves: traffic on the country road, players on the pitches, joggers on the track, people on the footpaths."""

from __future__ import annotations

import numpy as np
import shapely
from shapely.ops import substring

from scenegen.maps.field.country import Country
from scenegen.maps.field.grounds import Grounds, Pitch
from scenegen.maps.field.track import LANE_M, RADIUS_M, oval
from scenegen.maps.field.workshop import FieldWorkshop
from scenegen.movers.drive import drive
from scenegen.movers.mover import Mover
from scenegen.movers.play import play
from scenegen.movers.rounds import there_and_back
from scenegen.movers.stroll import stroll

_LANE_RIGHT_M, _ROAD_REACH = 1.55, 1.7
_MIX = {"car": 0.8, "van": 0.1, "bus": 0.03, "truck": 0.07}
_INSIDE_M = 2.5


def build_movers(
    grounds: Grounds, country: Country, half_m: float, shop: FieldWorkshop, rng: np.random.Generator
) -> tuple[Mover, ...]:
    """All movers of a world; each group draws from its own generator.

    Parameters
    ----------
    grounds, country
        The plan.
    half_m : float
        Half the side of the detailed square.
    shop : FieldWorkshop
    rng : numpy.random.Generator
    """
    road_rng, match, training, run, walk = rng.spawn(5)
    movers = list(_traffic(country, half_m, shop, road_rng))
    for pitch in grounds.pitches:
        count = 20 if pitch.main else int(training.integers(0, 15))
        movers += play(_playing_field(pitch), count, shop, match if pitch.main else training)
    if grounds.track:
        lane = grounds.frame.world(oval(RADIUS_M + run.integers(1, 6) * LANE_M + LANE_M / 2))
        movers += stroll([lane], run.uniform(0.2, 1.2), shop, run, speed_mps=(2.4, 4.5))
    ways = [there_and_back(_shortened(path), 0.55) for path in grounds.paths]
    movers += stroll(ways, walk.uniform(0.5, 2.5), shop, walk)
    return tuple(movers)


def _traffic(
    country: Country, half_m: float, shop: FieldWorkshop, rng: np.random.Generator
) -> tuple[Mover, ...]:
    """Both directions of the country road as one long loop that turns beyond the detailed square."""
    rate = rng.uniform(*shop.knobs.road_cars_per_100_m)
    near = np.flatnonzero(np.abs(country.road).max(axis=1) < _ROAD_REACH * half_m)
    lane = there_and_back(country.road[near[0] : near[-1] + 1], _LANE_RIGHT_M)
    return drive([lane], rate, shop, rng, speed_mps=(12.0, 21.0), mix=_MIX)


def _playing_field(pitch: Pitch) -> np.ndarray:
    """Corners inside the lines, away from the goals."""
    a, b = pitch.length_m / 2 - 2.0 * _INSIDE_M, pitch.width_m / 2 - _INSIDE_M
    return pitch.frame.world(np.array([[-a, -b], [a, -b], [a, b], [-a, b]]))


def _shortened(path: np.ndarray) -> np.ndarray:
    """A footpath without its last metres at both ends, where people would turn on the lawn."""
    line = shapely.LineString(path)
    return np.asarray(shapely.get_coordinates(substring(line, 2.0, line.length - 2.0)))
