"""Lofts: skins drawn over rings of points, for hulls, bodies and limbs."""

from __future__ import annotations

import numpy as np
from jaxtyping import Float64, Int64


def loft_faces(rings: int, points: int, closed: bool = True) -> Int64[np.ndarray, "faces 3"]:
    """Triangles between neighbouring rings of equally many points.

    Counter-clockwise seen from outside if rings turn counter-clockwise for somebody who stands at the last ring and
    looks back at the first.

    Parameters
    ----------
    rings, points : int
        Vertices are ordered ring by ring.
    closed : bool
        Whether the last point of a ring is joined to its first.
    """
    i = np.arange(rings - 1)[:, None] * points
    k = np.arange(points if closed else points - 1)[None]
    a, b = i + k, i + (k + 1) % points
    quads = np.stack([a, b, b + points, a + points], axis=-1).reshape(-1, 4)
    return quads[:, [0, 1, 2, 0, 2, 3]].reshape(-1, 3)


def fan_faces(points: int, first: int = 0, flip: bool = False) -> Int64[np.ndarray, "faces 3"]:
    """A lid over one ring, as a fan around its first point."""
    k = np.arange(1, points - 1)
    fan = first + np.stack([np.zeros_like(k), k, k + 1], axis=1)
    return fan[:, ::-1] if flip else fan


def oval_rings(
    centre: Float64[np.ndarray, "rings 3"],
    side: Float64[np.ndarray, "3"],
    radii: Float64[np.ndarray, "rings 2"],
    points: int,
) -> Float64[np.ndarray, "rings points 3"]:
    """Oval rings along a bent axis; planes halve the angle at each bend.

    Parameters
    ----------
    centre : float64 (rings, 3)
        Along the axis [m].
    side : float64 (3,)
        Direction of the first radius, made square to the axis.
    radii : float64 (rings, 2)
        Along `side` and across it [m].
    points : int
        Per ring; the first lies on the side.
    """
    step = np.diff(centre, axis=0)
    step /= np.linalg.norm(step, axis=1)[:, None]
    axis = np.concatenate([step[:1], step[:-1] + step[1:], step[-1:]])
    axis /= np.linalg.norm(axis, axis=1)[:, None]
    first = side - (axis @ side)[:, None] * axis
    first /= np.linalg.norm(first, axis=1)[:, None]
    second = np.cross(axis, first)
    angle = 2 * np.pi * np.arange(points) / points
    along = (radii[:, :1] * np.cos(angle))[..., None] * first[:, None]
    return np.asarray(centre[:, None] + along + (radii[:, 1:] * np.sin(angle))[..., None] * second[:, None])
