"""How the mesh of the ground lies where its triangles are too coarse to follow the relief: what stands there, stands
on triangles.
"""

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
    doubled = _doubled(*corners.swapaxes(0, 1))
    corners, doubled = corners[np.abs(doubled) > 1e-6], doubled[np.abs(doubled) > 1e-6]
    point, face = _tree_of(corners).query(shapely.points(xy), predicate="intersects")
    a, b, c = (corners[face, k] for k in range(3))
    u, v = _doubled(a, xy[point], c) / doubled[face], _doubled(a, b, xy[point]) / doubled[face]
    height = a[:, 2] + u * (b - a)[:, 2] + v * (c - a)[:, 2]
    found = np.full(len(xy), -np.inf)
    np.maximum.at(found, point, height)
    return np.where(np.isfinite(found), found, relief(xy))


def mesh_slopes(
    corners: Float64[np.ndarray, "faces 3 3"], xy: Float64[np.ndarray, "points 2"]
) -> tuple[Float64[np.ndarray, "points"], Float64[np.ndarray, "points"]]:
    """Height [m] and slope of the triangle over each point; endlessly steep, at height 0, where there is none.

    Parameters
    ----------
    corners : float64 (faces, 3, 3)
        Of triangles none of which stands upright.
    xy : float64 (points, 2)
    """
    point, face = _tree_of(corners).query(shapely.points(xy), predicate="within")
    a, b, c = (corners[face, k] for k in range(3))
    normal = np.cross(b - a, c - a)
    aside = ((xy[point] - a[:, :2]) * normal[:, :2]).sum(axis=1)
    height, slope = np.zeros(len(xy)), np.full(len(xy), np.inf)
    height[point] = a[:, 2] - aside / normal[:, 2]
    slope[point] = np.hypot(normal[:, 0], normal[:, 1]) / np.abs(normal[:, 2])
    return height, slope


def draped(corners: Float64[np.ndarray, "faces 3 2"], relief: Relief) -> Relief:
    """Return a relief as triangles have it whose corners lie on it; beside them it stays what it is.

    Parameters
    ----------
    corners : float64 (faces, 3, 2)
        Of triangles in the plan that share no area.
    relief : callable
    """
    tree = _tree_of(corners)

    def height(xy: Float64[np.ndarray, "points 2"]) -> Float64[np.ndarray, "points"]:
        result = relief(xy)
        point, face = tree.query(shapely.points(xy), predicate="intersects")
        a, b, c = (corners[face, k] for k in range(3))
        share = [_doubled(p, q, xy[point]) / _doubled(a, b, c) for p, q in ((b, c), (c, a), (a, b))]
        result[point] = sum(w * relief(v) for w, v in zip(share, (a, b, c), strict=True))
        return result

    return height


def _tree_of(corners: np.ndarray) -> shapely.STRtree:
    """Plans of triangles, to ask which lie over a point."""
    return shapely.STRtree(shapely.polygons(corners[..., :2]))


def _doubled(a: np.ndarray, b: np.ndarray, c: np.ndarray) -> np.ndarray:
    """Twice the signed area of the plans of triangles."""
    return np.asarray((b[:, 0] - a[:, 0]) * (c[:, 1] - a[:, 1]) - (b[:, 1] - a[:, 1]) * (c[:, 0] - a[:, 0]))
