"""Integers, poses and gains against closed forms."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from scipy.spatial.transform import Rotation

from scenegen_datasets.exports.gain import Gain
from scenegen_datasets.exports.integers import FAR, NEAR, depth_u16, flow_u16
from scenegen_datasets.exports.poses import (
    integer_centres,
    inverse,
    ned_pose,
    numbers,
    opengl_pose,
    quaternion_xyzw,
    relative_pose,
)


def test_depth_at_the_ends_of_sixteen_bits() -> None:
    metres = [0.001, 0.5 / 256 * 1.01, 1.0, 65535 / 256, 65535.4 / 256, 65535.6 / 256, 1e9, np.inf]
    values, misfits = depth_u16(np.array([metres], np.float32), 1 / 256)
    assert values.tolist() == [[0, 1, 256, 65535, 65535, 0, 0, 0]]
    assert misfits == {FAR: 2, NEAR: 1}


def test_sky_and_distance_may_have_values_of_their_own() -> None:
    values, misfits = depth_u16(np.array([[np.inf, 700.0, 3.0]], np.float32), 0.01, sky=65535, far=65534)
    assert values.tolist() == [[65535, 65534, 300]] and misfits[FAR] == 1


@settings(deadline=None, derandomize=True)
@given(st.floats(0.0625, 600.0, width=32), st.sampled_from([1 / 256, 0.01, 1 / 5000]))
def test_depth_is_wrong_by_half_a_step_at_most(metres: float, unit_m: float) -> None:
    value = int(depth_u16(np.array([[metres]], np.float32), unit_m)[0][0, 0])
    assert value == 0 or abs(value * unit_m - metres) <= unit_m / 2 * (1 + 1e-9)
    assert (value == 0) == (metres / unit_m > 65535.5)


def test_flow_at_the_ends_of_sixteen_bits() -> None:
    u = [-512.0, -512.1, 511.984375, 512.0, np.nan, 0.0]
    flow = np.stack([np.array([u]), np.zeros((1, 6))], axis=-1).astype(np.float32)
    values, kept, outside = flow_u16(flow)
    assert kept.tolist() == [[True, False, True, False, False, True]] and outside == 3
    assert values[0, :, 0].tolist() == [0, 0, 65535, 0, 0, 32768]
    assert values[0, 1].tolist() == [0, 0], "what is not valid is zero in both channels"


def test_flow_that_is_not_wanted_is_not_counted() -> None:
    flow = np.full((1, 2, 2), np.nan, np.float32)
    _, kept, outside = flow_u16(flow, np.array([[True, False]]))
    assert not kept.any() and outside == 1


def _level_camera_looking(east: float, north: float) -> np.ndarray:
    forward = np.array([east, north, 0.0])
    down = np.array([0.0, 0.0, -1.0])
    pose = np.eye(4)
    pose[:3, :3] = np.stack([np.cross(down, forward), down, forward], axis=1)
    pose[:3, 3] = (10.0, 20.0, 30.0)
    return pose


def test_a_level_camera_that_looks_north_is_the_unit_of_ned() -> None:
    pose = ned_pose(_level_camera_looking(0.0, 1.0))
    assert np.allclose(pose[:3, :3], np.eye(3)) and pose[:3, 3].tolist() == [20.0, 10.0, -30.0]


def test_a_camera_that_looks_east_has_yawed_by_a_right_angle() -> None:
    rotation = Rotation.from_matrix(ned_pose(_level_camera_looking(1.0, 0.0))[:3, :3])
    assert np.allclose(rotation.as_euler("ZYX", degrees=True), [90.0, 0.0, 0.0], atol=1e-9)


def test_opengl_looks_along_minus_z_with_y_up() -> None:
    pose = opengl_pose(_level_camera_looking(0.0, 1.0))
    assert np.allclose(pose[:3, :3] @ [0, 0, -1], [0, 1, 0]) and np.allclose(
        pose[:3, :3] @ [0, 1, 0], [0, 0, 1]
    )


def test_relative_pose_and_inverse() -> None:
    a, b = _level_camera_looking(0.0, 1.0), _level_camera_looking(0.6, 0.8)
    assert np.allclose(inverse(a) @ a, np.eye(4))
    assert np.allclose(a @ relative_pose(a, b), b) and np.allclose(relative_pose(a, a), np.eye(4))


@settings(deadline=None, derandomize=True, max_examples=25)
@given(st.integers(0, 10_000))
def test_quaternion_is_of_unit_length_with_positive_w(seed: int) -> None:
    pose = np.eye(4)
    pose[:3, :3] = Rotation.random(random_state=seed).as_matrix()
    quaternion = quaternion_xyzw(pose)
    assert quaternion[3] >= 0 and np.isclose(np.linalg.norm(quaternion), 1.0)
    assert np.allclose(Rotation.from_quat(quaternion).as_matrix(), pose[:3, :3])


def test_centre_of_the_first_pixel_becomes_zero() -> None:
    K = np.array([[320.0, 0, 320.0], [0, 320.0, 256.0], [0, 0, 1]])
    assert integer_centres(K)[:2, 2].tolist() == [319.5, 255.5] and K[0, 2] == 320.0


def test_numbers_read_back_exactly() -> None:
    values = np.array([1 / 3, -0.0, 1e-17, 2.0])
    assert [float(text) for text in numbers(values).split()] == [1 / 3, 0.0, 1e-17, 2.0]
    assert "-0.0" not in numbers(values)


@pytest.mark.parametrize(
    ("count", "grey", "outside"), [(0, 0, 1), (100, 0, 0), (228, 128, 0), (16383, 255, 1)]
)
def test_gain_clips_and_counts(count: int, grey: int, outside: int) -> None:
    gain = Gain((np.arange(16384) - 100.0), {})  # one grey level per count from 100
    picture = np.full((2, 2), count, np.uint16)
    assert (gain.grey(picture) == grey).all() and gain.clipped(picture) == 4 * outside
