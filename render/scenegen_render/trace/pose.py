"""Camera poses as kernel arguments: opaque, so that a new pose never compiles a new kernel."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np
from jaxtyping import Float64

from scenegen_render import backend

Pose = Float64[np.ndarray, "4 4"]


@dataclass(frozen=True, eq=False)
class DevicePose:
    """One rigid transform on the device, ``y = rotation x + translation``.

    Attributes
    ----------
    column : tuple of three mitsuba vectors
        Columns of the rotation.
    translation : mitsuba vector
    """

    column: tuple[Any, Any, Any]
    translation: Any

    def turn(self, x: Any, y: Any, z: Any) -> Any:
        """Rotate a direction given by its three components."""
        _, dr = backend.modules()
        a, b, c = self.column
        return dr.fma(a, x, dr.fma(b, y, c * z))


def device_pose(matrix: Pose, double: bool = False) -> DevicePose:
    """Upload a 4x4 transform, in float32 or float64."""
    mi, dr = backend.modules()
    scalar, vector = (mi.Float64, mi.Vector3d) if double else (mi.Float, mi.Vector3f)
    columns = [vector(*(dr.opaque(scalar, float(matrix[row, k])) for row in range(3))) for k in range(4)]
    return DevicePose((columns[0], columns[1], columns[2]), columns[3])


@dataclass(frozen=True, eq=False)
class Fleet:
    """Poses of several cameras on the device, to be looked up lane by lane.

    Attributes
    ----------
    rows : mitsuba.Float64, 12 per view
        Upper three rows of `world_from_camera`.
    count : int
    """

    rows: Any
    count: int

    @staticmethod
    def of(poses: Float64[np.ndarray, "views 4 4"]) -> Fleet:
        """Upload poses, at least one."""
        mi, dr = backend.modules()
        rows = np.ascontiguousarray(poses[:, :3], np.float64).reshape(-1)
        return Fleet(dr.opaque(mi.Float64(rows)), len(poses))

    def pose(self, view: Any, double: bool = False) -> DevicePose:
        """The pose of each lane's view, in float32 or float64; the same numbers as `device_pose`."""
        mi, dr = backend.modules()
        vector = mi.Vector3d if double else mi.Vector3f
        x, y, z = (dr.gather(mi.Vector4d, self.rows, view * 3 + k) for k in range(3))
        columns = [vector(x[k], y[k], z[k]) for k in range(4)]
        return DevicePose((columns[0], columns[1], columns[2]), columns[3])


def relative(other: Pose, pose: Pose) -> Pose:
    """Transform from the camera frame of `pose` to that of `other`, in float64."""
    rotation = other[:3, :3].T
    result = np.eye(4)
    result[:3, :3] = rotation @ pose[:3, :3]
    result[:3, 3] = rotation @ (pose[:3, 3] - other[:3, 3])
    return result
