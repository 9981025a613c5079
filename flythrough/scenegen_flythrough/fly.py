"""One flight through a world: drawn, steered on the coarse map, then proven against the exact mesh."""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np
from jaxtyping import Bool, Float64

from scenegen.foundation.errors import InputError, RejectedDrawError
from scenegen.movers.clock import Clock
from scenegen.world import World
from scenegen_flythrough.airspace import Airspace
from scenegen_flythrough.attitude import camera_poses
from scenegen_flythrough.knobs import FlightKnobs
from scenegen_flythrough.steering import Intent, fly_batch
from scenegen_flythrough.traffic import keeps_clear
from scenegen_flythrough.trajectory import Trajectory

_BATCH = 32  # paths tried together
_PROVEN_TOGETHER = 4
_BATCHES_PER_INTENT = 4
_VIEW_M = 40.0  # how much of the world must still lie ahead of every pose

_FROM_ZERO = Clock()


@dataclass
class _Rejections:
    """Why paths were turned down, for the message of a flight that is given up."""

    outside: int = 0
    blocked: int = 0
    enclosed: int = 0
    met: int = 0


def fly(
    world: World,
    knobs: FlightKnobs,
    frames: int,
    rng: np.random.Generator,
    airspace: Airspace,
    clock: Clock = _FROM_ZERO,
) -> Trajectory:
    """Draw a smooth collision-free flight.

    Speed, height and camera angle are drawn first; up to 128 paths are tried with them before they are drawn anew, so
    that low flights between houses are as likely as the easy ones above the roofs.

    Parameters
    ----------
    world : World
    knobs : FlightKnobs
    frames : int
        Frames to be stored; the trajectory has one pose more at both ends.
    rng : numpy.random.Generator
        This flight's own generator.
    airspace : Airspace
        Of the same world.
    clock : Clock
        World time of the clip: where the movers are meanwhile.

    Returns
    -------
    Trajectory
        Its capsules of radius `knobs.clearance_m` between successive poses touch nothing, no mover's box comes closer
        either, and at least one pose is connected to the open sky, so that no pose lies inside anything.

    Raises
    ------
    RejectedDrawError
        `knobs.max_draws` paths were rejected.
    """
    if frames < 1:
        raise InputError(f"a clip needs at least one frame, not {frames}; raise the number of frames")
    if airspace.world is not world:
        raise AssertionError("the airspace belongs to another world")
    rejected, why = 0, _Rejections()
    while rejected < knobs.max_draws:
        intent_rng, *batch_rngs = rng.spawn(1 + _BATCHES_PER_INTENT)
        intent = _draw_intent(knobs, intent_rng)
        room = airspace.room(intent.height_m, max(knobs.clearance_m, 0.1 * intent.height_m) + 1.0)
        for batch_rng in batch_rngs[: math.ceil((knobs.max_draws - rejected) / _BATCH)]:
            left = min(_BATCH, knobs.max_draws - rejected)
            paths = fly_batch(airspace, room, knobs, intent, (_BATCH, frames + 2), batch_rng)[:left]
            index = _first_proven(airspace, knobs, intent, paths, clock, why)
            if index is not None:
                return _trajectory(airspace, knobs, intent, paths[index], rejected + index)
            rejected += left
            why.blocked += left - len(paths)  # no free place to start from at this height
    raise RejectedDrawError(_given_up(world, knobs, frames, why))


def _draw_intent(knobs: FlightKnobs, rng: np.random.Generator) -> Intent:
    speed, height, pitch = (child.uniform() for child in rng.spawn(3))
    return Intent(
        speed_mps=_between(knobs.speed_mps, speed),
        height_m=_between(knobs.height_m, height),
        mount_pitch_deg=_between(knobs.pitch_deg, pitch),
    )


def _between(span: tuple[float, float], share: float) -> float:
    return span[0] + share * (span[1] - span[0])


def _first_proven(
    airspace: Airspace,
    knobs: FlightKnobs,
    intent: Intent,
    paths: Float64[np.ndarray, "batch poses 3"],
    clock: Clock,
    why: _Rejections,
) -> int | None:
    """Index of the first path that holds everything, as if they had been tried one after the other."""
    inside = _inside(airspace, knobs, paths)
    why.outside += int((~inside).sum())
    candidates = np.flatnonzero(inside)
    for first in range(0, len(candidates), _PROVEN_TOGETHER):
        group = candidates[first : first + _PROVEN_TOGETHER]
        free = _free(airspace, knobs, paths[group])
        why.blocked += int((~free).sum())
        for index in group[free].tolist():
            if not airspace.open_to_sky(paths[index, ::8], knobs.clearance_m).any():
                why.enclosed += 1
            elif not keeps_clear(
                airspace.world.movers,
                clock,
                paths[index],
                _times(paths.shape[1], knobs, intent),
                knobs.clearance_m,
            ):
                why.met += 1
            else:
                return int(index)
    return None


def _inside(
    airspace: Airspace, knobs: FlightKnobs, paths: Float64[np.ndarray, "batch poses 3"]
) -> Bool[np.ndarray, "batch"]:
    """Which paths stay in the flight box and in the height range, and still have world ahead to look at."""
    ground = airspace.world.ground
    height = paths[:, :, 2] - ground.at(paths[:, :, :2].reshape(-1, 2)).reshape(paths.shape[:2])
    low, high = knobs.height_m[0] - knobs.height_slack_m, knobs.height_m[1] + knobs.height_slack_m
    good = ((height >= low) & (height <= high)).all(axis=1)
    good &= ((paths >= airspace.low) & (paths <= airspace.high)).all(axis=(1, 2))
    ahead = paths[:, 1:] - paths[:, :-1]
    view_m = min(_VIEW_M, 0.15 * float((airspace.high - airspace.low)[:2].min()))
    seen = paths[:, 1:, :2] + ahead[:, :, :2] * (view_m / knobs.spacing_m)
    rows, columns = ground.height_m.shape
    low_corner = np.asarray(ground.origin_m)
    high_corner = low_corner + np.array([columns - 1, rows - 1]) * ground.cell_m
    good &= ((seen >= low_corner) & (seen <= high_corner)).all(axis=(1, 2))
    return np.asarray(good)


def _free(
    airspace: Airspace, knobs: FlightKnobs, paths: Float64[np.ndarray, "group poses 3"]
) -> Bool[np.ndarray, "group"]:
    """Which paths keep their clearance to the exact mesh, whole capsules from pose to pose."""
    starts, ends = paths[:, :-1].reshape(-1, 3), paths[:, 1:].reshape(-1, 3)
    touches = airspace.proximity.sweep(starts, ends, knobs.clearance_m).touches
    return np.asarray(~touches.reshape(len(paths), -1).any(axis=1))


def _times(poses: int, knobs: FlightKnobs, intent: Intent) -> Float64[np.ndarray, "poses"]:
    """Clip time of each pose, zero at the second."""
    return (np.arange(poses) - 1.0) * (knobs.spacing_m / intent.speed_mps)


def _trajectory(
    airspace: Airspace,
    knobs: FlightKnobs,
    intent: Intent,
    path: Float64[np.ndarray, "poses 3"],
    rejected: int,
) -> Trajectory:
    closest = airspace.proximity.sweep(path[:-1], path[1:]).distance_m
    return Trajectory(
        world_from_camera=camera_poses(path, intent.speed_mps, knobs.bank_deg, intent.mount_pitch_deg),
        time_s=_times(len(path), knobs, intent),
        speed_mps=intent.speed_mps,
        clearance_m=float(closest.min()),
        rejected=rejected,
    )


def _given_up(world: World, knobs: FlightKnobs, frames: int, why: _Rejections) -> str:
    length = math.ceil((frames + 1) * knobs.spacing_m)
    reasons = (
        f"{why.outside} left the flight box or the height range, {why.blocked} came closer than clearance_m "
        f"{knobs.clearance_m:g}, {why.met} would have met something that moves, {why.enclosed} had no open sky"
    )
    return (
        f"no free flight of {length} m in this {world.map} world after {knobs.max_draws} draws ({reasons}); "
        "ask for a shorter clip, less clearance, other heights or a slower speed"
    )
