"""Labels of the ray through the pixel centre: exact planar depth, flow, covisibility, normals."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np

from scenegen_render import backend
from scenegen_render.camera import Camera
from scenegen_render.trace.lit import Lit
from scenegen_render.trace.pose import DevicePose, Pose, device_pose

_OCCLUSION_TOLERANCE = 1e-3
_IN_FRONT = 1e-6
"""Smallest z, relative to depth, at which a point still counts as in front of the other camera."""


@dataclass(frozen=True, eq=False)
class Moved:
    """Where the points of this frame appear from another pose.

    Attributes
    ----------
    flow : mitsuba.Vector2f
        [px]; NaN behind the other camera.
    covisible : mitsuba.Bool
    """

    flow: Any
    covisible: Any


def triangle(lit: Lit, face: Any, valid: Any) -> tuple[Any, Any, Any]:
    """First corner and the two edges of the triangles that were hit, float64, from the float32 vertices."""
    mi, dr = backend.modules()
    corners = [dr.gather(mi.UInt, lit.loaded.faces, face * 3 + k, valid) for k in range(3)]
    a, b, c = (mi.Vector3d(dr.gather(mi.Vector3f, lit.loaded.vertices, k, valid)) for k in corners)
    return a, b - a, c - a


def planar_depth(pose: DevicePose, x: Any, y: Any, corner: Any, normal: Any) -> Any:
    """Planar z [m] at which the float64 camera ray meets the triangle's plane.

    Embree finds the triangle in float32 (a few 1e-6 of range); meeting its plane in float64 brings the depth to
    float32 rounding.

    Parameters
    ----------
    pose : DevicePose
        `world_from_camera` in float64.
    x, y : mitsuba.Float64
        Ray direction in the camera frame at z = 1.
    corner, normal : mitsuba.Vector3d
        A point of the plane and any multiple of its normal.
    """
    mi, dr = backend.modules()
    direction = pose.turn(x, y, mi.Float64(1.0))
    return dr.dot(normal, corner - pose.translation) / dr.dot(normal, direction)


def moved(
    lit: Lit, camera: Camera, plane: Any, depth: Any, valid: Any, step: DevicePose, other: DevicePose
) -> Moved:
    """Follow the pixels of this frame into another one.

    Parameters
    ----------
    plane : mitsuba.Vector2f
        Camera-frame direction of each pixel centre at z = 1.
    depth : mitsuba.Float
        Planar depth, anything where there is sky.
    valid : mitsuba.Bool
        False for sky, which moves as a point at infinity: by the rotation alone.
    step : DevicePose
        From this camera's frame to the other's.
    other : DevicePose
        `world_from_camera` of the other camera.
    """
    mi, dr = backend.modules()
    place = step.turn(
        plane.x, plane.y, mi.Float(1.0)
    )  # per unit depth, so that sky and surfaces share one formula
    place = dr.select(valid, dr.fma(step.translation, 1.0 / depth, place), place)
    front = place.z > _IN_FRONT
    scale = camera.focal_px / dr.select(front, place.z, 1.0)
    u, v = place.x * scale, place.y * scale
    cx, cy = camera.centre_px
    inside = front & (u > -cx) & (u < camera.width_px - cx) & (v > -cy) & (v < camera.height_px - cy)
    shift = mi.Vector2f(u - plane.x * camera.focal_px, v - plane.y * camera.focal_px)
    flow = dr.select(front, shift, dr.nan)
    back = other.turn(place.x, place.y, place.z)  # from the other camera towards the point, per unit depth
    ray = mi.Ray3f(other.translation, back)
    ray.maxt = dr.select(valid, depth * (1.0 - _OCCLUSION_TOLERANCE), dr.largest(mi.Float))
    hidden = lit.loaded.scene.ray_test(ray, coherent=True, active=inside)
    return Moved(flow, inside & ~hidden)


def camera_normal(pose: Pose, plane: Any, normal: Any, valid: Any) -> Any:
    """Unit normal facing the camera, in the camera frame; zero for sky.

    Parameters
    ----------
    plane : mitsuba.Vector2f
        Camera-frame direction of each pixel centre at z = 1.
    normal : mitsuba.Vector3d
        Any multiple of the face normal, world frame.
    """
    mi, dr = backend.modules()
    n = dr.normalize(mi.Vector3f(normal))
    camera_from_world = np.eye(4)
    camera_from_world[:3, :3] = pose[:3, :3].T
    n = device_pose(camera_from_world).turn(n.x, n.y, n.z)
    away = dr.fma(n.x, plane.x, dr.fma(n.y, plane.y, n.z))
    return dr.select(valid, dr.mulsign(n, -away), mi.Vector3f(0.0))
