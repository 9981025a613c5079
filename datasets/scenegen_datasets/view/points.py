"""A frame in space: its pixels carried back along their rays, the flight, and where the camera looks."""

from __future__ import annotations

import numpy as np
from jaxtyping import Float64, UInt8

from scenegen_datasets.view.library import Still

MAX_POINTS = 12_000
"""A page in a browser stays fluent with these."""


def back_projected(
    still: Still, picture: UInt8[np.ndarray, "rows columns 3"], reach_m: float, most: int = MAX_POINTS
) -> tuple[Float64[np.ndarray, "points 3"], UInt8[np.ndarray, "points 3"]]:
    """World points [m] of an even grid of pixels nearer than `reach_m`, and their colours.

    Notes
    -----
    Depth is planar z of the surface through the pixel's centre, so the camera point is
    ``depth * K^-1 (column + 0.5, row + 0.5, 1)``.
    """
    depth = still.layers["depth"]
    rows, columns = depth.shape
    step = max(1, int(np.ceil(np.sqrt(rows * columns / most))))
    v, u = np.mgrid[step // 2 : rows : step, step // 2 : columns : step]
    near = depth[v, u] < reach_m  # +inf, the sky, is not
    u, v = u[near], v[near]
    rays = np.linalg.solve(still.K, np.stack([u + 0.5, v + 0.5, np.ones(u.shape)]))
    places = still.world_from_camera[:3, :3] @ (rays * depth[v, u]) + still.world_from_camera[:3, 3:]
    return places.T.astype(np.float64), picture[v, u]


def frustum(still: Still, length_m: float) -> Float64[np.ndarray, "5 3"]:
    """The camera's place and the four corners of what it sees at a distance, in world metres."""
    rows, columns = still.counts.shape
    corners = np.array([[0, columns, columns, 0], [0, 0, rows, rows], [1, 1, 1, 1]], np.float64)
    seen = np.linalg.solve(still.K, corners) * length_m
    eye = still.world_from_camera[:3, 3]
    return np.vstack([eye, (still.world_from_camera[:3, :3] @ seen).T + eye])


def edges(
    corners: Float64[np.ndarray, "5 3"],
) -> list[tuple[Float64[np.ndarray, "3"], Float64[np.ndarray, "3"]]]:
    """Lines of a frustum: four rays, the picture's rim, and a roof above its upper edge."""
    eye, left, right = corners[0], corners[1], corners[2]
    down = corners[4] - corners[1]
    ridge = (left + right) / 2.0 - 0.25 * down
    rim = [(corners[1 + k], corners[1 + (k + 1) % 4]) for k in range(4)]
    return [*((eye, corner) for corner in corners[1:]), *rim, (left, ridge), (ridge, right)]


def linear(colours: UInt8[np.ndarray, "points 3"]) -> Float64[np.ndarray, "points 3"]:
    """Colours of a picture (sRGB, IEC 61966-2-1) as the shares of light that a renderer of scenes reckons in."""
    shares = colours.astype(np.float64) / 255.0
    return np.where(shares <= 0.04045, shares / 12.92, ((shares + 0.055) / 1.055) ** 2.4)
