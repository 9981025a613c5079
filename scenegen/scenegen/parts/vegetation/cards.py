"""Leaf sprays: two ragged triangles from one foot that stand for a twig's end with its leaves, seen from both sides."""

from __future__ import annotations

import numpy as np
from jaxtyping import Float64

from scenegen.parts.vegetation.branches import across, unit
from scenegen.parts.vegetation.mesh import Mesh

_STAR = np.array([[0.0, 0.0], [0.97, 0.20], [0.45, 0.58], [0.80, -0.42], [0.24, -0.55]])
"""Corners of a spray of unit length, along and across: a notch in the middle, no two edges alike."""
_FOLD = 0.4
FACES = 2
"""Triangles of a spray."""
SPRAY_AREA = 0.5 * (
    abs(_STAR[1, 0] * _STAR[2, 1] - _STAR[2, 0] * _STAR[1, 1])
    + abs(_STAR[3, 0] * _STAR[4, 1] - _STAR[4, 0] * _STAR[3, 1])
)
"""Area of a spray of unit length and width, unfolded."""


def sprays(
    base: Float64[np.ndarray, "sprays 3"],
    along: Float64[np.ndarray, "sprays 3"],
    facing: Float64[np.ndarray, "sprays 3"],
    length: Float64[np.ndarray, "sprays"],
    slender: float,
) -> Mesh:
    """Sprays from `base` in direction `along`; two faces and five vertices each, every other one mirrored.

    Parameters
    ----------
    base, along : float64 (sprays, 3)
        Foot and direction.
    facing : float64 (sprays, 3)
        Where the upper side looks; made perpendicular to `along`.
    length : float64 (sprays,)
    slender : float
        Length over width.
    """
    along = unit(along)
    normal = facing - (facing * along).sum(axis=1, keepdims=True) * along
    flat = (normal**2).sum(axis=1, keepdims=True) < 1e-6
    normal = unit(np.where(flat, across(along), normal))
    hand = np.where(np.arange(len(base)) % 2 == 0, 1.0, -1.0)[:, None]
    side = hand * np.cross(normal, along)
    out, wide = _STAR[:, 0], _STAR[:, 1] / slender
    corners = (
        out[:, None] * along[:, None, :]
        + wide[:, None] * side[:, None, :]
        - _FOLD * np.abs(wide)[:, None] * normal[:, None, :]
    )
    corners = base[:, None, :] + length[:, None, None] * corners
    faces = (5 * np.arange(len(base))[:, None] + np.array([0, 1, 2, 0, 4, 3])).reshape(-1, 3)
    return Mesh(corners.reshape(-1, 3), faces)


def moved_by(mesh: Mesh, shift: Float64[np.ndarray, "sprays 3"]) -> Mesh:
    """Each spray moved as a whole."""
    return Mesh(mesh.vertices + np.repeat(shift, 5, axis=0), mesh.faces)


def middles(mesh: Mesh) -> Float64[np.ndarray, "sprays 3"]:
    """Middle of each spray."""
    return np.asarray(mesh.vertices.reshape(-1, 5, 3).mean(axis=1))
