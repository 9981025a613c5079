"""Triangles of a plant, before they have surfaces and sites."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from jaxtyping import Float64, Int64


@dataclass(frozen=True, eq=False)
class Mesh:
    """Some triangles.

    Attributes
    ----------
    vertices : float64 (vertices, 3)
    faces : int64 (faces, 3)
        Counter-clockwise from outside where there is an outside; leaves have none.
    """

    vertices: Float64[np.ndarray, "vertices 3"]
    faces: Int64[np.ndarray, "faces 3"]

    def __len__(self) -> int:
        """Number of triangles."""
        return len(self.faces)

    def corners(self) -> Float64[np.ndarray, "faces 3 3"]:
        """Corners of each triangle."""
        return np.asarray(self.vertices[self.faces])

    @staticmethod
    def of(corners: Float64[np.ndarray, "faces 3 3"]) -> Mesh:
        """Triangles that share no vertices."""
        return Mesh(corners.reshape(-1, 3), np.arange(3 * len(corners)).reshape(-1, 3))


def merged(meshes: Sequence[Mesh]) -> Mesh:
    """Meshes one after the other."""
    start = np.cumsum([0, *(len(m.vertices) for m in meshes)])[:-1]
    faces = [m.faces + first for m, first in zip(meshes, start, strict=True)]
    return Mesh(np.concatenate([m.vertices for m in meshes]), np.concatenate(faces))


NOTHING = Mesh(np.zeros((0, 3)), np.zeros((0, 3), np.int64))
"""No triangles."""
