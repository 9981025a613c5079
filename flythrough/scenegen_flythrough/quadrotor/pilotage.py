"""From a drawn path to a motion that a quadrotor can fly in this wind: timed, pushed about, and held to the limits."""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np
from jaxtyping import Float64
from scipy.interpolate import CubicHermiteSpline
from scipy.ndimage import maximum_filter1d

from scenegen_flythrough.quadrotor.attitude import DRAG_PER_S
from scenegen_flythrough.quadrotor.curve import Curve
from scenegen_flythrough.quadrotor.gusts import WARM_UP_S, draw_gusts, pushed
from scenegen_flythrough.quadrotor.limits import QuadrotorLimits
from scenegen_flythrough.quadrotor.motion import FlatLeaning, Motion
from scenegen_flythrough.quadrotor.nose import follow_heading
from scenegen_flythrough.quadrotor.pace import bend_speed, smooth_pace
from scenegen_flythrough.quadrotor.spline import LEAD, UniformSpline
from scenegen_flythrough.route import Route

STEP_S = 0.05
_TRIES = 8
_TILT_MARGIN_DEG = 0.5  # more than the tilt can change between the instants it is looked at


@dataclass(frozen=True, eq=False)
class Wind:
    """Air of one flight.

    Attributes
    ----------
    mean_mps : float64 (2,)
        Steady wind, east and north.
    height_m : float
        Above ground, for the size of the gusts.
    """

    mean_mps: Float64[np.ndarray, "2"]
    height_m: float

    @staticmethod
    def draw(speed_mps: float, height_m: float, rng: np.random.Generator) -> Wind:
        """From any direction."""
        towards = rng.uniform(0.0, 2 * np.pi)
        return Wind(speed_mps * np.array([np.cos(towards), np.sin(towards)]), height_m)


def pilot(
    route: Route, wind: Wind, limits: QuadrotorLimits, bank_deg: float, rng: np.random.Generator
) -> Motion | None:
    """Fly a route as fast as asked and as slowly as the limits demand.

    Where a first plan exceeds a limit, the neighbourhood is flown more slowly, up to eight times.

    Parameters
    ----------
    route : Route
    wind : Wind
    limits : QuadrotorLimits
    bank_deg : float
        Lean wanted at most in bends.
    rng : numpy.random.Generator
        For the gusts.

    Returns
    -------
    Motion or None
        Nothing where the limits cannot be held even so.
    """
    curve = Curve.of(route.points)
    cap = np.minimum(min(route.speed_mps, limits.speed_mps), bend_speed(curve, limits, bank_deg))
    if route.cap_mps is not None:
        cap = np.minimum(cap, np.interp(curve.u, np.arange(len(route.points)), route.cap_mps))
    pace = smooth_pace(curve, cap, limits)
    duration_s = float(_clock(curve, pace)[-1])
    warm = round(WARM_UP_S / STEP_S)
    count = math.ceil(3.0 * duration_s / STEP_S) + 8
    gusts = draw_gusts(count + warm, STEP_S, wind.height_m, curve.length_m / duration_s, wind.mean_mps, rng)
    push = pushed(gusts, STEP_S, DRAG_PER_S)[warm:]
    air = gusts[warm:] + np.array([*wind.mean_mps, 0.0])
    for _ in range(_TRIES):
        way, motion = _plan(route, curve, pace, push, air, limits)
        if motion is None:
            return None
        excess = excess_of(motion, limits)
        if (excess <= 1.0).all():
            return motion
        slower = 0.98 / np.sqrt(np.maximum(maximum_filter1d(excess, 7), 1.0))
        cap = cap * np.interp(curve.s, way, np.where(slower < 0.98, slower, 1.0))
        pace = smooth_pace(curve, cap, limits)
    return None


def _clock(curve: Curve, pace: Float64[np.ndarray, "samples"]) -> Float64[np.ndarray, "samples"]:
    """Time at each sample of the curve [s]."""
    return np.concatenate([[0.0], np.cumsum(np.diff(curve.s) * 0.5 * (1.0 / pace[1:] + 1.0 / pace[:-1]))])


def _plan(
    route: Route,
    curve: Curve,
    pace: Float64[np.ndarray, "samples"],
    push: Float64[np.ndarray, "steps 3"],
    air: Float64[np.ndarray, "steps 3"],
    limits: QuadrotorLimits,
) -> tuple[Float64[np.ndarray, "knots"], Motion | None]:
    """Way at each coefficient of the motion, and the motion."""
    clock = _clock(curve, pace)
    t = np.arange(int(clock[-1] / STEP_S) + 1) * STEP_S
    if len(t) > len(push) or len(t) < 2 * LEAD + 4:
        return t, None
    way = np.clip(CubicHermiteSpline(clock, curve.s, pace)(t), 0.0, curve.length_m)
    u = np.clip(curve.index_at(way), 0.0, curve.u[-1])
    start = LEAD * STEP_S
    position = UniformSpline(start, STEP_S, curve.spline.at(u) + push[: len(t)])
    if route.nose_rad is None:
        ahead = curve.spline.at(u, 1)
        wanted = np.unwrap(np.arctan2(ahead[:, 1], ahead[:, 0]))
    else:
        wanted = np.interp(u, np.arange(len(route.points)), route.nose_rad)
    heading = UniformSpline(start, STEP_S, follow_heading(wanted, STEP_S, limits)[:, None])
    return way, Motion(position, FlatLeaning(heading, UniformSpline(start, STEP_S, air[: len(t)])))


def excess_of(motion: Motion, limits: QuadrotorLimits) -> Float64[np.ndarray, "knots"]:
    """At each coefficient, by what factor the square of the speed is too large; at most 1 where all is well.

    Speed, acceleration and jerk are judged by the coefficients of their splines, which bound them at all instants.
    """
    position = motion.position
    count = len(position.control)
    excess = np.zeros(count)
    for order, limit, power in (
        (1, limits.speed_mps, 2.0),
        (2, limits.acceleration_mps2, 1.0),
        (3, limits.jerk_mps3, 2.0 / 3.0),
    ):
        size = (np.linalg.norm(position.differences(order), axis=1) / limit) ** power
        for shift in range(order + 1):
            part = slice(shift, count - order + shift)
            excess[part] = np.maximum(excess[part], size)
    fine = np.arange((count - 5) * 4 + 1) * (position.step / 4) + position.start
    fine = np.minimum(fine, position.end)
    up = motion.leaning.up(fine, position)
    tilt = np.arctan2(np.hypot(up[:, 0], up[:, 1]), up[:, 2])
    most = math.tan(math.radians(max(limits.tilt_deg - _TILT_MARGIN_DEG, 1.0)))
    leans = np.tan(np.minimum(tilt, 1.55)) / most
    at = np.round((fine - position.start) / position.step).astype(np.int64) + LEAD
    np.maximum.at(excess, at, leans)
    return excess
