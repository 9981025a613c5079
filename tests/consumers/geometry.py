"""Rotations and cameras as consumers compute them; written out, so that they check what the exporter calls."""

from __future__ import annotations

import numpy as np


def quaternion_pose(place: np.ndarray, xyzw: np.ndarray) -> np.ndarray:
    """Pose from a place and a unit quaternion (x, y, z, w), by the textbook formula."""
    x, y, z, w = np.asarray(xyzw, float) / np.linalg.norm(xyzw)
    pose = np.eye(4)
    pose[:3, :3] = [
        [1 - 2 * (y * y + z * z), 2 * (x * y - z * w), 2 * (x * z + y * w)],
        [2 * (x * y + z * w), 1 - 2 * (x * x + z * z), 2 * (y * z - x * w)],
        [2 * (x * z - y * w), 2 * (y * z + x * w), 1 - 2 * (x * x + y * y)],
    ]
    pose[:3, 3] = place
    return pose


def moved(K: np.ndarray, by_px: float) -> np.ndarray:
    """Intrinsics with the principal point moved: from integer pixel centres to ours by half a pixel."""
    K = np.array(K, float)
    K[:2, 2] += by_px
    return K
