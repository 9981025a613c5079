"""A flown path as data."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from jaxtyping import Float64


@dataclass(frozen=True, eq=False)
class Trajectory:
    """Camera poses of one clip, one more at both ends than frames are stored, so that every frame has full flow.

    Attributes
    ----------
    world_from_camera : float64 (poses, 4, 4)
        OpenCV camera (x right, y down, z forward) to ENU world [m]. Pose k belongs to stored frame k - 1.
    time_s : float64 (poses,)
        Zero at the first stored frame (pose 1).
    speed_mps : float
        Constant speed along the path.
    clearance_m : float
        Smallest distance of the path, straight from pose to pose, to the mesh [m]; exact, not sampled.
    rejected : int
        Draws that were rejected before this one.
    """

    world_from_camera: Float64[np.ndarray, "poses 4 4"]
    time_s: Float64[np.ndarray, "poses"]
    speed_mps: float
    clearance_m: float
    rejected: int
