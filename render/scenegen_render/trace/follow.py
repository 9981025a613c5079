"""Flow of any place of an image, not of pixel centres only: where a point is found from another pose at another time.

Stored flow belongs to pixel centres. Who follows a point over many frames, or goes there and back, needs it in between;
an interpolation between neighbours would mix what stands in front with what stands behind.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from jaxtyping import Bool, Float32, Float64, UInt32

from scenegen_render import backend
from scenegen_render.camera import Camera
from scenegen_render.trace import labels, pixels
from scenegen_render.trace.pose import Pose, device_pose, relative
from scenegen_render.trace.scenery import Scenery, met


@dataclass(frozen=True, eq=False)
class Followed:
    """Where points of one image appear in another; as the layers of a frame.

    Attributes
    ----------
    flow : float32 (places, 2)
        [px]; NaN behind the other camera; by the rotation alone for sky.
    covisible : bool (places,)
        Inside the other image, and reached by a ray.
    depth : float32 (places,)
        Planar depth in the first image [m]; +inf for sky.
    instance : uint32 (places,)
        Object that was met; 0 for sky.
    """

    flow: Float32[np.ndarray, "places 2"]
    covisible: Bool[np.ndarray, "places"]
    depth: Float32[np.ndarray, "places"]
    instance: UInt32[np.ndarray, "places"]


_NOTHING = Followed(
    np.zeros((0, 2), np.float32), np.zeros(0, bool), np.zeros(0, np.float32), np.zeros(0, np.uint32)
)


def follow(
    scenery: Scenery,
    camera: Camera,
    places: Float64[np.ndarray, "places 2"],
    pose: Pose,
    other: Pose,
    times_s: tuple[float, float],
) -> Followed:
    """Follow places of one image into another.

    Parameters
    ----------
    scenery : Scenery
    camera : Camera
    places : float64 (places, 2)
        Column and row in the first image [px]; the upper left pixel has its centre at (0.5, 0.5).
    pose, other : float64 (4, 4)
        `world_from_camera` of the two images.
    times_s : (float, float)
        Their world times: where the movers are.
    """
    if not len(places):
        return _NOTHING
    mi, dr = backend.modules()
    plane = pixels.on_device(((places - np.asarray(camera.centre_px)) / camera.focal_px).astype(np.float32))
    now, then = (
        scenery.troupe.seen(time_s, camera, place)
        for time_s, place in zip(times_s, (pose, other), strict=True)
    )
    towards = device_pose(pose)
    column, row = (np.clip(places[:, k], 0, size - 1).astype(np.uint32)
                   for k, size in ((0, camera.width_px), (1, camera.height_px)))  # fmt: skip
    near = dr.gather(mi.Bool, now.near, backend.upload(row * np.uint32(camera.width_px) + column))
    face, valid = met(
        scenery, now.instant, towards.translation, towards.turn(plane.x, plane.y, mi.Float(1.0)), near
    )
    on = labels.footing(scenery, now.instant, face, valid)
    x, y, exact = mi.Float64(plane.x), mi.Float64(plane.y), device_pose(pose, double=True)
    depth = mi.Float(labels.planar_depth(exact, x, y, on.corner, dr.cross(on.along, on.up)))
    own = labels.shift(scenery, now.instant, then.instant, on, exact, x, y, depth)
    step = device_pose(relative(other, pose))
    moved = labels.moved(scenery, then, camera, plane, depth, valid, own, step, device_pose(other))
    depth = dr.select(valid, depth, dr.inf)
    instance = labels.instance(scenery, on, face, valid)
    dr.eval(moved, depth, instance)
    flow = np.stack([moved.flow.x.numpy(), moved.flow.y.numpy()], axis=-1)
    return Followed(flow, moved.covisible.numpy(), depth.numpy(), instance.numpy())
