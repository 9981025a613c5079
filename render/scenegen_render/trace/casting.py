"""Which movers appear in a clip, and where in an image they can be.

The first is chosen once by the clip's whole path, so that nothing ever pops up or vanishes. In closed loop nobody knows
the path beforehand: there every instant has those that some camera sees.
"""

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
_NEAR_M = 0.1
"""What lies closer to the camera's plane is not looked for; flights keep further away."""
_MARGIN_PX = 1.5
"""Around a box: sub-samples lie half a pixel off the centre, and rounding must never cost a ray."""


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
    company = Company.of(movers)
    seen, distance = _sight(company, company.poses_over(times_s), camera, poses)
    nearest = np.where(seen, distance, np.inf).min(axis=0)
    order: Int64[np.ndarray, "movers"] = np.argsort(nearest, kind="stable")
    triangles = np.cumsum([len(movers[k].body.faces) for k in order])
    kept = order[np.isfinite(nearest[order]) & (triangles <= max_triangles)]
    return tuple(sorted(kept.tolist()))


def in_view(
    company: Company, time_s: float, camera: Camera, poses: Float64[np.ndarray, "views 4 4"]
) -> Bool[np.ndarray, "views movers"]:
    """Which movers come into which of several views at one time."""
    return _sight(company, company.poses(time_s)[None], camera, poses)[0]


def around(
    company: Company,
    time_s: float,
    camera: Camera,
    poses: Float64[np.ndarray, "views 4 4"],
    who: Int64[np.ndarray, "some"] | None = None,
) -> Bool[np.ndarray, "views rows columns"]:
    """Pixels whose rays can meet a mover at one time: rectangles around the projections of their boxes.

    Parameters
    ----------
    who : int64 (some,), optional
        Movers that count; by default all.
    """
    near = np.zeros((len(poses), camera.height_px, camera.width_px), bool)
    box, move = company.box, company.poses(time_s)
    if who is not None:
        box, move = box[who], move[who]
    if not len(box):
        return near
    corner = np.stack([box[:, pick, range(3)] for pick in _CORNERS], axis=1)
    world = np.einsum("nij,nkj->nki", move[:, :3, :3], corner) + move[:, None, :3, 3]
    local = np.stack([((world - pose[:3, 3]) @ pose[:3, :3]) for pose in poses])
    points, ahead = _before_the_camera(local.reshape(-1, 8, 3))
    place = points[..., :2] / points[..., 2:] * camera.focal_px + camera.centre_px
    seen = ahead[..., None]
    low = np.where(seen, place, np.inf).min(axis=1) - _MARGIN_PX
    high = np.where(seen, place, -np.inf).max(axis=1) + _MARGIN_PX
    size = np.array([camera.width_px, camera.height_px])
    first = np.clip(np.floor(low), 0, size).astype(np.int64)
    last = np.clip(np.ceil(high), 0, size).astype(np.int64)
    some = np.flatnonzero((first < last).all(axis=1))
    for view, (left, top), (right, bottom) in zip(
        (some // len(box)).tolist(), first[some].tolist(), last[some].tolist(), strict=True
    ):
        near[view, top:bottom, left:right] = True
    return near


_CORNERS = np.array([[k >> 2 & 1, k >> 1 & 1, k & 1] for k in range(8)])
_EDGES = np.array(
    [[a, b] for a in range(8) for b in range(a) if np.abs(_CORNERS[a] - _CORNERS[b]).sum() == 1]
)


def _before_the_camera(
    corner: Float64[np.ndarray, "movers 8 3"],
) -> tuple[Float64[np.ndarray, "movers 20 3"], Bool[np.ndarray, "movers 20"]]:
    """Corners of boxes, and where their edges cross the plane just before the camera; which of them exist."""
    a, b = corner[:, _EDGES[:, 0]], corner[:, _EDGES[:, 1]]
    rise = b[..., 2] - a[..., 2]
    share = (_NEAR_M - a[..., 2]) / np.where(rise == 0.0, 1.0, rise)
    crosses = (a[..., 2] < _NEAR_M) != (b[..., 2] < _NEAR_M)
    cut = a + share[..., None] * (b - a)
    cut[..., 2] = _NEAR_M
    ahead = np.concatenate([corner[..., 2] >= _NEAR_M, crosses], axis=1)
    points = np.concatenate([corner, cut], axis=1)
    points[..., 2] = np.where(ahead, points[..., 2], 1.0)
    return points, ahead


def _sight(
    company: Company,
    move: Float64[np.ndarray, "times movers 4 4"],
    camera: Camera,
    poses: Float64[np.ndarray, "poses 4 4"],
) -> tuple[Bool[np.ndarray, "poses movers"], Float64[np.ndarray, "poses movers"]]:
    """Whether poses see the bounding spheres of movers, large enough to count, and how far they are [m].

    Movers stand where they are at each pose's time, or all at one.
    """
    middle = move[..., :3, 3].copy()
    middle[..., 2] += company.box[:, :, 2].mean(axis=1)
    # Boxes need not be centred on the origin, and they pitch and roll: a little more than half the diagonal.
    radius = 0.55 * np.linalg.norm(np.ptp(company.box, axis=1), axis=1) + 0.2
    relative = np.einsum("pni,pij->pnj", middle - poses[:, None, :3, 3], poses[:, :3, :3])
    distance = np.linalg.norm(relative, axis=-1)
    large = camera.focal_px * 2.0 * radius > _SMALLEST_PX * distance
    return _in_view(relative, radius, camera) & large, distance


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
