"""Tapered tubes around branches, and which way their faces look."""

from __future__ import annotations

import numpy as np
from jaxtyping import Int64

from scenegen.parts.vegetation.branches import Branches, across, unit
from scenegen.parts.vegetation.mesh import Mesh


def tubes(branches: Branches, sides: int, pointed: bool) -> Mesh:
    """Tubes without lids; pointed ones end in a single vertex.

    Parameters
    ----------
    branches : Branches
    sides : int
        Of the cross-section, three or more.
    pointed : bool
    """
    count, nodes = branches.radius.shape
    ahead = unit(np.gradient(branches.points, axis=1))
    u = across(unit(branches.points[:, -1] - branches.points[:, 0]))[:, None, :]
    u = unit(u - (u * ahead).sum(axis=2, keepdims=True) * ahead)
    v = np.cross(ahead, u)
    angle = 2 * np.pi * np.arange(sides) / sides
    ring = np.cos(angle)[:, None] * u[:, :, None, :] + np.sin(angle)[:, None] * v[:, :, None, :]
    rings = branches.points[:, :, None, :] + branches.radius[:, :, None, None] * ring
    hoops = nodes - 1 if pointed else nodes
    vertices = rings[:, :hoops].reshape(count, hoops * sides, 3)
    faces = _sides(hoops, sides)
    if pointed:
        vertices = np.concatenate([vertices, branches.points[:, -1:]], axis=1)
        k = (hoops - 1) * sides + np.arange(sides)
        after = (hoops - 1) * sides + (np.arange(sides) + 1) % sides
        tip = np.stack([k, after, np.full(sides, hoops * sides)], axis=1)
        faces = np.concatenate([faces, tip])
    per = vertices.shape[1]
    shifted = faces[None] + per * np.arange(count)[:, None, None]
    return Mesh(vertices.reshape(-1, 3), shifted.reshape(-1, 3))


def _sides(hoops: int, sides: int) -> Int64[np.ndarray, "faces 3"]:
    """Faces between consecutive hoops of one tube."""
    k, after = np.arange(sides), (np.arange(sides) + 1) % sides
    quad = np.stack([k, after, after + sides, k + sides], axis=1)
    quads = (quad[None] + sides * np.arange(hoops - 1)[:, None, None]).reshape(-1, 4)
    return np.asarray(quads[:, [0, 1, 2, 0, 2, 3]].reshape(-1, 3), np.int64)
