"""One noise-free frame: what the tracer knows about every pixel."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from jaxtyping import Bool, Float32, UInt8, UInt16, UInt32


@dataclass(frozen=True, eq=False)
class Frame:
    """Truth of one instant. All layers share one pixel grid; labels come from the ray through the pixel centre.

    Attributes
    ----------
    radiance : float32 (rows, columns)
        Band radiance at the sensor, after the path [W m^-2 sr^-1].
    depth : float32 (rows, columns)
        Planar z [m]; +inf where the ray meets the sky.
    temperature : float32 (rows, columns)
        Kinetic surface temperature [K]; NaN never: sky carries 0.
    semantic : uint8 (rows, columns)
        `scenegen.classes.Semantic`.
    instance : uint32 (rows, columns)
        Object id; 0 for sky.
    material : uint16 (rows, columns)
        Material id; 0 for sky.
    flow : float32 (rows, columns, 2)
        Forward flow (u right, v down) to the next frame [px]; sky flows as a point at infinity.
    covisible : bool (rows, columns)
        The same point is inside the next frame and not occluded there.
    flow_back, covisible_back : as `flow` and `covisible`, towards the previous frame, or None if not asked for.
    normal : float32 (rows, columns, 3) or None
        Geometric surface normal facing the camera, in the camera frame; zero for sky.
    """

    radiance: Float32[np.ndarray, "rows columns"]
    depth: Float32[np.ndarray, "rows columns"]
    temperature: Float32[np.ndarray, "rows columns"]
    semantic: UInt8[np.ndarray, "rows columns"]
    instance: UInt32[np.ndarray, "rows columns"]
    material: UInt16[np.ndarray, "rows columns"]
    flow: Float32[np.ndarray, "rows columns 2"]
    covisible: Bool[np.ndarray, "rows columns"]
    flow_back: Float32[np.ndarray, "rows columns 2"] | None = None
    covisible_back: Bool[np.ndarray, "rows columns"] | None = None
    normal: Float32[np.ndarray, "rows columns 3"] | None = None
