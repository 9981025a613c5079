"""Missions: where flights start, where they want to go, and what wind they meet; the same for every pilot."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from jaxtyping import Bool, Float64, Int32, Int64
from scipy.ndimage import label

from scenegen.foundation.errors import RejectedDrawError
from scenegen.movers.clock import Clock
from scenegen_flythrough.airspace import Airspace
from scenegen_flythrough.loop.contact import Obstacles
from scenegen_flythrough.loop.knobs import MissionKnobs

_TOGETHER = 64
_BATCHES = 400
_CALM_S = 4.0
"""No mover comes near the start for so long."""
_LANE_CELLS = 2
"""Cells free on either side that make a way wide enough to count as one."""


@dataclass(frozen=True, eq=False)
class Missions:
    """A batch of missions in one world.

    Attributes
    ----------
    flight : int64 (n,)
        Ids, increasing.
    start_m, goal_m : float64 (n, 3)
    yaw_rad : float64 (n,)
        Heading at the start: at the goal.
    ceiling_m : float64 (n,)
        Height in the world (z) the flight may not climb above [m].
    obstructed : bool (n,)
        Whether a drone that flew straight at its goal would touch what stands.
    wind : tuple of numpy.random.SeedSequence
        Of each flight's gusts.
    """

    flight: Int64[np.ndarray, "n"]
    start_m: Float64[np.ndarray, "n 3"]
    goal_m: Float64[np.ndarray, "n 3"]
    yaw_rad: Float64[np.ndarray, "n"]
    ceiling_m: Float64[np.ndarray, "n"]
    obstructed: Bool[np.ndarray, "n"]
    wind: tuple[np.random.SeedSequence, ...]


@dataclass(frozen=True)
class _Draw:
    start_m: np.ndarray
    goal_m: np.ndarray
    ceiling_m: float


def draw_missions(
    airspace: Airspace,
    obstacles: Obstacles,
    clock: Clock,
    knobs: MissionKnobs,
    radius_m: float,
    count: int,
    rng: np.random.Generator,
    first_flight: int = 0,
) -> Missions:
    """Draw missions one by one, each from its own generator.

    Start and goal lie in the open under the sky with `knobs.clearance_m` around them, a wide way leads from one to the
    other at the height of the flight or at its ceiling, and no mover comes near the start in the first seconds.

    Parameters
    ----------
    airspace : Airspace
    obstacles : Obstacles
        Of the same world.
    clock : Clock
        World time at which the flights start.
    knobs : MissionKnobs
    radius_m : float
        Of the drone.
    count : int
    rng : numpy.random.Generator
        The batch's own; missions are a pure function of its state.
    first_flight : int
        Id of the first mission; the others follow.

    Raises
    ------
    RejectedDrawError
        The world has no such place.
    """
    share_rng, *rngs = rng.spawn(1 + count)
    hard = int(np.floor(knobs.difficulty * count + share_rng.uniform()))
    obstructed = np.zeros(count, np.bool_)
    obstructed[share_rng.permutation(count)[:hard]] = True
    ways = _Ways(airspace, knobs)
    drawn, wind = [], []
    for want, own in zip(obstructed.tolist(), rngs, strict=True):
        place_rng, wind_rng = own.spawn(2)
        drawn.append(_draw(airspace, obstacles, clock, knobs, radius_m, ways, want, place_rng))
        seed = wind_rng.bit_generator.seed_seq
        assert isinstance(seed, np.random.SeedSequence)
        wind.append(seed)
    start = np.array([d.start_m for d in drawn]).reshape(-1, 3)
    goal = np.array([d.goal_m for d in drawn]).reshape(-1, 3)
    way = goal - start
    return Missions(
        flight=first_flight + np.arange(count),
        start_m=start,
        goal_m=goal,
        yaw_rad=np.arctan2(way[:, 1], way[:, 0]),
        ceiling_m=np.array([d.ceiling_m for d in drawn], np.float64),
        obstructed=obstructed,
        wind=tuple(wind),
    )


class _Ways:
    """Which places are joined by ways wide enough for a drone, at two heights above ground."""

    def __init__(self, airspace: Airspace, knobs: MissionKnobs) -> None:
        self._airspace = airspace
        middle, top = 0.5 * sum(knobs.height_m), knobs.height_m[1] + knobs.climb_m
        self._labels: list[Int32[np.ndarray, "rows columns"]] = []
        for height in (middle, top):
            free = airspace.room(height, 1.0) > _LANE_CELLS
            self._labels.append(label(free)[0])

    def join(
        self, start: Float64[np.ndarray, "n 3"], goal: Float64[np.ndarray, "n 3"]
    ) -> Bool[np.ndarray, "n"]:
        joined = np.zeros(len(start), np.bool_)
        for labels in self._labels:
            a, b = (self._label(labels, place) for place in (start, goal))
            joined |= (a == b) & (a > 0)
        return joined

    def _label(
        self, labels: Int32[np.ndarray, "rows columns"], place: Float64[np.ndarray, "n 3"]
    ) -> Int32[np.ndarray, "n"]:
        """Way each place of the flight box lies on; 0 for none."""
        cell = np.floor((place[:, :2] - self._airspace.low[:2]) / self._airspace.cell_m).astype(np.int64)
        column, row = np.clip(cell, 0, np.array(labels.shape[::-1]) - 1).T
        return np.asarray(labels[row, column])


def _draw(
    airspace: Airspace,
    obstacles: Obstacles,
    clock: Clock,
    knobs: MissionKnobs,
    radius_m: float,
    ways: _Ways,
    obstructed: bool,
    rng: np.random.Generator,
) -> _Draw:
    """The first draw that holds everything."""
    for own in rng.spawn(_BATCHES):
        start, goal = _proposals(airspace, knobs, own)
        good = _inside(airspace, start) & _inside(airspace, goal)
        good[good] = ways.join(start[good], goal[good])
        touches = obstacles.proximity.sweep(start[good], goal[good], radius_m).touches
        good[good] = touches == obstructed
        for k in np.flatnonzero(good):
            ends = np.stack([start[k], goal[k]])
            free = np.isinf(airspace.proximity.distance(ends, knobs.clearance_m)).all()
            if (
                free
                and airspace.open_to_sky(ends, radius_m).all()
                and _calm(obstacles, clock, knobs, ends[:1])
            ):
                ceiling = float(ends[:, 2].max()) + knobs.climb_m
                return _Draw(start[k], goal[k], ceiling)
    raise RejectedDrawError(
        f"no {'obstructed' if obstructed else 'free'} mission of {knobs.distance_m:g} m in this "
        f"{airspace.world.map} world after {_TOGETHER * _BATCHES} draws; "
        f"ask for another difficulty, distance or height than {knobs.difficulty:g}, {knobs.distance_m:g} m, "
        f"{knobs.height_m[0]:g} to {knobs.height_m[1]:g} m"
    )


def _proposals(
    airspace: Airspace, knobs: MissionKnobs, rng: np.random.Generator
) -> tuple[Float64[np.ndarray, "draws 3"], Float64[np.ndarray, "draws 3"]]:
    """Starts and goals anywhere in the plan."""
    low, high = airspace.low[:2], airspace.high[:2]
    plan = low + rng.uniform(0.0, 1.0, (_TOGETHER, 2)) * (high - low)
    turn = rng.uniform(0.0, 2.0 * np.pi, _TOGETHER)
    other = plan + knobs.distance_m * np.stack([np.cos(turn), np.sin(turn)], axis=1)
    height = rng.uniform(*knobs.height_m, (_TOGETHER, 2))
    ground = airspace.world.ground
    start = np.column_stack([plan, ground.at(plan) + height[:, 0]])
    goal = np.column_stack([other, ground.at(other) + height[:, 1]])
    return start, goal


def _inside(airspace: Airspace, place: Float64[np.ndarray, "n 3"]) -> Bool[np.ndarray, "n"]:
    return np.asarray(((place >= airspace.low) & (place <= airspace.high)).all(axis=1))


def _calm(obstacles: Obstacles, clock: Clock, knobs: MissionKnobs, start: Float64[np.ndarray, "1 3"]) -> bool:
    """Whether all movers stay away from the start for a while."""
    for time_s in clock.at(np.arange(0.0, _CALM_S + 0.5, 0.5)).tolist():
        if obstacles.movers_apart(start, time_s)[0] < knobs.clearance_m:
            return False
    return True
