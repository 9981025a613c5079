"""Planar depth by brute force in float64: slow, independent of the tracer, the oracle of its depth."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from jaxtyping import Float64

from scenegen.world import TriangleMesh
from scenegen_render.camera import Camera

SLACK = 2e-4
"""Barycentric margin of an edge inside which either neighbour may be hit: what float32 leaves of a ray at 300 m."""


@dataclass(frozen=True, eq=False)
class ReferenceDepth:
    """Depths between which a float32 ray may choose; equal except where an edge passes through the pixel centre.

    Attributes
    ----------
    near : float64 (rows, columns)
        Nearest hit [m] of triangles enlarged by `SLACK`; infinite for sky.
    far : float64 (rows, columns)
        Nearest hit of triangles shrunk by `SLACK`.
    """

    near: Float64[np.ndarray, "rows columns"]
    far: Float64[np.ndarray, "rows columns"]


def reference_depth(mesh: TriangleMesh, camera: Camera, pose: Float64[np.ndarray, "4 4"]) -> ReferenceDepth:
    """Meet every triangle with every ray of the image rectangle it can appear in.

    Moeller and Trumbore's test (doi:10.1080/10867651.1997.10487468) through pixel centres, all in float64 from the
    float32 vertices. About 50 us a triangle.

    Parameters
    ----------
    pose : float64 (4, 4)
        `world_from_camera`.
    """
    rows, columns = np.mgrid[0 : camera.height_px, 0 : camera.width_px] + 0.5
    plane = (np.stack([columns, rows], axis=-1) - camera.centre_px) / camera.focal_px
    rays = np.concatenate([plane, np.ones_like(plane[..., :1])], axis=-1)
    local = (mesh.vertices.astype(np.float64) - pose[:3, 3]) @ pose[:3, :3]
    found = ReferenceDepth(np.full(rows.shape, np.inf), np.full(rows.shape, np.inf))
    for corners in local[mesh.faces]:
        window = _window(corners, camera)
        if window is not None:
            _meet(corners, rays[window], found, window)
    return found


def _window(corners: Float64[np.ndarray, "3 3"], camera: Camera) -> tuple[slice, slice] | None:
    """Image rectangle in which a triangle (camera frame) can appear."""
    if (corners[:, 2] <= 0).all():
        return None
    if (corners[:, 2] < 1e-3).any():
        return slice(None), slice(None)
    place = corners[:, :2] / corners[:, 2:] * camera.focal_px + camera.centre_px
    low = np.maximum(np.floor(place.min(axis=0)).astype(int) - 1, 0)
    high = np.ceil(place.max(axis=0)).astype(int) + 1
    if (high < 0).any() or low[0] >= camera.width_px or low[1] >= camera.height_px:
        return None
    return slice(low[1], high[1] + 1), slice(low[0], high[0] + 1)


def _meet(
    corners: Float64[np.ndarray, "3 3"],
    rays: Float64[np.ndarray, "rows columns 3"],
    found: ReferenceDepth,
    window: tuple[slice, slice],
) -> None:
    """Lower the depths of a window to those of one triangle. The camera frame's origin is the camera."""
    a, along, up = corners[0], corners[1] - corners[0], corners[2] - corners[0]
    p, q = np.cross(rays, up), np.cross(-a, along)
    with np.errstate(divide="ignore", invalid="ignore"):
        scale = 1.0 / (p @ along)
        u, v, depth = -(p @ a) * scale, (rays @ q) * scale, (up @ q) * scale
        margin = np.minimum(np.minimum(u, v), 1.0 - u - v)
    for layer, least in ((found.near, -SLACK), (found.far, SLACK)):
        met = (margin >= least) & (depth > 0)
        layer[window] = np.where(met, np.minimum(layer[window], depth), layer[window])
