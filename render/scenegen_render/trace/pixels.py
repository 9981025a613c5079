"""Where rays leave the camera: pixel centres, and a fixed rotated grid of sub-samples in every pixel."""

from __future__ import annotations

from typing import Any

import numpy as np
from jaxtyping import Float32, Float64

from scenegen_render import backend
from scenegen_render.camera import Camera

_GOLDEN = 0.6180339887498949


def subsample_pattern(count: int) -> Float64[np.ndarray, "count 2"]:
    """Places of the sub-samples in the unit pixel: each row and each column of a count x count grid holds one.

    The order of rows follows multiples of the golden ratio, which for four samples is the rotated grid of graphics
    cards. The pattern is the same in all pixels and frames, so that nothing flickers, and its mean is the centre.
    """
    column = (np.arange(count) + 0.5) / count
    row = np.argsort(np.argsort((np.arange(count) + 0.5) * _GOLDEN % 1.0, kind="stable"), kind="stable")
    return np.stack([column, (row + 0.5) / count], axis=-1)


def image_plane(camera: Camera, pattern: Float64[np.ndarray, "count 2"]) -> Float32[np.ndarray, "rays 2"]:
    """Camera-frame ray directions (x, y) at z = 1 of all pixels, row by row, the samples of a pixel side by side.

    With z = 1 and no normalisation, the distance along a ray *is* planar depth.
    """
    rows, columns = np.mgrid[0 : camera.height_px, 0 : camera.width_px]
    place = np.stack([columns, rows], axis=-1).reshape(-1, 1, 2) + pattern
    plane = (place - np.asarray(camera.centre_px)) / camera.focal_px
    return np.asarray(plane.reshape(-1, 2), np.float32)


def on_device(plane: Float32[np.ndarray, "rays 2"]) -> Any:
    """The same as a `mitsuba.Vector2f`, evaluated once per tracer."""
    mi, dr = backend.modules()
    rays = mi.Vector2f(
        mi.Float(np.ascontiguousarray(plane[:, 0])), mi.Float(np.ascontiguousarray(plane[:, 1]))
    )
    dr.eval(rays)
    return rays
