"""Where the nose points: it turns towards what is wanted as fast as the limits let it, and no faster."""

from __future__ import annotations

import math

import numpy as np
from jaxtyping import Float64

from scenegen_flythrough.quadrotor.limits import QuadrotorLimits

_LAG_S = 0.25
"""Time constant with which the nose makes up what it is off; our choice."""
_AHEAD_S = 0.25
"""An autopilot knows its path: it turns at the mean rate wanted over this time ahead."""


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
    aims = wanted_rad.tolist()
    at, out = aims[0], []
    rate = min(max((aims[min(1, len(aims) - 1)] - at) / step_s, -top), top)
    for k, aim in enumerate(aims):
        out.append(at)
        coming = (aims[min(k + lead, len(aims) - 1)] - aim) / (lead * step_s)
        gap = aim - at
        # Never faster towards the aim than can still be braked before it: v^2 = 2 a x.
        closing = min(abs(gap) / _LAG_S, math.sqrt(1.2 * push * abs(gap)))
        want = min(max(coming + math.copysign(closing, gap), -top), top)
        rate += min(max(want - rate, -push * step_s), push * step_s)
        at += rate * step_s
    return np.array(out)
