"""Which movers appear in a clip, and where in an image they can be.

The first is chosen once by the clip's whole path, so that nothing ever pops up or vanishes. In closed loop nobody knows
the path beforehand: there every instant has those that some ray can meet.
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
_SLACK_M = 0.05
"""Around a mover's bounding sphere; far more than rounding."""
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
    middle = company.poses_over(times_s)[..., :3, 3]
    middle[..., 2] += company.box[:, :, 2].mean(axis=1)
    # Boxes need not be centred on the origin, and they pitch and roll: a little more than half the diagonal.
    radius = 0.55 * np.linalg.norm(np.ptp(company.box, axis=1), axis=1) + 0.2
    relative = np.einsum("pni,pij->pnj", middle - poses[:, None, :3, 3], poses[:, :3, :3])
    distance = np.linalg.norm(relative, axis=-1)
    large = camera.focal_px * 2.0 * radius > _SMALLEST_PX * distance
    seen = _in_view(relative, radius, camera) & large
    nearest = np.where(seen, distance, np.inf).min(axis=0)
    order: Int64[np.ndarray, "movers"] = np.argsort(nearest, kind="stable")
    triangles = np.cumsum([len(movers[k].body.faces) for k in order])
    kept = order[np.isfinite(nearest[order]) & (triangles <= max_triangles)]
    return tuple(sorted(kept.tolist()))


def around(
    company: Company, time_s: float, camera: Camera, poses: Float64[np.ndarray, "views 4 4"]
) -> tuple[Bool[np.ndarray, "views rows columns"], Int64[np.ndarray, "some"]]:
    """Pixels whose rays can meet a mover at one time: rectangles around the projections of their boxes.

    Returns
    -------
    bool (views, rows, columns)
    int64 (some,)
        The movers any of them can meet, increasing.
    """
    near = np.zeros((len(poses), camera.height_px, camera.width_px), bool)
    box, move = company.box, company.poses(time_s)
    middle = np.einsum("nij,nj->ni", move[:, :3, :3], box.mean(axis=1)) + move[:, :3, 3]
    relative = np.einsum("vni,vij->vnj", middle - poses[:, None, :3, 3], poses[:, :3, :3])
    radius = 0.5 * np.linalg.norm(np.ptp(box, axis=1), axis=1) + _SLACK_M
    view, mover = np.nonzero(_in_view(relative, radius, camera))
    if not len(mover):
        return near, mover
    corner = np.stack([box[mover][:, pick, range(3)] for pick in _CORNERS], axis=1)
    world = np.einsum("nij,nkj->nki", move[mover, :3, :3], corner) + move[mover, None, :3, 3]
    local = np.einsum("nki,nij->nkj", world - poses[view, None, :3, 3], poses[view, :3, :3])
    points, ahead = _before_the_camera(local)
    place = points[..., :2] / points[..., 2:] * camera.focal_px + camera.centre_px
    seen = ahead[..., None]
    low = np.where(seen, place, np.inf).min(axis=1) - _MARGIN_PX
    high = np.where(seen, place, -np.inf).max(axis=1) + _MARGIN_PX
    size = np.array([camera.width_px, camera.height_px])
    first = np.clip(np.floor(low), 0, size).astype(np.int64)
    last = np.clip(np.ceil(high), 0, size).astype(np.int64)
    met = (first < last).all(axis=1)
    for k, (left, top), (right, bottom) in zip(
        view[met].tolist(), first[met].tolist(), last[met].tolist(), strict=True
    ):
        near[k, top:bottom, left:right] = True
    return near, np.unique(mover[met])


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
