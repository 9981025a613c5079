"""The way of a quadrotor: splines, gusts, pace, and limits that hold whatever is asked."""

from __future__ import annotations

import numpy as np
import pytest
from scipy.interpolate import BSpline

from routes import WINDY, bend, motion_of
from scenegen.foundation.rng import stream
from scenegen_flythrough.quadrotor.attitude import DRAG_PER_S
from scenegen_flythrough.quadrotor.curve import Curve
from scenegen_flythrough.quadrotor.gusts import draw_gusts, dryden_scales, pushed
from scenegen_flythrough.quadrotor.limits import GRAVITY_MPS2 as G
from scenegen_flythrough.quadrotor.limits import QuadrotorLimits
from scenegen_flythrough.quadrotor.nose import follow_heading
from scenegen_flythrough.quadrotor.pace import bend_speed, smooth_pace
from scenegen_flythrough.quadrotor.pilotage import Wind, pilot
from scenegen_flythrough.quadrotor.spline import UniformSpline
from scenegen_flythrough.route import Route

CALM = Wind(np.zeros(2), 10.0)


def circle(radius_m: float, turns: float = 1.0, step_m: float = 1.0) -> np.ndarray:
    angle = np.arange(0.0, turns * 2 * np.pi, step_m / radius_m)
    return np.stack([radius_m * np.cos(angle), radius_m * np.sin(angle), np.full_like(angle, 20.0)], axis=1)


def test_a_uniform_spline_is_a_b_spline_and_never_exceeds_its_bounds() -> None:
    control = np.random.default_rng(0).normal(size=(14, 3))
    spline = UniformSpline(2.0, 0.3, control)
    truth = BSpline(2.0 + 0.3 * (np.arange(20) - 5), control, 5)
    t = np.linspace(2.0, spline.end, 400)
    for order in range(5):
        np.testing.assert_allclose(spline.at(t, order), truth(t, order), rtol=1e-9, atol=1e-9)
    for order in (1, 2, 3):
        assert np.linalg.norm(truth(t, order), axis=1).max() <= spline.bound(order)


def test_a_curve_knows_its_length_and_curvature() -> None:
    curve = Curve.of(circle(30.0, turns=0.9))
    inner = slice(60, -60)  # ends run on straight
    radius = np.linalg.norm(curve.place[inner, :2], axis=1)
    np.testing.assert_allclose(radius, radius[0], rtol=1e-6)
    np.testing.assert_allclose(np.linalg.norm(curve.curvature()[inner], axis=1), 1 / radius[0], rtol=1e-6)
    chords = np.linalg.norm(
        np.diff(curve.spline.at(np.linspace(0, curve.u[-1], 40_001)), axis=0), axis=1
    ).sum()
    assert curve.length_m == pytest.approx(chords, rel=1e-7)
    way = np.array([10.0, 55.5, 120.0])
    u = curve.index_at(way)
    for k, place in enumerate(way):
        part = np.linalg.norm(np.diff(curve.spline.at(np.linspace(0, u[k], 20_001)), axis=0), axis=1).sum()
        assert part == pytest.approx(place, abs=1e-4)


def test_gusts_have_the_strength_and_length_of_the_dryden_model() -> None:
    height, wind, speed, step = 30.0, np.array([0.0, 8.0]), 10.0, 0.05
    (far, near), (side, up) = dryden_scales(height, 8.0)
    assert up == pytest.approx(0.8)  # a tenth of the wind
    assert side > up and far > near == pytest.approx(height)
    gusts = np.concatenate([draw_gusts(4000, step, height, speed, wind, stream(k, "g")) for k in range(40)])
    np.testing.assert_allclose(gusts.std(axis=0), [side, side, up], rtol=0.1)
    along = np.stack([draw_gusts(4000, step, height, speed, wind, stream(k, "g"))[:, 1] for k in range(40)])
    lag = round(far / speed / step / 4)  # along the wind the correlation falls like exp(-V t / L)
    correlation = (along[:, :-lag] * along[:, lag:]).mean() / (along**2).mean()
    assert correlation == pytest.approx(np.exp(-0.25), abs=0.1)
    assert not draw_gusts(10, step, height, speed, np.zeros(2), stream(1)).any()


def test_a_lasting_gust_pushes_by_drag_over_stiffness() -> None:
    push = pushed(np.ones((400, 3)), 0.05, DRAG_PER_S)
    assert push[-1] == pytest.approx(np.full(3, DRAG_PER_S / 1.5**2), rel=1e-3)
    assert np.abs(push[0]).max() < 1e-3


def test_wind_leans_the_drone_and_barely_moves_it() -> None:
    calm, windy = motion_of(bend(), CALM), motion_of(bend(), WINDY)
    end = min(calm.position.end, windy.position.end)
    t = np.linspace(calm.position.start, end, 200)
    tilt = [np.arccos(m.attitude(t).world_from_body[:, 2, 2]) for m in (calm, windy)]
    assert np.abs(tilt[0] - tilt[1]).max() > np.radians(3.0)
    straight = t < 4.0
    apart = np.abs(windy.position.at(t[straight])[:, 1:] - calm.position.at(t[straight])[:, 1:])
    assert 0.005 < apart.max() < 1.0


def test_pace_brakes_before_a_slow_place_and_stays_below_every_cap() -> None:
    limits = QuadrotorLimits()
    curve = Curve.of(np.stack([np.arange(0.0, 200.0, 2.0), np.zeros(100), np.full(100, 9.0)], axis=1))
    cap = np.where(np.abs(curve.s - 120.0) < 3.0, 3.0, 15.0)
    pace = smooth_pace(curve, cap, limits)
    assert (pace <= cap + 1e-9).all()
    assert pace[0] == pytest.approx(15.0) and pace[-1] > 12.0
    assert pace[np.abs(curve.s - 120.0) < 2.0].min() > 2.5
    pull = np.gradient(0.5 * pace**2, curve.s)
    assert np.abs(pull).max() < 0.5 * limits.acceleration_mps2


def test_bends_are_taken_at_the_speed_that_the_bank_allows() -> None:
    curve = Curve.of(circle(20.0))
    speed = bend_speed(curve, QuadrotorLimits(), 25.0)[100:-100]
    np.testing.assert_allclose(speed, np.sqrt(G * np.tan(np.radians(25.0)) * 20.0), rtol=2e-3)
    slow_nose = bend_speed(curve, QuadrotorLimits(yaw_rate_dps=10.0), 25.0)[100:-100]
    np.testing.assert_allclose(slow_nose, 0.7 * np.radians(10.0) * 20.0, rtol=2e-3)


def test_speed_falls_in_the_bend_and_recovers() -> None:
    motion = motion_of(bend(), CALM, speed=12.0)
    t = np.linspace(motion.position.start, motion.position.end, 400)
    place, speed = motion.position.at(t), np.linalg.norm(motion.position.at(t, 1), axis=1)
    corner = int(np.argmin(np.linalg.norm(place[:, :2] - [59.0, 1.0], axis=1)))
    assert speed[corner] < 0.75 * speed[0]
    assert speed[-1] > 1.2 * speed[corner]


@pytest.mark.parametrize("rate", [20.0, 90.0])
def test_the_nose_turns_no_faster_than_it_may_and_shows_no_lag_in_steady_turns(rate: float) -> None:
    limits, step = QuadrotorLimits(yaw_rate_dps=rate, yaw_acceleration_dps2=120.0), 0.05
    wanted = np.radians(np.concatenate([np.zeros(40), np.full(200, 170.0), np.full(200, -90.0)]))
    yaw = np.degrees(follow_heading(wanted, step, limits))
    assert np.abs(np.diff(yaw)).max() / step <= rate
    assert np.abs(np.diff(yaw, 2)).max() / step**2 <= 120.0 + 1e-9
    assert yaw[239 if rate > 50 else 235] == pytest.approx(170.0, abs=5.0)
    assert yaw[200:].max() < 176.0  # hardly any overshoot
    turning = np.radians(0.5 * rate) * step * np.arange(400)
    np.testing.assert_allclose(follow_heading(turning, step, limits)[60:-20], turning[60:-20], atol=0.02)


@pytest.mark.parametrize("wild", [1.0, 4.0])
def test_a_jagged_route_is_flown_within_the_limits_or_not_at_all(wild: float) -> None:
    """Random walks of points two metres apart, judged by finite differences every 2 ms."""
    flown = 0
    for index in range(12):
        rng = stream(8, "jagged", index)
        turns = np.cumsum(wild * 0.4 * rng.normal(size=60))
        steps = 2.0 * np.stack([np.cos(turns), np.sin(turns), 0.2 * rng.normal(size=60)], axis=1)
        limits = QuadrotorLimits(speed_mps=18.0, acceleration_mps2=5.0, jerk_mps3=12.0, tilt_deg=35.0)
        motion = pilot(
            Route(np.cumsum(steps, axis=0) + np.array([0.0, 0.0, 30.0]), 15.0, 0.0), WINDY, limits, 30.0, rng
        )
        if motion is None:
            continue
        flown += 1
        t = np.arange(motion.position.start, motion.position.end, 0.002)
        place = motion.position.at(t)
        size = [np.linalg.norm(np.diff(place, k, axis=0), axis=1).max() / 0.002**k for k in (1, 2, 3)]
        assert size[0] <= 18.0 and size[1] <= 5.0 and size[2] <= 12.0 + 1e-2
        assert np.degrees(np.arccos(motion.attitude(t).world_from_body[:, 2, 2].min())) <= 35.0
    assert flown >= (8 if wild == 1.0 else 2)
