"""Which movers appear in a clip: chosen once by its whole path, so that nothing ever pops up or vanishes."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from jaxtyping import Bool, Float64, Int64

from scenegen.movers.company import Company
from scenegen.movers.mover import Mover
from scenegen_render.camera import Camera

MAX_TRIANGLES = 10_000
"""Of all movers of a clip: their acceleration structure is rebuilt for every frame, 0.4 ms of CPU a thousand."""
_SMALLEST_PX = 0.7
"""Movers that never look larger than that are left out."""
_SURE_OF = 1.05
"""Allowance on the size of a mover: limbs that swing."""


def choose(
    movers: Sequence[Mover],
    camera: Camera,
    poses: Float64[np.ndarray, "poses 4 4"],
    times_s: Float64[np.ndarray, "poses"],
    max_triangles: int = MAX_TRIANGLES,
) -> tuple[int, ...]:
    """Indices of the movers that come into view, nearest first until their triangles are too many; increasing.

    Parameters
    ----------
    movers : sequence of Mover
    camera : Camera
    poses : float64 (poses, 4, 4)
        `world_from_camera` of all frames, and of those before and after that flow needs.
    times_s : float64 (poses,)
        World time of each pose.
    max_triangles : int

    Notes
    -----
    The distance of a mover is the least of all poses that see its bounding sphere. What stays out of view is left
    out; it could only have shown in a mirror.
    """
    if not len(movers):
        return ()
    radius = np.array([_SURE_OF * 0.5 * np.linalg.norm(m.size_m) for m in movers])
    up = 0.5 * np.array([m.size_m[2] for m in movers])
    middle = Company.of(movers).places(times_s)[..., :3]
    middle[..., 2] += up
    relative = np.einsum("pni,pij->pnj", middle - poses[:, None, :3, 3], poses[:, :3, :3])
    distance = np.linalg.norm(relative, axis=-1)
    large = camera.focal_px * 2.0 * radius > _SMALLEST_PX * distance
    seen = _in_view(relative, radius, camera) & large
    nearest = np.where(seen, distance, np.inf).min(axis=0)
    order: Int64[np.ndarray, "movers"] = np.argsort(nearest, kind="stable")
    triangles = np.cumsum([len(movers[k].body.faces) for k in order])
    kept = order[np.isfinite(nearest[order]) & (triangles <= max_triangles)]
    return tuple(sorted(kept.tolist()))


def _in_view(
    relative: Float64[np.ndarray, "poses movers 3"], radius: Float64[np.ndarray, "movers"], camera: Camera
) -> Bool[np.ndarray, "poses movers"]:
    """Whether a sphere reaches into the pyramid of view."""
    (cx, cy), f = camera.centre_px, camera.focal_px
    seen = relative[..., 2] > -radius
    for axis, low, high in ((0, cx, camera.width_px - cx), (1, cy, camera.height_px - cy)):
        for edge, side in ((low, -1.0), (high, 1.0)):
            outside = (side * relative[..., axis] * f - relative[..., 2] * edge) / np.hypot(f, edge)
            seen &= outside < radius
    return np.asarray(seen)
