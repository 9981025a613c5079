"""How high the mesh of the ground lies, where its triangles are too coarse to follow the relief."""

from __future__ import annotations

import numpy as np
import shapely
from jaxtyping import Bool, Float64

from scenegen.geometry.part import Part
from scenegen.geometry.relief import Relief


def mesh_heights(
    ground: Part,
    asked: Bool[np.ndarray, "faces"],
    xy: Float64[np.ndarray, "points 2"],
    relief: Relief,
) -> Float64[np.ndarray, "points"]:
    """Height [m] of the highest triangle over each point; of the relief where there is none.

    Parameters
    ----------
    ground : Part
    asked : bool (faces,)
        Triangles to look at: the fewer, the faster.
    xy : float64 (points, 2)
    relief : callable
    """
    corners = ground.vertices[ground.faces[asked]]
    a, b, c = (corners[:, k] for k in range(3))
    doubled = _cross(b - a, c - a)
    corners, doubled = corners[np.abs(doubled) > 1e-6], doubled[np.abs(doubled) > 1e-6]
    face, point = shapely.STRtree(shapely.points(xy)).query(
        shapely.polygons(corners[..., :2]), predicate="intersects"
    )
    a, b, c = (corners[face, k] for k in range(3))
    out = np.column_stack([xy[point], np.zeros(len(point))]) - a
    u, v = _cross(out, c - a) / doubled[face], _cross(b - a, out) / doubled[face]
    height = a[:, 2] + u * (b - a)[:, 2] + v * (c - a)[:, 2]
    found = np.full(len(xy), -np.inf)
    np.maximum.at(found, point, height)
    return np.where(np.isfinite(found), found, relief(xy))


def _cross(u: np.ndarray, v: np.ndarray) -> np.ndarray:
    """Third component of the cross product, of the plan alone."""
    return np.asarray(u[:, 0] * v[:, 1] - u[:, 1] * v[:, 0])
