"""Candidate paths: a drone that wanders, looks ahead on the coarse map, and turns towards the free side.

All candidates of a batch are drawn together, one step at a time. The path is a chain of chords of exactly that length;
curvature and climb change continuously, so it is smooth in the second derivative.
"""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np
from jaxtyping import Float64, UInt8

from scenegen_flythrough.airspace import ROOM_CELLS, Airspace
from scenegen_flythrough.knobs import FlightKnobs
from scenegen_flythrough.quadrotor.limits import GRAVITY_MPS2

_OFFSETS_RAD = np.radians([-60.0, -40.0, -24.0, -12.0, 0.0, 12.0, 24.0, 40.0, 60.0])
_BEND_SPEED = 0.75
"""Share of the cruise speed that tight bends are meant to be flown at."""
_LOOK_SHARES = np.array([0.12, 0.25, 0.4, 0.55, 0.75, 1.0])


@dataclass(frozen=True)
class Intent:
    """What one flight wants: drawn before any path is tried, so that easy heights are not favoured.

    Attributes
    ----------
    speed_mps : float
    height_m : float
        Cruise height above ground [m].
    mount_pitch_deg : float
        Camera against airframe [deg].
    """

    speed_mps: float
    height_m: float
    mount_pitch_deg: float


@dataclass(frozen=True)
class Agility:
    """How tightly a path may bend at its speed.

    Attributes
    ----------
    curvature : float
        Largest horizontal curvature [1/m].
    onset : float
        Largest change of curvature per metre [1/m^2].
    climb : float
        Largest slope angle [rad].
    step : float
        Length of a chord [m].
    """

    curvature: float
    onset: float
    climb: float
    step: float

    @classmethod
    def of(cls, knobs: FlightKnobs, cruise_mps: float, step_m: float) -> Agility:
        """Curvature from turn radius and bank (v^2 k = g tan(bank)) at the speed of bends; ramps of 0.7 s or 4 m."""
        speed = _BEND_SPEED * cruise_mps
        banked = GRAVITY_MPS2 * math.tan(math.radians(0.9 * knobs.bank_deg)) / speed**2
        curvature = min(1.0 / knobs.turn_radius_m, banked, 0.35 / step_m)
        ramp = max(0.7 * speed, 4.0, 2.0 * step_m)
        return cls(curvature, curvature / ramp, math.radians(knobs.climb_deg), step_m)


def free_starts(
    airspace: Airspace,
    room: UInt8[np.ndarray, "rows columns"],
    knobs: FlightKnobs,
    count: int,
    rng: np.random.Generator,
) -> Float64[np.ndarray, "starts 2"]:
    """Free places of the coarse map, all equally likely; none where it has none at this height."""
    free = np.flatnonzero(room.ravel() > _needed(airspace, knobs))
    if len(free) == 0:
        return np.zeros((0, 2))
    return airspace.centre(free[rng.integers(len(free), size=count)])


def wander(
    airspace: Airspace,
    room: UInt8[np.ndarray, "rows columns"],
    knobs: FlightKnobs,
    intent: Intent,
    start: tuple[Float64[np.ndarray, "batch 2"], Float64[np.ndarray, "batch"]] | None,
    shape: tuple[int, int, float],
    rng: np.random.Generator,
) -> Float64[np.ndarray, "paths points 3"]:
    """Draw paths that wander through the free air.

    Parameters
    ----------
    airspace : Airspace
    room : uint8 (rows, columns)
        `Airspace.room` at the cruise height.
    knobs : FlightKnobs
    intent : Intent
    start : (float64 (batch, 2), float64 (batch,)) or None
        Places and headings to begin with; None: any free place, with a far view ahead.
    shape : (int, int, float)
        Paths, points of each, and metres between two.
    rng : numpy.random.Generator

    Returns
    -------
    float64 (paths, points, 3)
        Empty where the map has no free place at this height.
    """
    batch, points, step_m = shape
    starts_rng, heading_rng, wander_rng, sway_rng = rng.spawn(4)
    if start is None:
        xy = free_starts(airspace, room, knobs, batch, starts_rng)
        heading = _open_heading(airspace, room, xy, heading_rng)
    else:
        xy, heading = start
    batch = len(xy)
    if batch == 0:
        return np.zeros((0, points, 3))
    agility = Agility.of(knobs, intent.speed_mps, step_m)
    # Far enough to see a turn coming at this curvature, not so far that every street ends in a wall.
    reach = min(max(4.0 / agility.curvature, 1.5 * intent.speed_mps, 20.0), 60.0) * _LOOK_SHARES
    along = np.arange(points) * step_m
    lean = _wander(wander_rng, batch, along, agility.curvature)
    target = intent.height_m + _sway(sway_rng, batch, along, knobs, intent.height_m)
    return _integrate(airspace, room, agility, reach, xy, heading, lean, target)


def _integrate(
    airspace: Airspace,
    room: UInt8[np.ndarray, "rows columns"],
    agility: Agility,
    reach: Float64[np.ndarray, "looks"],
    xy: Float64[np.ndarray, "batch 2"],
    heading: Float64[np.ndarray, "batch"],
    lean: Float64[np.ndarray, "batch poses"],
    target: Float64[np.ndarray, "batch poses"],
) -> Float64[np.ndarray, "batch poses 3"]:
    step, ground = agility.step, airspace.world.ground
    batch, poses = lean.shape
    path = np.empty((batch, poses, 3))
    path[:, 0, :2], path[:, 0, 2] = xy, ground.at(xy) + target[:, 0]
    curvature, slope, slope_rate = (np.zeros(batch) for _ in range(3))
    bend = 0.5 * agility.onset  # the slope's curvature changes half as fast as the heading's
    ahead_m = max(2.0 * step, 6.0)
    for k in range(poses - 1):
        here = path[:, k]
        turn = _best_turn(airspace, room, here[:, :2], heading, reach, lean[:, k] / agility.curvature)
        wanted = np.clip(2.0 * turn / (0.4 * reach[-1]) + lean[:, k], -agility.curvature, agility.curvature)
        curvature = curvature + np.clip(wanted - curvature, -agility.onset * step, agility.onset * step)
        flat = np.stack([np.cos(heading), np.sin(heading)], axis=1)
        error = ground.at(here[:, :2] + ahead_m * flat) + target[:, k] - here[:, 2]
        wanted_slope = np.clip(error / (2.5 * ahead_m), -agility.climb, agility.climb)
        wanted_rate = np.clip(
            (wanted_slope - slope) / (0.8 * ahead_m),
            -_braking(agility.climb + slope, 0.8 * bend, step),
            _braking(agility.climb - slope, 0.8 * bend, step),
        )
        wanted_rate = np.clip(wanted_rate, -agility.curvature, agility.curvature)
        slope_rate = slope_rate + np.clip(wanted_rate - slope_rate, -bend * step, bend * step)
        slope = slope + slope_rate * step
        middle = heading + 0.5 * curvature * step
        heading = heading + curvature * step
        chord = np.stack(
            [np.cos(slope) * np.cos(middle), np.cos(slope) * np.sin(middle), np.sin(slope)], axis=1
        )
        path[:, k + 1] = here + step * chord
    return path


def _braking(left: Float64[np.ndarray, "batch"], bend: float, step: float) -> Float64[np.ndarray, "batch"]:
    """Largest rate that can still be ramped down to zero, a step at a time, before `left` is used up."""
    return np.asarray(bend * (np.sqrt(0.25 * step**2 + 2.0 * np.maximum(left, 0.0) / bend) - 0.5 * step))


def _best_turn(
    airspace: Airspace,
    room: UInt8[np.ndarray, "rows columns"],
    xy: Float64[np.ndarray, "batch 2"],
    heading: Float64[np.ndarray, "batch"],
    reach: Float64[np.ndarray, "looks"],
    lean: Float64[np.ndarray, "batch"],
) -> Float64[np.ndarray, "batch"]:
    """Heading change [rad] towards the freest of the fan's directions; none where straight on is as good.

    `lean` in -1..1 is where the wandering wants to go: it decides between equals.
    """
    angle = heading[:, None] + _OFFSETS_RAD
    fan = np.stack([np.cos(angle), np.sin(angle)], axis=-1)
    seen = airspace.look_up(room, xy[:, None, None, :] + fan[:, :, None, :] * reach[None, None, :, None])
    seen = np.minimum.accumulate(seen, axis=2)  # behind an obstacle nothing counts
    value = seen.sum(axis=2) / (ROOM_CELLS * len(reach))
    value = value - 0.15 * np.abs(_OFFSETS_RAD) + 0.05 * lean[:, None] * np.sign(_OFFSETS_RAD)
    return np.asarray(_OFFSETS_RAD[np.argmax(value, axis=1)])


def _open_heading(
    airspace: Airspace,
    room: UInt8[np.ndarray, "rows columns"],
    xy: Float64[np.ndarray, "batch 2"],
    rng: np.random.Generator,
) -> Float64[np.ndarray, "batch"]:
    """A heading for each start: far views are likelier, so that streets are flown along and not across."""
    angle = np.arange(24) * (2 * np.pi / 24)
    reach = np.array([3.0, 6.0, 10.0, 15.0, 22.0, 30.0, 40.0, 55.0, 75.0])
    fan = np.stack([np.cos(angle), np.sin(angle)], axis=-1)
    seen = airspace.look_up(room, xy[:, None, None, :] + (fan[:, None, :] * reach[:, None])[None]) > 0
    weight = np.logical_and.accumulate(seen, axis=2).sum(axis=2) ** 3.0 + 1e-9
    cumulative = np.cumsum(weight, axis=1) / weight.sum(axis=1, keepdims=True)
    pick = np.minimum((cumulative < rng.random((len(xy), 1))).sum(axis=1), len(angle) - 1)
    return np.asarray(angle[pick] + rng.uniform(-0.5, 0.5, len(xy)) * (2 * np.pi / 24))


def _wander(
    rng: np.random.Generator, batch: int, along: Float64[np.ndarray, "points"], curvature: float
) -> Float64[np.ndarray, "batch points"]:
    """Random curvature [1/m]: two slow sines per path, some paths nearly straight, some always turning."""
    period = rng.uniform(30.0, 120.0, (batch, 2, 1))
    phase = rng.uniform(0.0, 2 * np.pi, (batch, 2, 1))
    strength = 0.35 * curvature * rng.random((batch, 2, 1)) ** 2
    return np.asarray((strength * np.sin(2 * np.pi * along / period + phase)).sum(axis=1))


def _sway(
    rng: np.random.Generator,
    batch: int,
    along: Float64[np.ndarray, "points"],
    knobs: FlightKnobs,
    height_m: float,
) -> Float64[np.ndarray, "batch points"]:
    """Slow change of the wanted height [m], up to a fifth of it, kept inside the knob's range."""
    amplitude = 0.2 * height_m * rng.random((batch, 1)) ** 2
    wave = np.sin(
        2 * np.pi * along / rng.uniform(60.0, 200.0, (batch, 1)) + rng.uniform(0, 2 * np.pi, (batch, 1))
    )
    return np.asarray(np.clip(height_m + amplitude * wave, *knobs.height_m) - height_m)


def _needed(airspace: Airspace, knobs: FlightKnobs) -> int:
    """Cells of room a start needs."""
    return min(math.ceil(knobs.clearance_m / airspace.cell_m), ROOM_CELLS - 1)
