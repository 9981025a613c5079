"""How a quadrotor must lean to move as it does, and how fast it turns meanwhile: differential flatness with drag.

A quadrotor pushes only along its own vertical axis, so that axis points where acceleration, weight and rotor drag
against the moving air ask for; the heading of the nose is free. Model: Faessler, Franchi and Scaramuzza (2018), doi
10.1109/LRA.2017.2776353, with the same drag along all axes.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from jaxtyping import Float64

from scenegen_flythrough.quadrotor.limits import GRAVITY_MPS2

DRAG_PER_S = 0.25
"""Linear rotor drag [1/s]: at 10 m/s it asks for a nose-down tilt of 14 deg; our choice for a small quadrotor."""


@dataclass(frozen=True, eq=False)
class Attitude:
    """The airframe at some instants.

    Attributes
    ----------
    world_from_body : float64 (times, 3, 3)
        Columns: nose, left, up.
    rates_radps : float64 (times, 3)
        Angular velocity about the same axes.
    """

    world_from_body: Float64[np.ndarray, "times 3 3"]
    rates_radps: Float64[np.ndarray, "times 3"]


def thrust_mps2(
    velocity: Float64[np.ndarray, "times 3"],
    acceleration: Float64[np.ndarray, "times 3"],
    wind: Float64[np.ndarray, "times 3"],
) -> Float64[np.ndarray, "times 3"]:
    """What the rotors must push with, per mass: acceleration, weight, and drag against the air."""
    return np.asarray(acceleration + DRAG_PER_S * (velocity - wind) + np.array([0.0, 0.0, GRAVITY_MPS2]))


def flat_attitude(
    thrust: Float64[np.ndarray, "times 3"],
    thrust_rate: Float64[np.ndarray, "times 3"],
    yaw_rad: Float64[np.ndarray, "times"],
    yaw_rate_radps: Float64[np.ndarray, "times"],
) -> Attitude:
    """Attitude and body rates from thrust, heading and their time derivatives, in closed form.

    Parameters
    ----------
    thrust, thrust_rate : float64 (times, 3)
        `thrust_mps2` and its derivative.
    yaw_rad, yaw_rate_radps : float64 (times,)
        Heading of the nose, from east towards north.
    """
    up, up_rate = _unit(thrust, thrust_rate)
    zero = np.zeros_like(yaw_rad)
    course = np.stack([np.cos(yaw_rad), np.sin(yaw_rad), zero], axis=1)
    course_rate = yaw_rate_radps[:, None] * np.stack([-course[:, 1], course[:, 0], zero], axis=1)
    across = np.cross(up, course)
    left, left_rate = _unit(across, np.cross(up_rate, course) + np.cross(up, course_rate))
    nose = np.cross(left, up)
    nose_rate = np.cross(left_rate, up) + np.cross(left, up_rate)
    rates = np.stack(
        [(up * left_rate).sum(axis=1), (nose * up_rate).sum(axis=1), (left * nose_rate).sum(axis=1)], axis=1
    )
    return Attitude(np.stack([nose, left, up], axis=2), rates)


def _unit(
    v: Float64[np.ndarray, "times 3"], rate: Float64[np.ndarray, "times 3"]
) -> tuple[Float64[np.ndarray, "times 3"], Float64[np.ndarray, "times 3"]]:
    """Direction of a vector, and the derivative of the direction."""
    length = np.linalg.norm(v, axis=1, keepdims=True)
    unit = v / length
    return unit, (rate - (rate * unit).sum(axis=1, keepdims=True) * unit) / length
