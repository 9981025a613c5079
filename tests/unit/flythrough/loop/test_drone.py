"""What a command does to a drone, and what gusts are."""

from __future__ import annotations

import math

import numpy as np
import pytest

from scenegen_flythrough.loop.drone import DroneState, advance, camera_poses
from scenegen_flythrough.loop.knobs import DroneLimits, WindKnobs
from scenegen_flythrough.loop.pilot import Command
from scenegen_flythrough.loop.wind import Gusts
from scenegen_flythrough.quadrotor.limits import GRAVITY_MPS2

DT = 0.05


def test_limits_hold_under_wild_commands_in_a_storm():
    """A thousand drones, new commands every second or so, gusts of several metres a second."""
    count, limits = 1000, DroneLimits(speed_mps=9.0, acceleration_mps2=5.0, jerk_mps3=40.0, yaw_rate_dps=90.0)
    rng = np.random.default_rng(3)
    gusts = Gusts.draw(WindKnobs(mean_mps=15.0, turbulence=0.3), rng.spawn(count))
    state = DroneState.resting(np.zeros((count, 3)), np.zeros(count))
    fastest = strongest = jerk = turning = 0.0
    for k in range(120):
        if k % 24 == 0:
            command = Command(rng.normal(0.0, 12.0, (count, 3)), rng.uniform(-9.0, 9.0, count))
        new = advance(state, command, limits, gusts.at(state.time_s), DT)
        moved = (new.velocity_mps - state.velocity_mps) / DT
        np.testing.assert_allclose(moved, new.acceleration_mps2, atol=1e-9)
        np.testing.assert_allclose(
            new.position_m - state.position_m, 0.5 * (new.velocity_mps + state.velocity_mps) * DT, atol=1e-12
        )
        speed = np.linalg.norm(new.velocity_mps, axis=1)
        fastest = max(fastest, speed.max())
        strongest = max(strongest, np.linalg.norm(moved, axis=1).max())
        change = np.linalg.norm(new.acceleration_mps2 - state.acceleration_mps2, axis=1) / DT
        jerk = max(jerk, change[speed < 8.99].max())
        turning = max(turning, np.abs(new.yaw_rad - state.yaw_rad).max() / DT)
        state = new
    assert 8.9 < fastest <= 9.0 + 1e-9
    assert 4.9 < strongest <= 5.0 + 1e-9
    assert 39.0 < jerk <= 40.0 + 1e-6
    assert math.radians(89.0) < turning <= math.radians(90.0) + 1e-9


def test_a_steady_command_is_reached_without_overshoot_that_matters():
    state = DroneState.resting(np.zeros((1, 3)), np.zeros(1))
    command = Command(np.array([[6.0, 0.0, 0.0]]), np.array([2.0]))
    speeds = []
    for _ in range(100):
        state = advance(state, command, DroneLimits(), np.zeros((1, 3)), DT)
        speeds.append(float(state.velocity_mps[0, 0]))
    assert speeds[-1] == pytest.approx(6.0, abs=1e-3)
    assert max(speeds) < 6.3
    assert state.yaw_rad[0] == pytest.approx(2.0, abs=1e-3)


def test_the_nose_turns_the_short_way_round():
    state = DroneState.resting(np.zeros((1, 3)), np.array([3.0]))
    new = advance(state, Command(np.zeros((1, 3)), np.array([-3.0])), DroneLimits(), np.zeros((1, 3)), DT)
    assert new.yaw_rad[0] > 3.0


def test_gusts_have_the_variance_and_the_memory_they_are_meant_to_have():
    gusts = Gusts.draw(WindKnobs(mean_mps=10.0, turbulence=0.2), np.random.default_rng(1).spawn(400))
    times = np.arange(0.0, 60.0, 0.5)
    w = np.stack([gusts.at(float(t)) for t in times])  # times, flights, axes
    assert w.std() == pytest.approx(2.0, rel=0.05)
    assert abs(w.mean()) < 0.1
    later = (w[:-10] * w[10:]).mean() / w.var()  # after the correlation time of five seconds: 1/e
    assert later == pytest.approx(math.exp(-1.0), abs=0.06)
    np.testing.assert_allclose(np.linalg.norm(gusts.mean_mps, axis=1), 10.0)
    assert Gusts.draw(WindKnobs(mean_mps=0.0), np.random.default_rng(1).spawn(2)).at(3.0).any() == False  # noqa: E712


def test_a_gust_pushes_the_drone_and_the_autopilot_brings_it_back():
    state = DroneState.resting(np.zeros((1, 3)), np.zeros(1))
    hover = Command(np.zeros((1, 3)), np.zeros(1))
    for k in range(60):
        gust = np.array([[4.0 if k < 20 else 0.0, 0.0, 0.0]])
        state = advance(state, hover, DroneLimits(), gust, DT)
        if k == 19:
            pushed = state.velocity_mps[0, 0]
    assert pushed > 0.1
    assert abs(state.velocity_mps[0, 0]) < 0.02


@pytest.mark.parametrize("pitch_deg", [0.0, -20.0])
def test_a_stabilised_camera_looks_where_it_is_mounted(pitch_deg):
    state = DroneState.resting(np.array([[1.0, 2.0, 3.0]]), np.array([0.5]))
    pose = camera_poses(state, pitch_deg, stabilised=True)[0]
    rise = math.radians(pitch_deg)
    ahead = [math.cos(0.5) * math.cos(rise), math.sin(0.5) * math.cos(rise), math.sin(rise)]
    np.testing.assert_allclose(pose[:3, 2], ahead, atol=1e-12)
    np.testing.assert_allclose(pose[:3, :3] @ pose[:3, :3].T, np.eye(3), atol=1e-12)
    assert np.linalg.det(pose[:3, :3]) == pytest.approx(1.0)
    assert pose[2, 0] == pytest.approx(0.0, abs=1e-12)  # the horizon is level
    np.testing.assert_allclose(pose[:3, 3], [1.0, 2.0, 3.0])


def test_a_fixed_camera_tilts_with_the_thrust():
    still = DroneState.resting(np.zeros((1, 3)), np.zeros(1))
    speeding = DroneState(
        still.position_m, still.velocity_mps, np.array([[GRAVITY_MPS2, 0.0, 0.0]]), still.yaw_rad, 0.0
    )
    pose = camera_poses(speeding, 0.0, stabilised=False)[0]
    assert math.degrees(math.asin(pose[2, 2])) == pytest.approx(-45.0)
