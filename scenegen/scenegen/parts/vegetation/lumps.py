"""Thermal sites of a crown: few, outside all of its leaves, each looking away from the crown.

A site lies on a plane that touches the crown and has all of it behind (a supporting plane), so no ray of its hemisphere
meets the leaves it stands for. Affine copies keep that property, whatever the scale.
"""

from __future__ import annotations

import numpy as np
from jaxtyping import Float64, Int64

from scenegen.geometry.modelling import Modeller
from scenegen.geometry.part import LUMP_STANDOFF_M
from scenegen.parts.vegetation.branches import unit
from scenegen.parts.vegetation.mesh import Mesh

_OUTSIDE = 2e-3
_UNDER, _UNDER_STANDOFF_M, _BESIDE_TRUNK = -0.99, 0.06, 0.45
"""What looks down starts close to the ground and beside the trunk: neither may be between it and the ground."""
_FACING, _MOTTLE = 0.30, 0.16
"""How much the way a card looks, and chance, count against where it sits, when it takes its site."""
_INNER = 0.52
"""Share of the crown's radius inside which leaves are in the shade of the others."""


def ring(count: int, elevation_deg: float, turn: float = 0.0) -> Float64[np.ndarray, "count 3"]:
    """Directions around the horizon at one elevation; `turn` in steps."""
    angle = 2 * np.pi * (np.arange(count) + turn) / count
    level, up = np.cos(np.deg2rad(elevation_deg)), np.sin(np.deg2rad(elevation_deg))
    return np.column_stack([level * np.cos(angle), level * np.sin(angle), np.full(count, up)])


UP, DOWN = np.array([[0.0, 0.0, 1.0]]), np.array([[0.0, 0.0, -1.0]])
CROWN = np.concatenate([UP, ring(4, 38.0), ring(4, -4.0, 0.5), DOWN])
"""Top, four upper and four lower sides, and last the shaded inside and underside."""
BARE = np.concatenate([UP, ring(4, 8.0), DOWN])
"""Sides of limbs: top, four sides, underside."""


def supports(
    model: Modeller, points: Float64[np.ndarray, "points 3"], directions: Float64[np.ndarray, "sites 3"]
) -> int:
    """Add a site at the outermost of the points in each direction; returns the index of the first."""
    places = points[np.argmax(points @ directions.T, axis=0)] + _OUTSIDE * directions
    under = directions[:, 2] < _UNDER
    reach = np.abs(points[:, :2]).max()
    places[under, :2] = _BESIDE_TRUNK * reach * np.array([0.8, 0.6])
    standoff = np.where(under, _UNDER_STANDOFF_M, LUMP_STANDOFF_M)
    made = [model.site(p, d, float(s)) for p, d, s in zip(places, directions, standoff, strict=True)]
    return made[0]


def crown_sites(
    leaves: Mesh, directions: Float64[np.ndarray, "sites 3"], rng: np.random.Generator, card_faces: int = 1
) -> Int64[np.ndarray, "faces"]:
    """Which direction each face of a crown belongs to: by its place, a little by its slope, and by chance.

    Leaves deep inside belong to the last direction, the underside: they are as shaded.

    Parameters
    ----------
    leaves : Mesh
    directions : float64 (sites, 3)
        Of the crown's sites, the underside last.
    rng : numpy.random.Generator
    card_faces : int
        Consecutive faces that stay together.
    """
    vertices, corners = leaves.vertices, leaves.corners()
    middle = corners.mean(axis=1).reshape(-1, card_faces, 3).mean(axis=1)
    normal = unit(np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0]))
    normal = unit(normal.reshape(-1, card_faces, 3).mean(axis=1))
    low, high = vertices.min(axis=0), vertices.max(axis=0)
    place = (middle - 0.5 * (low + high)) / np.maximum(0.5 * (high - low), 1e-9)
    depth = np.linalg.norm(place, axis=1)
    outward = unit(place)
    normal *= np.where((normal * outward).sum(axis=1, keepdims=True) < 0.0, -1.0, 1.0)
    looks = unit(outward + _FACING * normal + rng.normal(0.0, _MOTTLE, place.shape))
    chosen = np.argmax(looks @ directions.T, axis=1)
    inner = depth < _INNER * rng.uniform(0.7, 1.2, len(depth))
    return np.repeat(np.where(inner, len(directions) - 1, chosen), card_faces)


def wood_sites(wood: Mesh, directions: Float64[np.ndarray, "sites 3"]) -> Int64[np.ndarray, "faces"]:
    """Which direction each face of wood looks in: every branch has its own sunny side."""
    corners = wood.corners()
    normal = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
    return np.asarray(np.argmax(unit(normal) @ directions.T, axis=1))


def thrice(site: Int64[np.ndarray, "faces"]) -> Int64[np.ndarray, "faces 3"]:
    """The same site for all corners of a face."""
    return np.repeat(site[:, None], 3, axis=1)
