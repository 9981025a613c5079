"""Wind near the ground: a steady part, the gusts of the Dryden model, and how far they push a drone off its path.

Spectra, length scales and intensities for low altitude: MIL-F-8785C (1980), section 3.7.3.4; turbulence axes along the
mean wind.
"""

from __future__ import annotations

import math

import numpy as np
from jaxtyping import Float64
from scipy.signal import lfilter

_FOOT_M = 0.3048
_HOLD_RADPS, _HOLD_DAMPING = 1.5, 0.8
"""Natural frequency and damping with which a position controller answers a push; our choice for a small quadrotor."""
WARM_UP_S = 5.0
"""After this time the answer has forgotten how it began."""


def dryden_scales(height_m: float, wind_mps: float) -> tuple[tuple[float, float], tuple[float, float]]:
    """Lengths [m] and standard deviations [m/s] of gusts: horizontal, then vertical.

    Parameters
    ----------
    height_m : float
        Above ground; the model is made for 10 to 1000 ft, below which the scales of 10 ft are taken.
    wind_mps : float
        Mean wind 20 ft above ground.
    """
    height_ft = max(height_m / _FOOT_M, 10.0)
    ratio = 0.177 + 0.000823 * height_ft
    vertical = 0.1 * wind_mps
    return (
        (height_ft / ratio**1.2 * _FOOT_M, height_ft * _FOOT_M),
        (vertical / ratio**0.4, vertical),
    )


def draw_gusts(
    count: int,
    step_s: float,
    height_m: float,
    airspeed_mps: float,
    wind_mps: Float64[np.ndarray, "2"],
    rng: np.random.Generator,
) -> Float64[np.ndarray, "count 3"]:
    """Gust velocity [m/s] every `step_s`, east, north, up; stationary from the first sample on.

    Along the wind ``1 / (1 + T s)``, across and up ``(1 + sqrt(3) T s) / (1 + T s)^2`` applied to white noise, with
    ``T`` the length scale over the airspeed.
    """
    mean = float(np.hypot(*wind_mps))
    (far, near), (side, up) = dryden_scales(height_m, mean)
    airspeed = max(airspeed_mps, 1.0)
    noises = rng.spawn(3)
    along = side * _first_order(count, step_s * airspeed / far, noises[0])[:, 0]
    across = side * _second_order(count, step_s * airspeed / far, noises[1])
    vertical = up * _second_order(count, step_s * airspeed / near, noises[2])
    course = wind_mps / mean if mean > 0.0 else np.array([1.0, 0.0])
    flat = along[:, None] * course + across[:, None] * np.array([-course[1], course[0]])
    return np.concatenate([flat, vertical[:, None]], axis=1)


def _first_order(count: int, ratio: float, rng: np.random.Generator) -> Float64[np.ndarray, "count 2"]:
    """Unit noise through ``1/(1 + T s)`` once and twice, `ratio` = step / T, begun in its stationary state."""
    keep = math.exp(-ratio)
    white = rng.normal(size=(2, count))
    once = white[0] * math.sqrt(1.0 - keep**2)
    once[0] = white[0, 0]
    once = lfilter([1.0], [1.0, -keep], once)
    drive = (1.0 - keep) * np.concatenate([[0.0], once[:-1]])
    drive[0] = 0.5 * once[0] + 0.5 * white[1, 0]  # variance 1/2, covariance 1/2 with the first stage
    return np.stack([once, lfilter([1.0], [1.0, -keep], drive)], axis=1)


def _second_order(count: int, ratio: float, rng: np.random.Generator) -> Float64[np.ndarray, "count"]:
    """Unit noise through ``(1 + sqrt(3) T s)/(1 + T s)^2`` = sqrt(3)/(1 + T s) + (1 - sqrt(3))/(1 + T s)^2."""
    stages = _first_order(count, ratio, rng)
    root = math.sqrt(3.0)
    return np.asarray((root * stages[:, 0] + (1.0 - root) * stages[:, 1]) / math.sqrt(2.0))


def pushed(
    gusts: Float64[np.ndarray, "count 3"], step_s: float, drag_per_s: float
) -> Float64[np.ndarray, "count 3"]:
    """How far gusts push a drone off its path [m], from rest: ``x'' + 2 z w x' + w^2 x = drag * gust``.

    The steady wind pushes nobody off: the controller has long leaned into it.
    """
    w, z = 2.0 / step_s, 2.0 * _HOLD_DAMPING * _HOLD_RADPS
    hold = _HOLD_RADPS**2  # bilinear transform: s = w (1 - q)/(1 + q)
    poles = np.array([w * w + z * w + hold, 2.0 * (hold - w * w), w * w - z * w + hold])
    return np.asarray(lfilter(drag_per_s * np.array([1.0, 2.0, 1.0]), poles, gusts, axis=0))
