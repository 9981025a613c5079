"""What a growth model hands over: wood order by order, and foliage, for a tree of about unit height."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from jaxtyping import Float64, Int64

from scenegen.parts.vegetation.tubes import Mesh


@dataclass(frozen=True, eq=False)
class Plan:
    """How richly a tree is modelled, and how it stands in the season.

    Attributes
    ----------
    faces : int
        Triangles it may take, about.
    in_leaf : float
        Share of the foliage it carries, 0..1.
    """

    faces: int
    in_leaf: float


@dataclass(frozen=True, eq=False)
class Grown:
    """One tree.

    Attributes
    ----------
    trunk : Mesh
    limbs : Mesh
        All other wood.
    leaves : Mesh
    """

    trunk: Mesh
    limbs: Mesh
    leaves: Mesh


def merged(meshes: list[Mesh]) -> Mesh:
    """Meshes one after the other."""
    start = np.cumsum([0, *(len(v) for v, _ in meshes)])
    vertices: Float64[np.ndarray, "vertices 3"] = np.concatenate([v for v, _ in meshes] or [np.zeros((0, 3))])
    faces: Int64[np.ndarray, "faces 3"] = np.concatenate(
        [f + s for (_, f), s in zip(meshes, start[:-1], strict=True)] or [np.zeros((0, 3), np.int64)]
    )
    return vertices, faces


NOTHING: Mesh = (np.zeros((0, 3)), np.zeros((0, 3), np.int64))
"""No triangles."""
