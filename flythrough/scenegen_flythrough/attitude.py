"""From a path to camera poses: how a quadrotor must tilt to fly it, and where a camera on its nose looks."""

from __future__ import annotations

import math

import numpy as np
from jaxtyping import Float64

from scenegen_flythrough.steering import GRAVITY_MPS2

_DRAG_PER_S = 0.25
"""Linear rotor drag [1/s]: at 10 m/s it asks for a nose-down tilt of 14 deg. The model is that of Faessler, Franchi
and Scaramuzza, doi 10.1109/LRA.2017.2776353; the value is our choice for a small quadrotor."""
_YAW_LAG_S = 0.25
"""Time constant with which the nose follows the heading [s]; our choice."""


def camera_poses(
    path: Float64[np.ndarray, "poses 3"], speed_mps: float, bank_deg: float, mount_pitch_deg: float
) -> Float64[np.ndarray, "poses 4 4"]:
    """Poses of a camera that flies along `path` at constant speed on a quadrotor's nose.

    A quadrotor pushes only along its own vertical axis, so that axis points where acceleration, weight and drag ask for
    (differential flatness); yaw follows the heading with a short lag.

    Parameters
    ----------
    path : float64 (poses, 3)
        Equally spaced positions [m], at least three.
    speed_mps : float
    bank_deg : float
        Largest tilt of the airframe against the vertical [deg].
    mount_pitch_deg : float
        Camera against airframe [deg]; negative looks down.

    Returns
    -------
    float64 (poses, 4, 4)
        ``world_from_camera``: OpenCV axes (x right, y down, z forward).
    """
    spacing = float(np.linalg.norm(path[1] - path[0]))
    velocity = speed_mps * np.gradient(path, spacing, axis=0)
    acceleration = np.zeros_like(path)
    acceleration[1:-1] = (path[2:] - 2 * path[1:-1] + path[:-2]) * (speed_mps / spacing) ** 2
    acceleration[0], acceleration[-1] = acceleration[1], acceleration[-2]
    thrust = acceleration + _DRAG_PER_S * velocity + np.array([0.0, 0.0, GRAVITY_MPS2])
    up = _tilt_at_most(thrust, math.radians(bank_deg))
    yaw = _lagged(np.unwrap(np.arctan2(velocity[:, 1], velocity[:, 0])), spacing / speed_mps)
    left = np.cross(up, np.stack([np.cos(yaw), np.sin(yaw), np.zeros_like(yaw)], axis=1))
    left /= np.linalg.norm(left, axis=1, keepdims=True)
    nose = np.cross(left, up)
    pitch = math.radians(mount_pitch_deg)
    poses = np.zeros((len(path), 4, 4))
    poses[:, :3, 0] = -left
    poses[:, :3, 1] = math.sin(pitch) * nose - math.cos(pitch) * up
    poses[:, :3, 2] = math.cos(pitch) * nose + math.sin(pitch) * up
    poses[:, :3, 3] = path
    poses[:, 3, 3] = 1.0
    return poses


def _tilt_at_most(thrust: Float64[np.ndarray, "poses 3"], limit_rad: float) -> Float64[np.ndarray, "poses 3"]:
    """Unit vectors along the thrust, bent towards the vertical where they lean further than the limit."""
    side = thrust[:, :2]
    lean = np.linalg.norm(side, axis=1)
    tilt = np.minimum(np.arctan2(lean, thrust[:, 2]), limit_rad)
    direction = np.divide(side, lean[:, None], out=np.zeros_like(side), where=lean[:, None] > 0.0)
    return np.concatenate([np.sin(tilt)[:, None] * direction, np.cos(tilt)[:, None]], axis=1)


def _lagged(heading: Float64[np.ndarray, "poses"], dt_s: float) -> Float64[np.ndarray, "poses"]:
    """First-order lag, started as if the first turn had been flown for long."""
    keep = math.exp(-dt_s / _YAW_LAG_S)
    yaw = np.empty_like(heading)
    yaw[0] = heading[0] - (heading[1] - heading[0]) * keep / (1.0 - keep)
    for k in range(1, len(heading)):
        yaw[k] = keep * yaw[k - 1] + (1.0 - keep) * heading[k]
    return yaw
