"""Upright boxes in any number. Five faces each, since the underside is never seen."""

from __future__ import annotations

import numpy as np
from jaxtyping import Float64, Int64

from scenegen.geometry.part import Part
from scenegen.geometry.patch import patches


def boxes(
    centre: Float64[np.ndarray, "boxes 3"],
    size: Float64[np.ndarray, "boxes 3"],
    heading_rad: Float64[np.ndarray, "boxes"],
    surface: Int64[np.ndarray, "boxes"],
    semantic: Int64[np.ndarray, "boxes"],
    owner: Int64[np.ndarray, "boxes"],
    spacing_m: float = 4.0,
    top_surface: Int64[np.ndarray, "boxes"] | None = None,
    top_semantic: int | None = None,
) -> Part:
    """Boxes standing on their underside.

    Parameters
    ----------
    centre : float64 (boxes, 3)
        Middle of the underside [m].
    size : float64 (boxes, 3)
        Length, width, height [m].
    heading_rad : float64 (boxes,)
        Direction of the length, counter-clockwise from east.
    surface, semantic, owner : int64 (boxes,)
        Labels.
    spacing_m : float
        Largest distance between sites of a face [m].
    top_surface, top_semantic : int64 (boxes,), int; optional
        Labels of the upper side where they differ.
    """
    corners = box_corners(centre, size, heading_rad)
    sides = corners[:, [[0, 1, 5, 4], [1, 2, 6, 5], [2, 3, 7, 6], [3, 0, 4, 7], [4, 5, 6, 7]]]
    skin, label = np.repeat(surface, 5), np.repeat(semantic, 5)
    if top_surface is not None:
        skin[4::5] = top_surface
    if top_semantic is not None:
        label[4::5] = top_semantic
    return patches(sides.reshape(-1, 4, 3), spacing_m, skin, label, np.repeat(owner, 5))


def box_corners(
    centre: Float64[np.ndarray, "boxes 3"],
    size: Float64[np.ndarray, "boxes 3"],
    heading_rad: Float64[np.ndarray, "boxes"],
) -> Float64[np.ndarray, "boxes 8 3"]:
    """Corners: four below counter-clockwise from the rear right, four above."""
    unit = np.array([[-1, -1], [1, -1], [1, 1], [-1, 1]]) / 2
    local = unit[None] * size[:, None, :2]
    c, s = np.cos(heading_rad)[:, None], np.sin(heading_rad)[:, None]
    xy = np.stack([c * local[..., 0] - s * local[..., 1], s * local[..., 0] + c * local[..., 1]], axis=-1)
    xy = xy + centre[:, None, :2]
    low = np.concatenate([xy, np.broadcast_to(centre[:, None, 2:], (len(xy), 4, 1))], axis=2)
    high = low + np.array([0.0, 0.0, 1.0]) * size[:, None, 2:]
    return np.concatenate([low, high], axis=1)
