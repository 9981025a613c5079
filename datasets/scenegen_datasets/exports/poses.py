"""Poses and cameras in the conventions of others. Ours stand in ``docs/conventions.md``: ENU world, OpenCV camera."""

from __future__ import annotations

import numpy as np
from jaxtyping import Float64

Pose = Float64[np.ndarray, "4 4"]
Camera = Float64[np.ndarray, "3 3"]
Vector = Float64[np.ndarray, "3"]
Quaternion = Float64[np.ndarray, "4"]

NED_FROM_ENU = np.array([[0.0, 1.0, 0.0], [1.0, 0.0, 0.0], [0.0, 0.0, -1.0]])
"""North is our y, east our x, down our -z."""

CAMERA_FROM_BODY = np.array([[0.0, 1.0, 0.0], [0.0, 0.0, 1.0], [1.0, 0.0, 0.0]])
"""A body's x forward, y right, z down in an OpenCV camera: z, x, y."""

_OPENGL_CAMERA = np.diag([1.0, -1.0, -1.0, 1.0])


def opengl_pose(world_from_camera: Pose) -> Pose:
    """World from an OpenGL camera: x right, y up, looking along -z. The world stays ENU."""
    return np.asarray(world_from_camera @ _OPENGL_CAMERA)


def ned_pose(world_from_camera: Pose) -> Pose:
    """NED world from a camera whose x looks forward, y right, z down, as AirSim and TartanAir have it."""
    pose = np.eye(4)
    pose[:3, :3] = NED_FROM_ENU @ world_from_camera[:3, :3] @ CAMERA_FROM_BODY
    pose[:3, 3] = NED_FROM_ENU @ world_from_camera[:3, 3]
    return pose


def relative_pose(first: Pose, pose: Pose) -> Pose:
    """Pose of a camera in the frame of the first one."""
    return np.asarray(inverse(first) @ pose)


def inverse(pose: Pose) -> Pose:
    """Inverse of a rigid pose, without a general inversion."""
    back = np.eye(4)
    back[:3, :3] = pose[:3, :3].T
    back[:3, 3] = -pose[:3, :3].T @ pose[:3, 3]
    return back


def quaternion_xyzw(pose: Pose) -> Quaternion:
    """Unit quaternion (x, y, z, w) of a pose's rotation, Hamilton's convention, w not negative."""
    from scipy.spatial.transform import Rotation

    quaternion = np.asarray(Rotation.from_matrix(pose[:3, :3]).as_quat(), np.float64)
    return -quaternion if quaternion[3] < 0 else quaternion


def integer_centres(K: Camera) -> Camera:
    """Intrinsics for readers that count the centre of the first pixel as (0, 0), as OpenCV's calibration does."""
    moved = K.copy()
    moved[:2, 2] -= 0.5
    return moved


def numbers(values: Float64[np.ndarray, "..."]) -> str:
    """Numbers separated by blanks, each as the shortest text that reads back to the same double."""
    return " ".join(repr(float(value) + 0.0) for value in np.ravel(values))
