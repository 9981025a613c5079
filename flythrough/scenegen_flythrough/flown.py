"""From a motion to the trajectory of a clip: frames by way, camera on its mount, inertial samples, and the proof."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from jaxtyping import Float64

from scenegen.movers.clock import Clock
from scenegen_flythrough.airspace import Airspace
from scenegen_flythrough.knobs import FlightKnobs
from scenegen_flythrough.proof import Span, objection, sees_world
from scenegen_flythrough.quadrotor.imu import feel
from scenegen_flythrough.quadrotor.motion import Motion
from scenegen_flythrough.quadrotor.mount import Vibration, body_from_camera
from scenegen_flythrough.trajectory import Trajectory


@dataclass(frozen=True, eq=False)
class Flown:
    """A motion that awaits its proof.

    Attributes
    ----------
    motion : Motion
    pitch_deg : float
        Camera against airframe.
    first_m : float
        Way of the motion before the clip, or behind it if `at_end`.
    at_end : bool
    wind_mps : (float, float)
    free_height : bool
        Any height and any view in the flight box will do.
    """

    motion: Motion
    pitch_deg: float
    first_m: float = 0.0
    at_end: bool = False
    wind_mps: tuple[float, float] = (0.0, 0.0)
    free_height: bool = False


def trajectory(
    airspace: Airspace,
    knobs: FlightKnobs,
    frames: int,
    flown: Flown,
    clock: Clock,
    rng: np.random.Generator,
) -> Trajectory | str:
    """The trajectory of a clip, or the key of `proof.REASONS` that forbids it.

    Its style and what was turned down before it are for the caller to enter.

    Parameters
    ----------
    airspace : Airspace
    knobs : FlightKnobs
    frames : int
        Frames to be stored.
    flown : Flown
    clock : Clock
        World time of the clip.
    rng : numpy.random.Generator
        For vibration and the noise of the inertial unit.
    """
    motion = flown.motion
    times = motion.times_at_way(flown.first_m, knobs.spacing_m, frames + 2, at_end=flown.at_end)
    if times is None:
        return "outside"
    zero_s = float(times[1])
    vibration_rng, noise_rng = rng.spawn(2)
    poses = _poses(flown, times, Vibration.draw(knobs.vibration_mrad, vibration_rng), zero_s)
    if not flown.free_height and not sees_world(airspace, poses):
        return "outside"
    span = Span.of(motion, float(times[0]), float(times[-1]))
    why = objection(airspace, knobs, span, zero_s, clock, free_height=flown.free_height)
    if why is not None:
        return why
    closest = airspace.proximity.sweep(span.place[:-1], span.place[1:]).distance_m
    time_s = times - zero_s
    return Trajectory(
        world_from_camera=poses,
        time_s=time_s,
        speed_mps=float((frames + 1) * knobs.spacing_m / (time_s[-1] - time_s[0])),
        clearance_m=float(closest.min()) - span.sag_m,
        rejected=0,
        style="",
        velocity_mps=motion.position.at(times, 1),
        body_from_camera=body_from_camera(flown.pitch_deg),
        imu=feel(motion, zero_s, (0.0, float(time_s[-1])), knobs.imu, noise_rng),
        wind_mps=flown.wind_mps,
        rejections=(),
        motion=motion,
        zero_s=zero_s,
    )


def _poses(
    flown: Flown, times: Float64[np.ndarray, "poses"], vibration: Vibration, zero_s: float
) -> Float64[np.ndarray, "poses 4 4"]:
    """``world_from_camera`` at motion times."""
    poses = np.zeros((len(times), 4, 4))
    mounted = flown.motion.attitude(times).world_from_body @ body_from_camera(flown.pitch_deg)
    poses[:, :3, :3] = mounted @ vibration.at(times - zero_s)
    poses[:, :3, 3] = flown.motion.position.at(times)
    poses[:, 3, 3] = 1.0
    return poses
