"""What a command does to a quadrotor: a velocity controller behind limits of speed, acceleration, jerk and yaw rate.

The autopilot of a real multirotor takes velocity set-points; this is its closed loop, not its motors. Wanted velocity
is approached with a time constant, through an acceleration that can only grow so fast and so large. Gusts push through
the linear drag of the rotors and take their share of what the airframe can do.
"""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np
from jaxtyping import Float64

from scenegen_flythrough.loop.knobs import DroneLimits
from scenegen_flythrough.loop.pilot import Command
from scenegen_flythrough.quadrotor.attitude import DRAG_PER_S, flat_attitude, thrust_mps2

_VELOCITY_LAG_S = 0.3
"""Time constant of the velocity controller; our choice, typical of small autopilots."""
_YAW_LAG_S = 0.2


@dataclass(frozen=True, eq=False)
class DroneState:
    """Drones at one instant.

    Attributes
    ----------
    position_m, velocity_mps, acceleration_mps2 : float64 (n, 3)
        World frame; the acceleration is that of the step just flown.
    yaw_rad : float64 (n,)
        Heading, counter-clockwise from east.
    time_s : float
    """

    position_m: Float64[np.ndarray, "n 3"]
    velocity_mps: Float64[np.ndarray, "n 3"]
    acceleration_mps2: Float64[np.ndarray, "n 3"]
    yaw_rad: Float64[np.ndarray, "n"]
    time_s: float

    @staticmethod
    def resting(position_m: Float64[np.ndarray, "n 3"], yaw_rad: Float64[np.ndarray, "n"]) -> DroneState:
        """Drones that hover, at time zero."""
        still = np.zeros_like(position_m)
        return DroneState(position_m.copy(), still, still.copy(), yaw_rad.copy(), 0.0)


def advance(
    state: DroneState,
    command: Command,
    limits: DroneLimits,
    gust_mps: Float64[np.ndarray, "n 3"],
    dt_s: float,
) -> DroneState:
    """Fly one small step.

    Parameters
    ----------
    state : DroneState
    command : Command
        What is longed for; anything finite.
    limits : DroneLimits
    gust_mps : float64 (n, 3)
        Wind less its mean, against which the autopilot trims.
    dt_s : float
        A few hundredths of a second; the acceleration is constant meanwhile.

    Returns
    -------
    DroneState
        Speed and acceleration lie within the limits exactly: the speed is projected onto its ball, and a projection
        onto a convex set never lengthens a difference. The acceleration changes by at most the jerk, except where
        that ball stops it.
    """
    wanted = _at_most(command.velocity_mps, limits.speed_mps) - state.velocity_mps
    asked = wanted / _VELOCITY_LAG_S + DRAG_PER_S * gust_mps
    asked = _at_most(asked, limits.acceleration_mps2)
    change = _at_most(asked - state.acceleration_mps2, limits.jerk_mps3 * dt_s)
    velocity = _at_most(state.velocity_mps + (state.acceleration_mps2 + change) * dt_s, limits.speed_mps)
    turn = np.angle(np.exp(1j * (command.yaw_rad - state.yaw_rad)))
    fastest = math.radians(limits.yaw_rate_dps)
    rate = np.clip(turn / max(_YAW_LAG_S, dt_s), -fastest, fastest)
    return DroneState(
        position_m=state.position_m + 0.5 * (state.velocity_mps + velocity) * dt_s,
        velocity_mps=velocity,
        acceleration_mps2=(velocity - state.velocity_mps) / dt_s,
        yaw_rad=state.yaw_rad + rate * dt_s,
        time_s=state.time_s + dt_s,
    )


def camera_poses(
    state: DroneState, mount_pitch_deg: float, *, stabilised: bool
) -> Float64[np.ndarray, "n 4 4"]:
    """`world_from_camera` of a camera on the nose.

    Parameters
    ----------
    state : DroneState
    mount_pitch_deg : float
        Against the horizon if stabilised, else against the airframe; negative looks down.
    stabilised : bool
        False tilts the camera with the thrust, which alone carries the drone (differential flatness).
    """
    yaw, still = state.yaw_rad, np.zeros_like(state.velocity_mps)
    moved = (still, still) if stabilised else (state.velocity_mps, state.acceleration_mps2)
    body = flat_attitude(thrust_mps2(*moved, still), still, yaw, np.zeros_like(yaw)).world_from_body
    nose, left, up = body[:, :, 0], body[:, :, 1], body[:, :, 2]
    sine, cosine = math.sin(math.radians(mount_pitch_deg)), math.cos(math.radians(mount_pitch_deg))
    poses = np.zeros((len(yaw), 4, 4))
    poses[:, :3, 0] = -left
    poses[:, :3, 1] = sine * nose - cosine * up
    poses[:, :3, 2] = cosine * nose + sine * up
    poses[:, :3, 3] = state.position_m
    poses[:, 3, 3] = 1.0
    return poses


def _at_most(v: Float64[np.ndarray, "n 3"], limit: float) -> Float64[np.ndarray, "n 3"]:
    """Vectors shortened to a length."""
    length = np.sqrt((v * v).sum(axis=1, keepdims=True))
    return np.asarray(v * (limit / np.maximum(length, limit)))
