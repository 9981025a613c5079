"""Whether a motion may be flown here: inside the box, clear of everything that stands or moves, open to the sky."""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np
from jaxtyping import Bool, Float64

from scenegen.movers.clock import Clock
from scenegen_flythrough.airspace import Airspace
from scenegen_flythrough.knobs import FlightKnobs
from scenegen_flythrough.quadrotor.motion import Motion
from scenegen_flythrough.traffic import keeps_clear

_CHORD_M, _CHORD_S = 0.25, 0.05  # the proof's chords are at most this long
_VIEW_M = 40.0  # how much of the world must still lie ahead of every pose
_SKY_LOOKS = 9

REASONS = {
    "hopeless": "the coarse map had nothing to offer for",
    "limits": "asked for more than the drone's limits",
    "outside": "left the flight box or the height range",
    "blocked": "came closer than clearance_m",
    "enclosed": "had no open sky",
    "met": "would have met something that moves",
}
"""Why draws are rejected."""


@dataclass(frozen=True, eq=False)
class Span:
    """The part of a motion that a clip shows, cut into chords.

    Attributes
    ----------
    time_s : float64 (points,)
        Motion time.
    place : float64 (points, 3)
        [m].
    sag_m : float
        How far the motion leaves its chords at most: ``a t^2 / 8`` for chords of duration `t`.
    """

    time_s: Float64[np.ndarray, "points"]
    place: Float64[np.ndarray, "points 3"]
    sag_m: float

    @staticmethod
    def of(motion: Motion, start_s: float, end_s: float) -> Span:
        """Cut a motion finely enough that its chords stand for it."""
        step = min(_CHORD_S, _CHORD_M / max(motion.position.bound(1), 1e-6))
        time_s = np.linspace(start_s, end_s, math.ceil((end_s - start_s) / step) + 1)
        sag_m = motion.position.bound(2) * float(time_s[1] - time_s[0]) ** 2 / 8.0
        return Span(time_s, motion.position.at(time_s), sag_m)


def objection(
    airspace: Airspace,
    knobs: FlightKnobs,
    span: Span,
    zero_s: float,
    clock: Clock,
    *,
    free_height: bool = False,
) -> str | None:
    """Why this part of a motion may not be flown: a key of `REASONS`, or None.

    Parameters
    ----------
    airspace : Airspace
    knobs : FlightKnobs
    span : Span
    zero_s : float
        Motion time of clip time zero.
    clock : Clock
        World time of the clip.
    free_height : bool
        Any height in the flight box will do.
    """
    if not in_range(airspace, knobs, span.place[None], free_height=free_height)[0]:
        return "outside"
    away_m = knobs.clearance_m + span.sag_m
    if airspace.proximity.sweep(span.place[:-1], span.place[1:], away_m).touches.any():
        return "blocked"
    looks = span.place[np.linspace(0, len(span.place) - 1, _SKY_LOOKS).astype(np.int64)]
    if not airspace.open_to_sky(looks, knobs.clearance_m).any():
        return "enclosed"
    time_s = span.time_s - zero_s
    if not keeps_clear(airspace.world.movers, clock, span.place, time_s, away_m, airspace.reaches):
        return "met"
    return None


def in_range(
    airspace: Airspace,
    knobs: FlightKnobs,
    paths: Float64[np.ndarray, "paths points 3"],
    *,
    free_height: bool = False,
) -> Bool[np.ndarray, "paths"]:
    """Which paths stay in the flight box and in the height range."""
    good = ((paths >= airspace.low) & (paths <= airspace.high)).all(axis=(1, 2))
    if not free_height:
        ground = airspace.world.ground.at(paths[:, :, :2].reshape(-1, 2)).reshape(paths.shape[:2])
        low, high = knobs.height_m[0] - knobs.height_slack_m, knobs.height_m[1] + knobs.height_slack_m
        height = paths[:, :, 2] - ground
        good &= ((height >= low) & (height <= high)).all(axis=1)
    return np.asarray(good)


def sees_world(airspace: Airspace, poses: Float64[np.ndarray, "poses 4 4"]) -> bool:
    """Whether there is still world some way ahead of the camera at every pose."""
    ground = airspace.world.ground
    rows, columns = ground.height_m.shape
    low = np.asarray(ground.origin_m)
    high = low + np.array([columns - 1, rows - 1]) * ground.cell_m
    ahead = poses[:, :2, 2] / np.maximum(np.linalg.norm(poses[:, :2, 2], axis=1, keepdims=True), 1e-9)
    view_m = min(_VIEW_M, 0.15 * float((airspace.high - airspace.low)[:2].min()))
    seen = poses[:, :2, 3] + view_m * ahead
    return bool(((seen >= low) & (seen <= high)).all())
