"""How a quadrotor leans and looks, and what its inertial unit feels: closed forms and independent integration."""

from __future__ import annotations

from itertools import pairwise

import numpy as np
import pytest

from routes import bend, motion_of
from scenegen.foundation.rng import stream
from scenegen_flythrough.quadrotor.attitude import DRAG_PER_S, flat_attitude, thrust_mps2
from scenegen_flythrough.quadrotor.imu import RATE_HZ, ImuKnobs, feel
from scenegen_flythrough.quadrotor.limits import GRAVITY_MPS2 as G
from scenegen_flythrough.quadrotor.motion import FlatLeaning, Motion
from scenegen_flythrough.quadrotor.mount import Vibration, body_from_camera, rotations
from scenegen_flythrough.quadrotor.spline import UniformSpline


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


def test_body_rates_are_those_of_the_turning_matrices() -> None:
    motion = motion_of(bend())
    t, h = np.linspace(motion.position.start + 0.1, motion.position.end - 0.1, 300), 1e-4
    before, now, after = (motion.attitude(t + d).world_from_body for d in (-h, 0.0, h))
    turning = np.einsum("nji,njk->nik", now, (after - before) / (2 * h))
    rates = np.stack([turning[:, 2, 1], turning[:, 0, 2], turning[:, 1, 0]], axis=1)
    np.testing.assert_allclose(motion.attitude(t).rates_radps, rates, atol=2e-6)


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
