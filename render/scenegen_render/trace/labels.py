"""Labels of the ray through the pixel centre: exact planar depth, flow, covisibility, normals."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np

from scenegen_render import backend
from scenegen_render.camera import Camera
from scenegen_render.trace.pose import DevicePose, Pose, device_pose
from scenegen_render.trace.scenery import Scenery
from scenegen_render.trace.surface import moving_corners
from scenegen_render.trace.troupe import Instant, View

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


@dataclass(frozen=True, eq=False)
class Footing:
    """The triangles that were hit, from float32 vertices, in float64.

    Attributes
    ----------
    corner, along, up : mitsuba.Vector3d
        First corner and the two edges [m].
    moving : mitsuba.Bool
    own : mitsuba.UInt
        Face, counted from the troupe's first; 0 where nothing moves.
    """

    corner: Any
    along: Any
    up: Any
    moving: Any
    own: Any


def footing(lit: Scenery, now: Instant, face: Any, valid: Any) -> Footing:
    """Look the triangles up, in the world's vertices or in those of the movers."""
    mi, dr = backend.modules()
    moving = valid & (face >= lit.first_moving)
    own = dr.select(moving, face - lit.first_moving, 0)

    def standing(own: Any, face: Any, valid: Any) -> tuple[Any, Any, Any]:
        index = (dr.gather(mi.UInt, lit.loaded.faces, face * 3 + k, valid) for k in range(3))
        a, b, c = (dr.gather(mi.Vector3f, lit.loaded.vertices, k, valid) for k in index)
        return a, b, c

    corners = dr.if_stmt(
        args=(own, face, valid),
        cond=moving,
        true_fn=lambda own, face, valid: moving_corners(lit, now, own),
        false_fn=standing,
        label="corners",
    )
    a, b, c = (mi.Vector3d(corner) for corner in corners)
    return Footing(a, b - a, c - a, moving, own)


def semantic(lit: Scenery, on: Footing, face: Any, valid: Any) -> Any:
    """Class of what was met; 0 for sky."""
    mi, dr = backend.modules()
    standing = dr.gather(mi.UInt, lit.loaded.face_record, face * 4 + 3, valid & ~on.moving)
    return (standing | dr.gather(mi.UInt, lit.troupe.what, on.own, on.moving)) >> 16


def instance(lit: Scenery, on: Footing, face: Any, valid: Any) -> Any:
    """Object that was met; 0 for sky."""
    mi, dr = backend.modules()
    standing = dr.gather(mi.UInt, lit.loaded.face_object, face, valid & ~on.moving)
    return standing | dr.gather(mi.UInt, lit.troupe.object, on.own, on.moving)


def shift(
    lit: Scenery, now: Instant, then: Instant, on: Footing, pose: DevicePose, x: Any, y: Any, depth: Any
) -> Any:
    """How far the points that were hit move until another instant [m]; zero where nothing moves.

    The hit's barycentric coordinates are found in float64 and carried along: right for whatever turns or deforms.

    Parameters
    ----------
    now, then : Instant
    on : Footing
    pose : DevicePose
        `world_from_camera` in float64.
    x, y : mitsuba.Float64
        Ray direction in the camera frame at z = 1.
    depth : mitsuba.Float
        Planar depth, anything where nothing moves.
    """
    mi, dr = backend.modules()

    def carried(own: Any, x: Any, y: Any, depth: Any, corner: Any, along: Any, up: Any) -> Any:
        place = dr.fma(pose.turn(x, y, mi.Float64(1.0)), mi.Float64(depth), pose.translation) - corner
        normal = dr.cross(along, up)
        area = dr.rcp(dr.squared_norm(normal))
        u = mi.Float(dr.dot(dr.cross(place, up), normal) * area)
        v = mi.Float(dr.dot(dr.cross(along, place), normal) * area)
        before, after = moving_corners(lit, now, own), moving_corners(lit, then, own)
        a, b, c = (q - p for p, q in zip(before, after, strict=True))
        return dr.fma(b - a, u, dr.fma(c - a, v, a))

    return dr.if_stmt(
        args=(on.own, x, y, depth, on.corner, on.along, on.up),
        cond=on.moving,
        true_fn=carried,
        false_fn=lambda *_: mi.Vector3f(0.0),
        label="carried",
    )


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
    lit: Scenery,
    then: View,
    camera: Camera,
    plane: Any,
    depth: Any,
    valid: Any,
    shift: Any,
    step: DevicePose,
    other: DevicePose,
) -> Moved:
    """Follow the pixels of this frame into another one.

    Parameters
    ----------
    then : View
        Of the movers in the other frame.
    plane : mitsuba.Vector2f
        Camera-frame direction of each pixel centre at z = 1.
    depth : mitsuba.Float
        Planar depth, anything where there is sky.
    valid : mitsuba.Bool
        False for sky, which moves as a point at infinity: by the rotation alone.
    shift : mitsuba.Vector3f
        Own movement of the points, world frame [m].
    step : DevicePose
        From this camera's frame to the other's.
    other : DevicePose
        `world_from_camera` of the other camera.
    """
    mi, dr = backend.modules()
    # Per unit depth, so that sky and surfaces share one formula.
    place = step.turn(plane.x, plane.y, mi.Float(1.0))
    travel = step.translation + mi.Vector3f(*(dr.dot(axis, shift) for axis in other.column))
    place = dr.select(valid, dr.fma(travel, 1.0 / depth, place), place)
    front = place.z > _IN_FRONT
    scale = camera.focal_px / dr.select(front, place.z, 1.0)
    u, v = place.x * scale, place.y * scale
    cx, cy = camera.centre_px
    inside = front & (u > -cx) & (u < camera.width_px - cx) & (v > -cy) & (v < camera.height_px - cy)
    way = mi.Vector2f(u - plane.x * camera.focal_px, v - plane.y * camera.focal_px)
    flow = dr.select(front, way, dr.nan)
    back = other.turn(place.x, place.y, place.z)  # from the other camera towards the point, per unit depth
    reach = dr.select(valid, depth * (1.0 - _OCCLUSION_TOLERANCE), dr.largest(mi.Float))
    ray = _as_far_as(other.translation, back, reach)
    hidden = lit.loaded.scene.ray_test(ray, coherent=True, active=inside)
    column, row = mi.UInt(dr.select(inside, u + cx, 0.0)), mi.UInt(dr.select(inside, v + cy, 0.0))
    near = dr.gather(mi.Bool, then.near, row * camera.width_px + column, inside)
    hidden |= dr.if_stmt(
        args=(ray.o, ray.d, ray.maxt),
        cond=inside & ~hidden & near,
        true_fn=lambda o, d, maxt: then.instant.scene.ray_test(_as_far_as(o, d, maxt), coherent=True),
        false_fn=lambda o, d, maxt: mi.Bool(False),
        label="hidden",
    )
    return Moved(flow, inside & ~hidden)


def _as_far_as(origin: Any, direction: Any, maxt: Any) -> Any:
    mi, _ = backend.modules()
    ray = mi.Ray3f(origin, direction)
    ray.maxt = maxt
    return ray


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
