"""The quadrotor: closed forms, independent integration, and limits that hold whatever is asked."""

from __future__ import annotations

from itertools import pairwise

import numpy as np
import pytest
from scipy.interpolate import BSpline

from scenegen.foundation.rng import stream
from scenegen_flythrough.quadrotor.attitude import DRAG_PER_S, flat_attitude, thrust_mps2
from scenegen_flythrough.quadrotor.curve import Curve
from scenegen_flythrough.quadrotor.gusts import draw_gusts, dryden_scales, pushed
from scenegen_flythrough.quadrotor.imu import RATE_HZ, ImuKnobs, feel
from scenegen_flythrough.quadrotor.limits import GRAVITY_MPS2 as G
from scenegen_flythrough.quadrotor.limits import QuadrotorLimits
from scenegen_flythrough.quadrotor.motion import FlatLeaning, Motion
from scenegen_flythrough.quadrotor.mount import Vibration, body_from_camera, rotations
from scenegen_flythrough.quadrotor.nose import follow_heading
from scenegen_flythrough.quadrotor.pace import bend_speed, smooth_pace
from scenegen_flythrough.quadrotor.pilotage import Wind, pilot
from scenegen_flythrough.quadrotor.spline import UniformSpline
from scenegen_flythrough.route import Route

CALM = Wind(np.zeros(2), 10.0)
WINDY = Wind(np.array([5.0, -3.0]), 10.0)


def circle(radius_m: float, turns: float = 1.0, step_m: float = 1.0) -> np.ndarray:
    angle = np.arange(0.0, turns * 2 * np.pi, step_m / radius_m)
    return np.stack([radius_m * np.cos(angle), radius_m * np.sin(angle), np.full_like(angle, 20.0)], axis=1)


def bend(step_m: float = 2.0) -> np.ndarray:
    """60 m east, then 60 m north."""
    leg = np.arange(0.0, 60.0, step_m)
    east = np.stack([leg, np.zeros_like(leg), np.full_like(leg, 20.0)], axis=1)
    north = np.stack([np.full_like(leg, 60.0), leg, np.full_like(leg, 20.0)], axis=1)
    return np.concatenate([east, north])


# --- splines -------------------------------------------------------------------------------------------------------


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


# --- attitude ------------------------------------------------------------------------------------------------------


def attitude_of(
    velocity: list[float], acceleration: list[float], yaw: float, wind: list[float] | None = None
):
    thrust = thrust_mps2(np.array([velocity]), np.array([acceleration]), np.array([wind or [0.0, 0.0, 0.0]]))
    return flat_attitude(thrust, np.zeros((1, 3)), np.array([yaw]), np.zeros(1)).world_from_body[0]


@pytest.mark.parametrize("heading_deg", [0.0, 37.0, 90.0, 179.0, -120.0])
def test_level_flight_noses_down_against_the_drag(heading_deg: float) -> None:
    yaw = np.radians(heading_deg)
    body = attitude_of([8.0 * np.cos(yaw), 8.0 * np.sin(yaw), 0.0], [0.0, 0.0, 0.0], yaw)
    assert np.degrees(np.arcsin(body[2, 0])) == pytest.approx(-np.degrees(np.arctan(DRAG_PER_S * 8.0 / G)))
    assert np.degrees(np.arctan2(body[1, 0], body[0, 0])) == pytest.approx(heading_deg)
    np.testing.assert_allclose(body[:, 1], [-np.sin(yaw), np.cos(yaw), 0.0], atol=1e-12)


def test_climbing_leans_by_the_whole_drag() -> None:
    """At 30 deg the drag pulls backwards and down: tan(tilt) = D v cos / (g + D v sin)."""
    body = attitude_of([8.0 * np.cos(np.pi / 6), 0.0, 4.0], [0.0, 0.0, 0.0], 0.0)
    expected = np.arctan(DRAG_PER_S * 8.0 * np.cos(np.pi / 6) / (G + DRAG_PER_S * 4.0))
    assert np.arcsin(-body[2, 0]) == pytest.approx(expected)


@pytest.mark.parametrize("side", [1.0, -1.0])
def test_turning_banks_into_the_turn(side: float) -> None:
    """A circle of 40 m at 10 m/s needs 2.5 m/s^2 towards its centre; the inner side goes down."""
    body = attitude_of([10.0, 0.0, 0.0], [0.0, side * 2.5, 0.0], 0.0)
    up = body[:, 2]
    assert up[1] / up[2] == pytest.approx(side * 2.5 / G)
    assert (body[2, 1] < 0.0) == (side > 0.0)  # left wing down in a left turn


def test_hovering_in_wind_leans_against_it() -> None:
    up = attitude_of([0.0, 0.0, 0.0], [0.0, 0.0, 0.0], 0.3, wind=[6.0, 0.0, 0.0])[:, 2]
    assert up[0] / up[2] == pytest.approx(-DRAG_PER_S * 6.0 / G)


def motion_of(route: np.ndarray, wind: Wind = WINDY, speed: float = 12.0) -> Motion:
    motion = pilot(Route(route, speed, 0.0), wind, QuadrotorLimits(), 25.0, stream(3, "gusts"))
    assert motion is not None
    return motion


def test_body_rates_are_those_of_the_turning_matrices() -> None:
    motion = motion_of(bend())
    t, h = np.linspace(motion.position.start + 0.1, motion.position.end - 0.1, 300), 1e-4
    before, now, after = (motion.attitude(t + d).world_from_body for d in (-h, 0.0, h))
    turning = np.einsum("nji,njk->nik", now, (after - before) / (2 * h))
    rates = np.stack([turning[:, 2, 1], turning[:, 0, 2], turning[:, 1, 0]], axis=1)
    np.testing.assert_allclose(motion.attitude(t).rates_radps, rates, atol=2e-6)


# --- inertial unit -------------------------------------------------------------------------------------------------


def test_integrating_the_ideal_samples_leads_to_the_end_of_the_flight() -> None:
    """Strapdown integration as a user writes it: nothing but start, samples and gravity."""
    motion = motion_of(bend())
    start, end = motion.position.start, motion.position.end - 0.05
    samples = feel(motion, start, (0.0, end - start), ImuKnobs(), stream(1, "imu"))
    dt = 1.0 / RATE_HZ
    np.testing.assert_allclose(np.diff(samples.time_s), dt, atol=1e-12)
    first = np.array([start])
    turn = motion.attitude(first).world_from_body[0]
    place, velocity = motion.position.at(first)[0], motion.position.at(first, 1)[0]
    forces, rates = samples.force_mps2, samples.rates_radps
    for k in range(len(samples.time_s) - 1):
        later = turn @ rotations(0.5 * (rates[k] + rates[k + 1])[None] * dt)[0]
        pull = 0.5 * (turn @ forces[k] + later @ forces[k + 1]) - [0.0, 0.0, G]
        place = place + velocity * dt + 0.5 * pull * dt**2
        velocity, turn = velocity + pull * dt, later
    last = np.array([start + samples.time_s[-1]])
    assert np.linalg.norm(place - motion.position.at(last)[0]) < 0.02
    np.testing.assert_allclose(turn, motion.attitude(last).world_from_body[0], atol=1e-3)


def test_samples_between_frames_leave_none_out_and_repeat_none() -> None:
    motion = motion_of(bend())
    samples = feel(motion, motion.position.start, (0.0, 3.0), ImuKnobs(), stream(1))
    cuts = np.array([0.0, 0.3, 0.355, 1.2, 2.0, 3.0])
    tables = [samples.between(a, b) for a, b in pairwise(cuts)]
    joined = np.concatenate(tables)
    assert joined.shape == (600, 7)
    np.testing.assert_array_equal(joined[:, 0], np.arange(600) / RATE_HZ)
    for table, (begin, end) in zip(tables, pairwise(cuts), strict=True):
        assert ((table[:, 0] >= begin) & (table[:, 0] < end)).all()


def test_noise_has_the_density_and_the_walk_that_were_asked_for() -> None:
    hover = np.tile([0.0, 0.0, 5.0], (2006, 1))
    still = UniformSpline(0.0, 0.05, np.zeros((2006, 3)))
    motion = Motion(
        UniformSpline(0.0, 0.05, hover), FlatLeaning(UniformSpline(0.0, 0.05, np.zeros((2006, 1))), still)
    )
    knobs = ImuKnobs(noise=True, force_walk=0.05, rate_walk=0.002)
    samples = feel(motion, 0.0, (0.0, 100.0), knobs, stream(4, "noise"))
    np.testing.assert_allclose(samples.force_mps2, np.tile([0.0, 0.0, G], (20_000, 1)), atol=1e-12)
    assert samples.measured is not None
    error = samples.measured - np.concatenate([samples.force_mps2, samples.rates_radps], axis=1)
    steps = np.diff(error, axis=0).std(axis=0)  # sqrt(2) times the white noise, the walk being far smaller
    white = np.repeat([knobs.force_noise, knobs.rate_noise], 3) * np.sqrt(RATE_HZ)
    np.testing.assert_allclose(steps, np.sqrt(2.0) * white, rtol=0.05)
    means = error[:19_800].reshape(99, 200, 6).mean(axis=1)  # of a second each
    walk = np.diff(means, axis=0)
    spread = (
        np.repeat([0.05, 0.002], 3) ** 2 * 2 / 3 + 2 * white**2 / 200
    )  # variance of averaged walk, and of white
    np.testing.assert_allclose(walk.std(axis=0), np.sqrt(spread), rtol=0.25)
    assert samples.between(0.0, 1.0).shape == (200, 13)


# --- wind ----------------------------------------------------------------------------------------------------------


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


# --- pace and nose -------------------------------------------------------------------------------------------------


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


# --- mount ---------------------------------------------------------------------------------------------------------


@pytest.mark.parametrize("pitch", [-90.0, -30.0, 0.0, 20.0])
def test_the_mount_looks_ahead_and_down_by_its_angle(pitch: float) -> None:
    mount = body_from_camera(pitch)
    np.testing.assert_allclose(mount.T @ mount, np.eye(3), atol=1e-12)
    assert np.linalg.det(mount) == pytest.approx(1.0)
    assert np.degrees(np.arcsin(mount[2, 2])) == pytest.approx(pitch)
    np.testing.assert_allclose(mount[:, 0], [0.0, -1.0, 0.0], atol=1e-12)  # camera right is the right wing


def test_vibration_is_small_seeded_and_of_rotor_frequency() -> None:
    shake = Vibration.draw(2.0, stream(5, "v"))
    t = np.arange(0.0, 4.0, 1e-3)
    turned = shake.at(t)
    angle = np.stack([turned[:, 2, 1], turned[:, 0, 2], turned[:, 1, 0]], axis=1)
    np.testing.assert_allclose(1e3 * angle.std(axis=0), 2.0, rtol=0.05)
    power = np.abs(np.fft.rfft(angle, axis=0)) ** 2
    frequency = np.fft.rfftfreq(len(t), 1e-3)
    assert power[(frequency > 39.0) & (frequency < 181.0)].sum() > 0.99 * power.sum()
    np.testing.assert_array_equal(Vibration.draw(2.0, stream(5, "v")).at(t), turned)
