"""The movers of one clip on the device: a second, small scene, rebuilt for every instant from vertices of that time.

One scene with everything would be rebuilt as a whole, a hundred times as dear. The static world is traced first, the
movers as far as its hit. Movers' faces are numbered on from the world's, so that all tables are one. The first
faces of a troupe are points far below the ground that no ray can hit: a scene is never empty, and a clip without
movers runs the same kernels.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np
from jaxtyping import Float32, Float64, UInt32

from scenegen.movers.company import Company
from scenegen_render import backend
from scenegen_render.camera import Camera
from scenegen_render.trace.casting import around
from scenegen_render.trace.pose import Pose

_UNSEEN = 2
"""Faces nobody sees; two, since tables of one row are compiled differently."""
_NOWHERE = np.full((3 * _UNSEEN, 3), -1e3, np.float32)
_KEPT = 3
"""Instants kept: previous, this, next."""


@dataclass(frozen=True, eq=False)
class Instant:
    """Where the movers are at one time.

    Attributes
    ----------
    time_s : float
    scene : mitsuba.Scene
    vertices : mitsuba.Float, 3 per vertex
        World positions [m].
    """

    time_s: float
    scene: Any
    vertices: Any


@dataclass(frozen=True, eq=False)
class View:
    """Movers at one time, and where in one image (or in several, one after the other) they can be.

    Attributes
    ----------
    instant : Instant
    near : mitsuba.Bool, 1 per pixel
        Row by row: whether a ray of the pixel can meet a mover. Only there is their scene traced.
    """

    instant: Instant
    near: Any


class Troupe:
    """Chosen movers of a world.

    Those that no camera sees at an instant may be left out of its scene: their vertices are NaN there, which
    ray tracers take for "no triangle", so that tables and kernels stay what they are.

    Parameters
    ----------
    company : Company

    Attributes
    ----------
    company : Company
    faces : mitsuba.UInt, 3 per face
        Indices into the vertices of an instant.
    present : mitsuba.Bool
        Whether there is any mover: an argument of kernels, not a part of them.
    rest : mitsuba.Float, 12 per face
        Corners in the rest pose [m], four floats each; shifted by a vector of the mover's own, so that no two movers
        share a pattern of texture.
    what, object : mitsuba.UInt, 1 per face
        ``surface | semantic << 16``, and instance id.
    """

    def __init__(self, company: Company) -> None:
        mi, dr = backend.modules()
        self.company = company
        unseen = np.arange(3 * _UNSEEN).reshape(-1, 3)
        faces = np.concatenate([unseen, company.body.faces + 3 * _UNSEEN]).astype(np.uint32)
        self.faces = backend.upload(faces)
        self.present = dr.opaque(mi.Bool, bool(company.movers))
        self.rest = backend.upload(_rest_corners(company))
        self.what = backend.upload(face_record(company, 0)[:, 3])
        self.object = backend.upload(face_object(company))
        self._stages: list[_Stage] = []

    def seen(self, time_s: float, camera: Camera, pose: Pose) -> View:
        """The movers at one time, as a camera may see them; the last few times are kept."""
        stage = self._stage(time_s)
        for seen_by, seen_from, view in stage.views:
            if seen_by == camera and np.array_equal(seen_from, pose):
                return view
        near, _ = around(self.company, time_s, camera, pose[None])
        view = View(stage.instant, backend.upload(near))
        stage.views = [*stage.views[1 - _KEPT :], (camera, pose, view)]
        return view

    def seen_by_all(
        self, time_s: float, camera: Camera, poses: Float64[np.ndarray, "views 4 4"], mirrors: bool
    ) -> View:
        """The movers at one time as several cameras see them.

        Parameters
        ----------
        mirrors : bool
            Whether mirrors are looked into, which show what no camera sees. If not, only those are there that some
            ray can meet: a step costs what is near, not what the world has.
        """
        near, who = around(self.company, time_s, camera, poses)
        stage = self._stage(time_s, None if mirrors else tuple(who.tolist()))
        return View(stage.instant, backend.upload(near))

    def _stage(self, time_s: float, who: tuple[int, ...] | None = None) -> _Stage:
        """The scene of an instant, with all movers or only some."""
        known = [s for s in self._stages if s.instant.time_s == time_s and s.who == who]
        if known:
            stage = known[0]
            self._stages.remove(stage)
        else:
            company = self.company
            place = (
                company.vertices(time_s)
                if who is None
                else company.vertices_of(np.array(who, np.int64), time_s)
            )
            vertices = np.concatenate([_NOWHERE, place.astype(np.float32)])
            full = len(self._stages) == _KEPT
            stage = self._stages.pop(0) if full else _Stage(vertices, self.faces)
            stage.move(vertices, time_s, who)
        self._stages.append(stage)  # the last used last: the first may be overwritten
        return stage


class _Stage:
    """One small scene, used again and again."""

    def __init__(self, vertices: Float32[np.ndarray, "vertices 3"], faces: Any) -> None:
        mi, dr = backend.modules()
        mesh = mi.Mesh("movers", vertex_count=len(vertices), face_count=dr.width(faces) // 3)
        parameters = mi.traverse(mesh)
        parameters["vertex_positions"] = backend.upload(vertices)
        parameters["faces"] = faces
        parameters.update()
        description = {"type": "scene", "embree_use_robust_intersections": True, "movers": mesh}
        self._scene = mi.load_dict(description, optimize=False, parallel=False)
        self._parameters = mi.traverse(self._scene)

    def move(
        self, vertices: Float32[np.ndarray, "vertices 3"], time_s: float, who: tuple[int, ...] | None
    ) -> None:
        """Put the vertices where they are at a time and rebuild the acceleration structure."""
        on_device = backend.upload(vertices)
        self._parameters["movers.vertex_positions"] = on_device
        self._parameters.update()
        self.instant = Instant(time_s, self._scene, on_device)
        self.who = who
        self.views: list[tuple[Camera, Pose, View]] = []


def face_record(company: Company, first_site: int) -> UInt32[np.ndarray, "faces 4"]:
    """Sites of the corners (counted on from the world's) and ``surface | semantic << 16`` of a troupe's faces."""
    body = company.body
    record = np.zeros((_UNSEEN + len(body.faces), 4), np.uint32)
    record[_UNSEEN:, :3] = body.corner_site + first_site
    record[_UNSEEN:, 3] = body.surface.astype(np.uint32) | body.semantic.astype(np.uint32) << np.uint32(16)
    return record


def face_object(company: Company) -> UInt32[np.ndarray, "faces"]:
    """Instance id of each face of a troupe."""
    return np.concatenate([np.ones(_UNSEEN, np.int64), company.body.object]).astype(np.uint32)


def _rest_corners(company: Company) -> Float32[np.ndarray, "corners 4"]:
    body = company.body
    # Plastic-number sequence (Roberts 2018): evenly spread shifts for consecutive ids.
    shift = np.array([[m.object] for m in company.movers]).reshape(-1, 1) * _STEP % 1.0 * _SHIFT_M
    place = body.vertices + shift[company.owner]
    corners = np.zeros((3 * (_UNSEEN + len(body.faces)), 4), np.float32)
    corners[3 * _UNSEEN :, :3] = place[body.faces].reshape(-1, 3)
    return corners


_STEP = np.array([0.8191725133961645, 0.6710436067037893, 0.5497004779019703])
_SHIFT_M = 200.0
