"""Models whose faces share a few sites per slot."""

from __future__ import annotations

import numpy as np

from scenegen.geometry.modelling import Modeller
from scenegen.geometry.part import LUMP_STANDOFF_M, face_normals
from scenegen.geometry.rings import around
from scenegen.geometry.template import Template
from scenegen.parts.lofts import fan_faces, loft_faces

_LEAST_AREA_M2 = 1e-6
_CLEAR_M = 0.02
_FACING = 0.3
"""Cosine between a site's normal and that of a face it may lie on."""


class Skin:
    """Collects triangles and sites; in the end each face takes the site of its slot that looks most nearly its way.

    Sites settle on the outside of their slot: along its normal, each goes to the outermost face within reach.

    Parameters
    ----------
    semantic : int
        Class of all faces that do not say otherwise.
    smooth : bool
        Let every corner of a face choose for itself, so that temperature runs smoothly around round things.
    """

    def __init__(self, semantic: int, smooth: bool = False) -> None:
        self._semantic, self._smooth = int(semantic), smooth
        self._sites: dict[int, list[tuple[np.ndarray, np.ndarray, float, float]]] = {}
        self._pieces: list[tuple[np.ndarray, np.ndarray, int, int]] = []

    def site(
        self,
        slot: int,
        position: tuple[float, float, float] | np.ndarray,
        normal: tuple[float, float, float] | np.ndarray,
        standoff_m: float = 0.02,
        reach_m: float = 0.35,
    ) -> None:
        """Add a site of a slot near a place; it settles on the slot's skin within reach."""
        n = np.asarray(normal, np.float64)
        row = (np.asarray(position, np.float64), n / np.linalg.norm(n), standoff_m, reach_m)
        self._sites.setdefault(slot, []).append(row)

    def pair(
        self, slot: int, position: tuple[float, float, float] | np.ndarray, across: tuple[float, float, float]
    ) -> None:
        """Two lumped sites that look both ways across something thin."""
        for sign in (1.0, -1.0):
            self.site(slot, position, sign * np.asarray(across, np.float64), LUMP_STANDOFF_M)

    def around(self, slot: int, position: tuple[float, float, float] | np.ndarray, count: int = 3) -> None:
        """Lumped sites around something upright and thin: three, so that the sun always finds one."""
        for turn in 2 * np.pi * np.arange(count) / count + 0.4:
            self.site(slot, position, (np.cos(turn), np.sin(turn), 0.0), LUMP_STANDOFF_M)

    def add(
        self,
        vertices: np.ndarray,
        faces: np.ndarray,
        slot: np.ndarray | int,
        semantic: int | None = None,
    ) -> None:
        """Add triangles; `slot` is one number or one per face. Faces without area are left out."""
        _, area = face_normals(vertices, faces)
        slots = np.where(area > _LEAST_AREA_M2, np.broadcast_to(slot, (len(faces),)), -1)
        label = self._semantic if semantic is None else int(semantic)
        for k in np.unique(slots[slots >= 0]):
            used, kept = np.unique(faces[slots == k], return_inverse=True)
            self._pieces.append((vertices[used], kept.reshape(-1, 3).astype(np.int64), int(k), label))

    def box(
        self,
        low: tuple[float, float, float],
        high: tuple[float, float, float],
        slot: int,
        under: bool = True,
        semantic: int | None = None,
    ) -> None:
        """Add an upright box; without its underside if that is never seen."""
        (x0, y0, z0), (x1, y1, z1) = low, high
        plan = np.array([[x0, y0], [x1, y0], [x1, y1], [x0, y1]])
        points = np.concatenate([np.column_stack([plan, np.full(4, z)]) for z in (z0, z1)])
        faces = np.concatenate([loft_faces(2, 4), fan_faces(4, 4)])
        faces = np.concatenate([faces, fan_faces(4, 0, True)]) if under else faces
        self.add(points, faces, slot, semantic)

    def tube(
        self,
        start: tuple[float, float, float] | np.ndarray,
        end: tuple[float, float, float] | np.ndarray,
        radii_m: tuple[float, float],
        slot: int,
        sides: int = 6,
        semantic: int | None = None,
    ) -> None:
        """Add a tapered tube with a lid at its end."""
        start, end = np.asarray(start, np.float64), np.asarray(end, np.float64)
        axis = (end - start) / np.linalg.norm(end - start)
        ring = around(axis, sides)
        points = np.concatenate([start + radii_m[0] * ring, end + radii_m[1] * ring])
        self.add(points, np.concatenate([loft_faces(2, sides), fan_faces(sides, sides)]), slot, semantic)

    def finish(self) -> Template:
        """The template."""
        model = Modeller()
        first = {}
        for slot in sorted({p[2] for p in self._pieces}):
            own = [v[f] for v, f, k, _ in self._pieces if k == slot]
            rows = self._sites[slot]
            placed = [model.site(_settled(np.concatenate(own), p, n, r), n, s) for p, n, s, r in rows]
            first[slot] = np.array(placed), np.array([n for _, n, _, _ in rows])
        for vertices, faces, slot, semantic in self._pieces:
            ids, normals = first[slot]
            if self._smooth:
                corner = ids[np.argmax(_corner_normals(vertices, faces) @ normals.T, axis=-1)]
            else:
                normal, _ = face_normals(vertices, faces)
                corner = np.repeat(ids[np.argmax(normal @ normals.T, axis=1)][:, None], 3, axis=1)
            model.mesh(vertices, faces, slot, semantic, corner)
        return model.finish()


def _corner_normals(vertices: np.ndarray, faces: np.ndarray) -> np.ndarray:
    """Area-weighted normals of a smooth skin at the corners of its faces, (faces, 3, 3)."""
    normal, area = face_normals(vertices, faces)
    total = np.zeros_like(vertices)
    for k in range(3):
        np.add.at(total, faces[:, k], normal * area[:, None])
    return np.asarray(total[faces])


def _settled(triangles: np.ndarray, position: np.ndarray, normal: np.ndarray, reach_m: float) -> np.ndarray:
    """Outermost point of the skin on the line through a place along a normal, and a little further.

    Moller and Trumbore 1997: Fast, minimum storage ray/triangle intersection.
    """
    a = triangles[:, 0]
    u, v = triangles[:, 1] - a, triangles[:, 2] - a
    across = np.cross(normal, v)
    determinant = (u * across).sum(axis=1)
    with np.errstate(divide="ignore", invalid="ignore"):
        to = position - a
        s = (to * across).sum(axis=1) / determinant
        q = np.cross(to, u)
        t = (q @ normal) / determinant
        distance = (v * q).sum(axis=1) / determinant
        inside = (s >= 0) & (t >= 0) & (s + t <= 1) & (np.abs(distance) <= reach_m)
    facing = np.cross(u, v) @ normal > _FACING * np.linalg.norm(np.cross(u, v), axis=1)
    hit = inside & facing & np.isfinite(distance)
    if not hit.any():
        return position
    return np.asarray(position + (float(distance[hit].max()) + _CLEAR_M) * normal)
