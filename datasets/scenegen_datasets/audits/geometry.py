"""Where pixels go: the pinhole of `docs/conventions.md`, and reading an image between its pixels."""

from __future__ import annotations

from dataclasses import dataclass

import cv2
import numpy as np
from jaxtyping import Bool, Float, Float32, Float64

from scenegen_datasets.audits.steps import Still


@dataclass(frozen=True, eq=False)
class Landing:
    """Where the pixels of one frame stand in another, if nothing moved but the camera.

    Attributes
    ----------
    flow : float64 (rows, columns, 2)
        [px]; sky as a point at infinity; NaN behind the camera.
    depth : float64 (rows, columns)
        z in the other camera [m]; +inf for sky.
    """

    flow: Float64[np.ndarray, "rows columns 2"]
    depth: Float64[np.ndarray, "rows columns"]


def centres(shape: tuple[int, int]) -> Float64[np.ndarray, "rows columns 2"]:
    """Pixel centres (u, v)."""
    v, u = np.mgrid[0 : shape[0], 0 : shape[1]]
    return np.stack([u + 0.5, v + 0.5], axis=-1)


def rays(K: Float64[np.ndarray, "3 3"], shape: tuple[int, int]) -> Float64[np.ndarray, "rows columns 3"]:
    """Camera points of the pixel centres at z = 1."""
    uv = centres(shape)
    x = (uv[..., 0] - K[0, 2]) / K[0, 0]
    y = (uv[..., 1] - K[1, 2]) / K[1, 1]
    return np.stack([x, y, np.ones_like(x)], axis=-1)


def landing(now: Still, next: Still, K: Float64[np.ndarray, "3 3"]) -> Landing:
    """Carry every pixel of a frame into the next by its depth and both poses."""
    next_from_now = np.linalg.inv(next.world_from_camera) @ now.world_from_camera
    direction = rays(K, now.depth.shape)
    solid = np.isfinite(now.depth)
    z = np.where(solid, now.depth, 1.0).astype(np.float64)
    moved = (z[..., None] * direction) @ next_from_now[:3, :3].T + np.where(
        solid[..., None], next_from_now[:3, 3], 0.0
    )
    ahead = moved[..., 2] > 1e-6
    depth = np.where(ahead, moved[..., 2], np.nan)
    uv = moved[..., :2] / depth[..., None] * [K[0, 0], K[1, 1]] + K[:2, 2]
    return Landing(uv - centres(now.depth.shape), np.where(solid, depth, np.inf))


def between(
    image: Float32[np.ndarray, "rows columns *channels"], place: Float[np.ndarray, "rows columns 2"]
) -> Float32[np.ndarray, "rows columns *channels"]:
    """Read an image bilinearly at places (u, v); NaN outside the outermost pixel centres.

    Written out because `cv2.remap` rounds places to 1/32 px, which is more than what is to be measured.
    """
    rows, columns = image.shape[:2]
    u, v = np.asarray(place[..., 0] - 0.5, np.float64), np.asarray(place[..., 1] - 0.5, np.float64)
    inside = (u >= 0.0) & (u <= columns - 1.0) & (v >= 0.0) & (v <= rows - 1.0)
    u, v = np.where(inside, u, 0.0), np.where(inside, v, 0.0)
    left, above = (
        np.minimum(np.floor(x), most).astype(np.int64) for x, most in ((u, columns - 2), (v, rows - 2))
    )
    extra = (...,) + (None,) * (image.ndim - 2)
    right, down = (u - left)[extra].astype(np.float32), (v - above)[extra].astype(np.float32)
    upper = (1 - right) * image[above, left] + right * image[above, left + 1]
    lower = (1 - right) * image[above + 1, left] + right * image[above + 1, left + 1]
    found = (1 - down) * upper + down * lower
    found[~inside] = np.nan
    return np.asarray(found, np.float32)


def even_ground(
    depth: Float32[np.ndarray, "rows columns"], ratio: float = 1.02
) -> Bool[np.ndarray, "rows columns"]:
    """Pixels whose eight neighbours show one surface: solid, and their depths within a ratio."""
    kernel = np.ones((3, 3), np.uint8)
    known = np.where(np.isfinite(depth), depth, np.float32(1e30))
    return np.asarray(cv2.dilate(known, kernel) < ratio * cv2.erode(known, kernel))


def height_above_ground_m(
    still: Still, K: Float64[np.ndarray, "3 3"], ground: Bool[np.ndarray, "rows columns"], reach_m: float
) -> float | None:
    """Height of the camera above the ground it sees within a horizontal distance; None if it sees too little."""
    rotation = still.world_from_camera[:3, :3]
    points = (
        still.depth[ground].astype(np.float64)[:, None] * rays(K, still.depth.shape)[ground]
    ) @ rotation.T
    near = np.hypot(points[:, 0], points[:, 1]) < reach_m
    return float(-np.median(points[near, 2])) if np.count_nonzero(near) >= 20 else None
