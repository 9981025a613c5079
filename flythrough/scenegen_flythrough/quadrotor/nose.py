"""Where the nose points: it turns towards what is wanted as fast as the limits let it, and no faster."""

from __future__ import annotations

import math

import numpy as np
from jaxtyping import Float64

from scenegen_flythrough.quadrotor.limits import QuadrotorLimits

_LAG_S = 0.25
"""Time constant with which the nose follows; our choice."""
_AHEAD_S = 0.25
"""An autopilot knows its path: it begins to turn this much earlier, so that steady turns show no lag."""


def follow_heading(
    wanted_rad: Float64[np.ndarray, "knots"], step_s: float, limits: QuadrotorLimits
) -> Float64[np.ndarray, "knots"]:
    """Heading [rad] at every knot, whose first and second differences hold the limits of rate and acceleration.

    Parameters
    ----------
    wanted_rad : float64 (knots,)
        Without jumps of a full turn.
    step_s : float
    limits : QuadrotorLimits
    """
    top = 0.98 * math.radians(limits.yaw_rate_dps)
    push = math.radians(limits.yaw_acceleration_dps2)
    lead = round(_AHEAD_S / step_s)
    ahead = [*wanted_rad[lead:].tolist(), *[float(wanted_rad[-1])] * min(lead, len(wanted_rad))]
    at = float(wanted_rad[0])
    rate = min(max((ahead[1] - ahead[0]) / step_s, -top), top)
    out = []
    for aim in ahead:
        out.append(at)
        gap = aim - at
        # Never faster than can still be braked before the aim: v^2 = 2 a x.
        brake = math.sqrt(1.2 * push * abs(gap))
        want = min(max(gap / _LAG_S, -top, -brake), top, brake)
        rate += min(max(want - rate, -push * step_s), push * step_s)
        at += rate * step_s
    return np.array(out[: len(wanted_rad)])
