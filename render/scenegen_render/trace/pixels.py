"""Where rays leave the camera: pixel centres, and a fixed rotated grid of sub-samples in every pixel."""

from __future__ import annotations

from typing import Any

import numpy as np
from jaxtyping import Float32, Float64, UInt32

from scenegen_render import backend
from scenegen_render.camera import Camera

_TILE_PX = 4
_GOLDEN = 0.6180339887498949
_RING_RADIUS = 0.425
"""Of the sub-samples around the centre [px]: least error of the covered share of a pixel behind straight edges."""


def subsample_pattern(count: int) -> Float64[np.ndarray, "count 2"]:
    """Places of the sub-samples in the unit pixel, the pixel centre first; the same in all pixels and frames.

    Up to eight: a rotated regular polygon around the centre. More: a count x count grid with one sample in each row
    and column (rows in the order of multiples of the golden ratio). Their mean is the pixel centre, so thermal image
    and labels never shift against each other, and the label ray is one of the sub-samples. Behind straight edges of
    all directions, four samples leave 9.5 % rms of the covered share (a rotated grid without the centre: 9.2 %).
    """
    around = count - 1
    if around == 1:
        raise ValueError("two sub-samples cannot both include the pixel centre and be centred on it")
    if count <= 8:
        angle = (np.arange(around) + 0.25) * 2.0 * np.pi / max(around, 1)
        others = 0.5 + _RING_RADIUS * np.stack([np.cos(angle), np.sin(angle)], axis=-1)
    else:
        order = np.argsort((np.arange(around) + 0.5) * _GOLDEN % 1.0, kind="stable")
        others = np.stack([np.arange(around), np.argsort(order, kind="stable")], axis=-1)
        others = (others + 0.5) / around
    return np.concatenate([[[0.5, 0.5]], others])


def tiled(camera: Camera) -> UInt32[np.ndarray, "pixels"]:
    """Row-major pixel indices in the order lanes take them: tiles of 4 x 4 pixels.

    Sixteen lanes make one packet of rays; a square of pixels is more coherent than a strip (occlusion rays: a third).
    """
    row, column = np.divmod(np.arange(camera.height_px * camera.width_px), camera.width_px)
    order = np.lexsort((column, row, column // _TILE_PX, row // _TILE_PX))
    return order.astype(np.uint32)


def image_plane(camera: Camera, pattern: Float64[np.ndarray, "count 2"]) -> Float32[np.ndarray, "rays 2"]:
    """Camera-frame ray directions (x, y) at z = 1 of all pixels, in tiles, the samples of a pixel side by side.

    With z = 1 and no normalisation, the distance along a ray *is* planar depth.
    """
    rows, columns = np.divmod(tiled(camera), camera.width_px)
    place = np.stack([columns, rows], axis=-1)[:, None, :] + pattern
    plane = (place - np.asarray(camera.centre_px)) / camera.focal_px
    return np.asarray(plane.reshape(-1, 2), np.float32)


def on_device(plane: Float32[np.ndarray, "rays 2"]) -> Any:
    """The same as a `mitsuba.Vector2f`, evaluated once per tracer."""
    mi, _ = backend.modules()
    return mi.Vector2f(backend.upload(plane[:, 0]), backend.upload(plane[:, 1]))


def repeated(lanes: Any, views: int) -> Any:
    """The same values for each of several views, one after the other; not evaluated."""
    mi, dr = backend.modules()
    width = dr.width(lanes)
    return dr.gather(type(lanes), lanes, dr.arange(mi.UInt, views * width) % width)


def place(tiled: Any, lane: Any) -> Any:
    """Row-major pixel of lanes that go tile by tile and view by view; pixels are counted on from view to view."""
    mi, dr = backend.modules()
    first = lane // dr.width(tiled) * dr.width(tiled)
    return dr.gather(mi.UInt, tiled, lane - first) + first
