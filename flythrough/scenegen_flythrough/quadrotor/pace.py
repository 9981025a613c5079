"""How fast a curve may be taken: the cruise speed, and less where it bends or where its style says so."""

from __future__ import annotations

import math

import numpy as np
from jaxtyping import Float64
from scipy.ndimage import minimum_filter1d, uniform_filter1d

from scenegen_flythrough.quadrotor.curve import Curve
from scenegen_flythrough.quadrotor.limits import GRAVITY_MPS2, QuadrotorLimits

SLOWEST_MPS = 0.3
"""No flight stands still: frames are taken by way, not by time."""
_ROUNDING_S = 1.2
"""How long a change of the acceleration along the path takes, about."""
_SIDE, _ALONG, _JERK, _YAW = 0.7, 0.4, 0.5, 0.7
"""Shares of the limits that a path is planned with; what is left is for gusts and for several demands at once."""


def bend_speed(curve: Curve, limits: QuadrotorLimits, bank_deg: float) -> Float64[np.ndarray, "samples"]:
    """Speed [m/s] at which each sample's bend alone reaches the planned share of a limit.

    Three demands: acceleration towards the centre, ``v^2 k``; jerk from the change of curvature, ``v^3 |dk/ds|``; and
    the turning of a nose that follows the course, ``v k``.
    """
    bend = curve.curvature()
    change = np.linalg.norm(np.gradient(bend, curve.s, axis=0), axis=1)
    sideways = min(_SIDE * limits.acceleration_mps2, GRAVITY_MPS2 * math.tan(math.radians(bank_deg)))
    yaw = _YAW * math.radians(limits.yaw_rate_dps)
    along = curve.tangent()
    flat = np.maximum(along[:, 0] ** 2 + along[:, 1] ** 2, 1e-6)
    turn = np.abs(along[:, 0] * bend[:, 1] - along[:, 1] * bend[:, 0]) / flat
    slow = np.sqrt(sideways / np.maximum(np.linalg.norm(bend, axis=1), 1e-9))
    slow = np.minimum(slow, yaw / np.maximum(turn, 1e-9))
    return np.asarray(np.minimum(slow, np.cbrt(_JERK * limits.jerk_mps3 / np.maximum(change, 1e-9))))


def smooth_pace(
    curve: Curve, cap_mps: Float64[np.ndarray, "samples"], limits: QuadrotorLimits
) -> Float64[np.ndarray, "samples"]:
    """A speed for every sample, nowhere above the cap, that brakes before a slow place and gathers way after it.

    Half the slope of the squared speed is the acceleration along the path (kinetic energy per way), so its slope is
    bounded first. Then it is lowered to its smallest value within a window and averaged over the same window: that
    rounds its corners, which bounds the jerk, and leaves it below the cap.
    """
    slope = 2.0 * _ALONG * limits.acceleration_mps2
    even = np.linspace(0.0, curve.length_m, max(int(curve.length_m / 0.2), 8) + 1)
    squared = np.interp(even, curve.s, np.maximum(cap_mps, SLOWEST_MPS) ** 2)
    squared = np.minimum.accumulate(squared - slope * even) + slope * even
    squared = (np.minimum.accumulate((squared + slope * even)[::-1]) - slope * even[::-1])[::-1]
    window_m = max(_ROUNDING_S * math.sqrt(float(squared.max())), 2.0)
    boxes = max(int(window_m / 3.0 / (even[1] - even[0])) | 1, 3)
    squared = minimum_filter1d(squared, 3 * boxes, mode="nearest")
    for _ in range(3):
        squared = uniform_filter1d(squared, boxes, mode="nearest")
    return np.asarray(np.sqrt(np.interp(curve.s, even, squared)))
