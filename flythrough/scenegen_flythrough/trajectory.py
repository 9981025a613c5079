"""A flown path as data."""

from __future__ import annotations

from dataclasses import dataclass, field

import numpy as np
from jaxtyping import Float64

from scenegen_flythrough.quadrotor.imu import ImuSamples
from scenegen_flythrough.quadrotor.motion import Motion


@dataclass(frozen=True, eq=False)
class Trajectory:
    """Camera poses of one clip, one more at both ends than frames are stored, so that every frame has full flow.

    Attributes
    ----------
    world_from_camera : float64 (poses, 4, 4)
        OpenCV camera (x right, y down, z forward) to ENU world [m]. Pose k belongs to stored frame k - 1. Successive
        poses are equally far apart along the way.
    time_s : float64 (poses,)
        Zero at the first stored frame (pose 1); uneven, for speed is.
    speed_mps : float
        Mean speed along the way.
    clearance_m : float
        No part of the way comes closer to the mesh than this [m]: the exact distance of chords of at most a quarter of
        a metre, less how far the way can leave them.
    rejected : int
        Draws that were rejected before this one.
    style : str
        Kind of flight.
    velocity_mps : float64 (poses, 3)
        In the world.
    body_from_camera : float64 (3, 3)
        How the camera is mounted: its axes in the airframe's (nose, left, up), vibration aside.
    imu : ImuSamples
        From the first stored frame to the last pose, in clip time.
    wind_mps : (float, float)
        Steady wind, towards east and north.
    rejections : tuple of (str, int)
        Why draws were rejected, and how many of them for each reason.
    motion : Motion
        The flight itself, between frames too.
    zero_s : float
        Time of the motion at clip time zero.
    """

    world_from_camera: Float64[np.ndarray, "poses 4 4"]
    time_s: Float64[np.ndarray, "poses"]
    speed_mps: float
    clearance_m: float
    rejected: int
    style: str
    velocity_mps: Float64[np.ndarray, "poses 3"]
    body_from_camera: Float64[np.ndarray, "3 3"]
    imu: ImuSamples
    wind_mps: tuple[float, float]
    rejections: tuple[tuple[str, int], ...]
    motion: Motion = field(repr=False)
    zero_s: float

    def relative(self, to: int, of: int) -> Float64[np.ndarray, "4 4"]:
        """``to_from_of``: maps camera points of pose `of` to camera points of pose `to`."""
        seen, seeing = self.world_from_camera[of], self.world_from_camera[to]
        turn = seeing[:3, :3].T
        pose = np.eye(4)
        pose[:3, :3] = turn @ seen[:3, :3]
        pose[:3, 3] = turn @ (seen[:3, 3] - seeing[:3, 3])
        return pose
