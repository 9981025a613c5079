"""The airframe leans as the forces ask: closed forms on straight, circling and climbing flights."""

from __future__ import annotations

import numpy as np
import pytest

from scenegen_flythrough.attitude import _DRAG_PER_S as DRAG
from scenegen_flythrough.attitude import _YAW_LAG_S as LAG
from scenegen_flythrough.attitude import camera_poses
from scenegen_flythrough.steering import GRAVITY_MPS2 as G


def straight(heading_deg: float, climb_deg: float = 0.0) -> np.ndarray:
    heading, climb = np.radians([heading_deg, climb_deg])
    direction = [np.cos(climb) * np.cos(heading), np.cos(climb) * np.sin(heading), np.sin(climb)]
    return np.arange(12.0)[:, None] * np.array(direction)


def look_deg(pose: np.ndarray) -> float:
    return float(np.degrees(np.arcsin(pose[2, 2])))


@pytest.mark.parametrize("heading", [0.0, 37.0, 90.0, 179.0, -120.0])
def test_level_flight_noses_down_against_the_drag(heading: float) -> None:
    pose = camera_poses(straight(heading), 8.0, 45.0, 0.0)[5]
    assert look_deg(pose) == pytest.approx(-np.degrees(np.arctan(DRAG * 8.0 / G)), abs=1e-9)
    assert np.degrees(np.arctan2(pose[1, 2], pose[0, 2])) == pytest.approx(heading, abs=1e-9)
    assert pose[2, 0] == pytest.approx(0.0, abs=1e-12)  # x, to the right, is level
    right = np.radians(heading - 90.0)
    np.testing.assert_allclose(pose[:3, 0], [np.cos(right), np.sin(right), 0.0], atol=1e-9)


def test_mount_angle_adds_to_the_nose() -> None:
    level = camera_poses(straight(10.0), 5.0, 45.0, 0.0)[5]
    down = camera_poses(straight(10.0), 5.0, 45.0, -25.0)[5]
    assert look_deg(down) - look_deg(level) == pytest.approx(-25.0, abs=1e-9)
    np.testing.assert_allclose(down[:3, 0], level[:3, 0], atol=1e-12)


def test_climbing_leans_by_the_whole_drag() -> None:
    """At 30 deg the drag pulls backwards and down: tan(tilt) = D v cos / (g + D v sin)."""
    pose = camera_poses(straight(0.0, 30.0), 8.0, 60.0, 0.0)[5]
    expected = np.arctan(DRAG * 8.0 * np.cos(np.pi / 6) / (G + DRAG * 8.0 * 0.5))
    assert look_deg(pose) == pytest.approx(-np.degrees(expected), abs=1e-9)


@pytest.mark.parametrize("side", [1.0, -1.0])
def test_turning_banks_into_the_turn(side: float) -> None:
    """A circle of 40 m at 10 m/s needs 2.5 m/s^2 towards its centre; the inner side goes down."""
    radius, speed = 40.0, 10.0
    angle = np.arange(400) * 0.005
    path = radius * np.stack([np.cos(angle), side * np.sin(angle), np.zeros_like(angle)], axis=1)
    pose = camera_poses(path, speed, 45.0, 0.0)[300]
    up = -pose[:3, 1]
    inward = -path[300] / radius
    sideways = speed**2 / radius
    assert up @ inward / up[2] == pytest.approx(sideways / G, rel=1e-3)
    assert (pose[2, 0] > 0) == (side > 0)  # turning left lifts the right wing
    lag = np.degrees(
        np.arctan2(*(pose[:2, 0] @ [[0, 1], [-1, 0]])[::-1]) - np.arctan2(*(path[301] - path[299])[1::-1])
    )
    assert abs((lag + 180) % 360 - 180) < np.degrees(speed / radius * LAG) + 3.0


def test_tilt_never_exceeds_its_limit() -> None:
    angle = np.arange(80) * 0.1
    path = 10.0 * np.stack([np.cos(angle), np.sin(angle), np.zeros_like(angle)], axis=1)
    tilt = np.degrees(np.arccos(-camera_poses(path, 20.0, 30.0, 0.0)[:, 2, 1]))
    np.testing.assert_allclose(tilt, 30.0, atol=1e-9)  # asks for 76 deg everywhere
