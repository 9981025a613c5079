"""Single rays of an audit: what is met first, and which way it looks."""

from __future__ import annotations

from typing import Any

import numpy as np
from jaxtyping import Float32, Int64

from scenegen_render import backend
from scenegen_render.scene import LoadedWorld

WALKS = 8
"""Surfaces that a ray may leave behind before it gives up: sprays of a hedge lie close."""


def cast(
    loaded: LoadedWorld, origin: Float32[np.ndarray, "rays 3"], direction: Float32[np.ndarray, "rays 3"]
) -> tuple[np.ndarray, np.ndarray]:
    """Distance [m] (inf where nothing) and face of the nearest hit of each ray."""
    mi, dr = backend.modules()
    if not len(origin):
        return np.zeros(0), np.zeros(0, np.int64)
    lane = dr.arange(mi.UInt, len(origin))
    o: Any = dr.gather(mi.Point3f, backend.upload(np.ascontiguousarray(origin)), lane)
    d: Any = dr.gather(mi.Vector3f, backend.upload(np.ascontiguousarray(direction)), lane)
    hit = loaded.scene.ray_intersect_preliminary(mi.Ray3f(o, d))
    valid = np.asarray(hit.is_valid())
    distance = np.where(valid, np.asarray(hit.t).astype(np.float64), np.inf)
    return distance, np.where(valid, np.asarray(hit.prim_index).astype(np.int64), 0)


def face_normal(loaded: LoadedWorld, face: Int64[np.ndarray, "some"]) -> np.ndarray:
    """Normals of faces, as long as twice their areas."""
    mesh = loaded.world.mesh
    a, b, c = (mesh.vertices[mesh.faces[face, k]].astype(np.float64) for k in range(3))
    return np.asarray(np.cross(b - a, c - a))
