"""A world on the device: one merged mesh behind Embree and the tables that say what each face is."""

from __future__ import annotations

import ctypes
import gc
import sys
import zlib
from typing import Any

import numpy as np

from scenegen.foundation.errors import InputError
from scenegen.world import World
from scenegen_render import backend

_FAR_M = 1e5


class LoadedWorld:
    """A world the renderer can trace.

    Attributes
    ----------
    world : World
    scene : mitsuba.Scene
        One mesh, robust intersections on. Ids never come from it, only from the tables below.
    face_record : mitsuba.UInt, 4 per face
        Sites of the three corners, then ``surface | semantic << 16``: one packed gather per hit.
    face_object : mitsuba.UInt, 1 per face
    face_normal : mitsuba.UInt, 1 per face
        Outward unit normal, two 16-bit octahedral coordinates.
    texture_seed : int
        Of the surface texture; a pure function of the mesh, so that no two worlds share a pattern.
    vertices : mitsuba.Float, 3 per vertex
        [m], as Embree holds them.
    faces : mitsuba.UInt, 3 per face
    """

    def __init__(self, world: World) -> None:
        _check(world)
        self.world = world
        self.vertices = backend.upload(world.mesh.vertices)
        self.faces = backend.upload(world.mesh.faces)
        self.scene = _scene(self.vertices, self.faces)
        self.face_record = backend.upload(_face_record(world))
        self.face_object = backend.upload(world.face_object)
        self.face_normal = backend.upload(_packed_normals(world))
        self.texture_seed = zlib.crc32(np.ascontiguousarray(world.mesh.vertices).data)

    def nearest_site(self, face: Any, uv: Any) -> Any:
        """Site whose corner lies nearest to a hit (largest barycentric weight).

        Parameters
        ----------
        face : mitsuba.UInt
        uv : mitsuba.Point2f
            Barycentric weights of the second and third corner.
        """
        mi, dr = backend.modules()
        first = 1.0 - uv.x - uv.y
        corner = dr.select(uv.x > first, dr.select(uv.y > uv.x, 2, 1), dr.select(uv.y > first, 2, 0))
        return dr.gather(mi.UInt, self.face_record, face * 4 + mi.UInt(corner))

    def release(self) -> None:
        """Give the memory back to the system; the object must not be used afterwards."""
        del self.scene, self.vertices, self.faces, self.face_record, self.face_object
        del self.face_normal, self.world
        release_memory()


def load(world: World) -> LoadedWorld:
    """Build the acceleration structure and the device tables of a world.

    Raises
    ------
    InputError
        If the mesh has indices out of range, non-finite coordinates or coordinates beyond 100 km (where float32
        positions and ray casts lose centimetres): the renderer itself would crash or return garbage.
    """
    return LoadedWorld(world)


def release_memory() -> None:
    """Return freed host and device memory to the operating system (keeps a long job flat)."""
    _, dr = backend.modules()
    gc.collect()
    dr.flush_malloc_cache()
    if sys.platform.startswith("linux"):
        ctypes.CDLL("libc.so.6").malloc_trim(0)


def _scene(vertices: Any, faces: Any) -> Any:
    """One-mesh scene; `optimize` stays off because it reorders shapes differently in every process."""
    mi, dr = backend.modules()
    mesh = mi.Mesh("world", vertex_count=dr.width(vertices) // 3, face_count=dr.width(faces) // 3)
    parameters = mi.traverse(mesh)
    parameters["vertex_positions"] = vertices
    parameters["faces"] = faces
    parameters.update()
    description = {"type": "scene", "embree_use_robust_intersections": True, "world": mesh}
    return mi.load_dict(description, optimize=False, parallel=False)


def _face_record(world: World) -> np.ndarray[Any, np.dtype[np.uint32]]:
    record = np.empty((len(world.face_surface), 4), np.uint32)
    record[:, :3] = world.corner_site
    record[:, 3] = world.face_surface.astype(np.uint32) | world.face_semantic.astype(np.uint32) << 16
    return record


def _packed_normals(world: World) -> np.ndarray[Any, np.dtype[np.uint32]]:
    """Octahedral face normals, 16 bits a coordinate (3e-5 rad); a degenerate face points up."""
    corners = world.mesh.vertices[world.mesh.faces]
    n = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0]).astype(np.float64)
    size = np.abs(n).sum(axis=1, keepdims=True)
    n = np.where(size > 0, n / np.maximum(size, 1e-300), (0.0, 0.0, 1.0))
    folded = (1.0 - np.abs(n[:, [1, 0]])) * np.copysign(1.0, n[:, :2])
    flat = np.where(n[:, 2:] < 0, folded, n[:, :2])
    x, y = np.rint((flat.T + 1.0) * 32767.0).astype(np.uint32)
    return np.asarray(x | y << np.uint32(16))


def _check(world: World) -> None:
    """Refuse what would crash the renderer or make it answer nonsense."""
    mesh, sites = world.mesh, len(world.sites.area)
    limits = (
        (len(mesh.faces) > 0 and len(mesh.vertices) > 0, "has no triangles"),
        (bool(np.isfinite(mesh.vertices).all()), "has non-finite vertices"),
        (bool((np.abs(mesh.vertices) < _FAR_M).all()), "reaches beyond 100 km; centre it on the origin"),
        (int(mesh.faces.max(initial=0)) < len(mesh.vertices), "has a face with a vertex index out of range"),
        (int(world.corner_site.max(initial=0)) < sites, "has a face corner whose site does not exist"),
        (int(world.face_object.min(initial=1)) > 0, "has a face of object 0, which is reserved for the sky"),
        (
            int(world.face_surface.max(initial=0)) < len(world.palette),
            "has a face whose surface does not exist",
        ),
    )
    for holds, problem in limits:
        if not holds:
            raise InputError(f"the mesh of world '{world.map}' {problem}")
