"""The pinhole camera: intrinsics on a pixel grid, and the band it is sensitive in."""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np
from jaxtyping import Float64


@dataclass(frozen=True)
class Camera:
    """Pinhole camera in the OpenCV frame (x right, y down, z forward); pixel (0, 0) has its centre at (0.5, 0.5).

    Attributes
    ----------
    width_px, height_px : int
    focal_px : float
        Square pixels: fx = fy [px].
    centre_px : (float, float)
        Principal point cx, cy [px].
    band_um : (float, float)
        Spectral band [um].
    """

    width_px: int
    height_px: int
    focal_px: float
    centre_px: tuple[float, float]
    band_um: tuple[float, float] = (8.0, 14.0)

    @classmethod
    def from_fov(
        cls, width_px: int, height_px: int, hfov_deg: float, band_um: tuple[float, float] = (8.0, 14.0)
    ) -> Camera:
        """Camera with a horizontal field of view [deg] and the principal point in the middle."""
        focal = 0.5 * width_px / math.tan(math.radians(hfov_deg) / 2)
        return cls(width_px, height_px, focal, (width_px / 2, height_px / 2), band_um)

    @property
    def matrix(self) -> Float64[np.ndarray, "3 3"]:
        """Intrinsic matrix K."""
        cx, cy = self.centre_px
        return np.array([[self.focal_px, 0.0, cx], [0.0, self.focal_px, cy], [0.0, 0.0, 1.0]])
