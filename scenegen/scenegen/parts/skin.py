"""Models whose faces share a few sites per slot."""

from __future__ import annotations

import numpy as np

from scenegen.geometry.modelling import Modeller
from scenegen.geometry.part import face_normals
from scenegen.geometry.template import Template
from scenegen.parts.lofts import fan_faces, loft_faces

_LEAST_AREA_M2 = 1e-6


class Skin:
    """Collects triangles and sites; in the end each face takes the site of its slot that looks most nearly its way.

    Parameters
    ----------
    semantic : int
        Class of all faces.
    """

    def __init__(self, semantic: int) -> None:
        self._model, self._semantic = Modeller(), int(semantic)
        self._sites: dict[int, tuple[list[int], list[np.ndarray]]] = {}
        self._pieces: list[tuple[np.ndarray, np.ndarray, int]] = []

    def site(self, slot: int, position: np.ndarray, normal: np.ndarray, standoff_m: float = 0.02) -> None:
        """Add a site of a slot."""
        normal = np.asarray(normal, np.float64)
        ids, normals = self._sites.setdefault(slot, ([], []))
        ids.append(self._model.site(np.asarray(position, np.float64), normal, standoff_m))
        normals.append(normal / np.linalg.norm(normal))

    def add(self, vertices: np.ndarray, faces: np.ndarray, slot: np.ndarray | int) -> None:
        """Add triangles; `slot` is one number or one per face. Faces without area are left out."""
        _, area = face_normals(vertices, faces)
        slots = np.where(area > _LEAST_AREA_M2, np.broadcast_to(slot, (len(faces),)), -1)
        for k in np.unique(slots[slots >= 0]):
            used, kept = np.unique(faces[slots == k], return_inverse=True)
            self._pieces.append((vertices[used], kept.reshape(-1, 3).astype(np.int64), int(k)))

    def box(self, low: tuple[float, ...], high: tuple[float, ...], slot: int, under: bool = True) -> None:
        """Add an upright box; without its underside if that is never seen."""
        (x0, y0, z0), (x1, y1, z1) = low, high
        plan = np.array([[x0, y0], [x1, y0], [x1, y1], [x0, y1]])
        points = np.concatenate([np.column_stack([plan, np.full(4, z)]) for z in (z0, z1)])
        faces = np.concatenate([loft_faces(2, 4), fan_faces(4, 4)])
        self.add(points, np.concatenate([faces, fan_faces(4, 0, True)]) if under else faces, slot)

    def tube(
        self, start: np.ndarray, end: np.ndarray, radii_m: tuple[float, float], slot: int, sides: int = 6
    ) -> None:
        """Add a tapered tube with a lid at its end."""
        axis = (end - start) / np.linalg.norm(end - start)
        helper = np.array([1.0, 0.0, 0.0]) if abs(axis[2]) > 0.9 else np.array([0.0, 0.0, 1.0])
        u = np.cross(helper, axis)
        u /= np.linalg.norm(u)
        v = np.cross(axis, u)
        turn = 2 * np.pi * np.arange(sides) / sides
        ring = np.cos(turn)[:, None] * u + np.sin(turn)[:, None] * v
        points = np.concatenate([start + radii_m[0] * ring, end + radii_m[1] * ring])
        self.add(points, np.concatenate([loft_faces(2, sides), fan_faces(sides, sides)]), slot)

    def finish(self) -> Template:
        """The template."""
        for vertices, faces, slot in self._pieces:
            ids, normals = self._sites[slot]
            normal, _ = face_normals(vertices, faces)
            site = np.array(ids)[np.argmax(normal @ np.array(normals).T, axis=1)]
            corner = np.repeat(site[:, None], 3, axis=1)
            self._model.mesh(vertices, faces, slot, self._semantic, corner)
        return self._model.finish()
