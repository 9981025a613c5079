"""The ground of a scene that has no word for it: what a drone measures its height from."""

from __future__ import annotations

import numpy as np
from jaxtyping import Bool, Float64, Int64, UInt8
from scipy.ndimage import distance_transform_edt

from scenegen.classes import SOLID_GROUND, Semantic
from scenegen.geometry.ragged import ragged_grid
from scenegen.world import HeightField

_ENOUGH = 0.2
"""Share of the plan that faces of ground classes must cover to be taken for the whole ground."""

_FINEST_M = 1.0
_MOST_NODES_A_SIDE = 500
_BLOCK = 100_000
_LEVEL = 0.5
"""Least upward part of the normal of what can be stood on."""


def ground_field(
    vertices: Float64[np.ndarray, "vertices 3"],
    faces: Int64[np.ndarray, "faces 3"],
    normals: Float64[np.ndarray, "faces 3"],
    semantic: UInt8[np.ndarray, "faces"],
) -> HeightField:
    """The lowest surface that looks up, at every node of a grid over the scene.

    Land is preferred to water, which often goes on below it, and faces of ground classes to all others, if there are
    enough of them: under a building without a floor, the ground is that of its neighbourhood and not its roof. Nodes
    above nothing take the height of the nearest node above something.

    Parameters
    ----------
    vertices : float64 (vertices, 3)
        [m].
    faces : int64 (faces, 3)
        Not much larger than a few cells, for speed.
    normals : float64 (faces, 3)
    semantic : uint8 (faces,)
    """
    low, high = vertices[:, :2].min(axis=0), vertices[:, :2].max(axis=0)
    cell = max(_FINEST_M, float((high - low).max()) / _MOST_NODES_A_SIDE)
    columns, rows = (np.floor((high - low) / cell).astype(int) + 2).tolist()
    up = normals[:, 2] > _LEVEL
    water = semantic == Semantic.WATER
    ground = np.isin(semantic, SOLID_GROUND)

    def lowest(chosen: Bool[np.ndarray, "faces"]) -> Float64[np.ndarray, "rows columns"]:
        return _lowest(vertices, faces[chosen], low, cell, (rows, columns))

    height = lowest(up & ground)
    if np.isfinite(height).mean() < _ENOUGH:
        height = lowest(up & ~water)
    height = np.where(np.isfinite(height), height, lowest(up & water))
    known = np.isfinite(height)
    if not known.any():
        height, known = np.full((rows, columns), float(vertices[:, 2].min())), ~known
    nearest = distance_transform_edt(~known, return_distances=False, return_indices=True)
    filled = height[tuple(nearest)].astype(np.float32)
    return HeightField((float(low[0]), float(low[1])), cell, filled)


def _lowest(
    vertices: Float64[np.ndarray, "vertices 3"],
    faces: Int64[np.ndarray, "faces 3"],
    low: Float64[np.ndarray, "2"],
    cell: float,
    shape: tuple[int, int],
) -> Float64[np.ndarray, "rows columns"]:
    """Height of the lowest face above or below each node; infinite where there is none."""
    height = np.full(shape[0] * shape[1], np.inf)
    for start in range(0, len(faces), _BLOCK):
        corners = vertices[faces[start : start + _BLOCK]]
        plan = (corners[:, :, :2] - low) / cell
        first = np.ceil(plan.min(axis=1) - 1e-6).astype(np.int64)
        count = np.maximum(np.floor(plan.max(axis=1) + 1e-6).astype(np.int64) - first + 1, 0)
        face, i, j = ragged_grid(count[:, 0], count[:, 1])
        node = np.stack([first[face, 0] + i, first[face, 1] + j], axis=1)
        a, b, c = (plan[face, k] for k in range(3))
        whole = _cross(b - a, c - a)
        v, w = _cross(node - a, c - a) / whole, _cross(b - a, node - a) / whole
        hit = (v >= -1e-6) & (w >= -1e-6) & (v + w <= 1.0 + 1e-6)
        z = corners[:, :, 2][face]
        z = z[:, 0] + v * (z[:, 1] - z[:, 0]) + w * (z[:, 2] - z[:, 0])
        np.minimum.at(height, node[hit, 1] * shape[1] + node[hit, 0], z[hit])
    return height.reshape(shape)


def _cross(p: np.ndarray, q: np.ndarray) -> np.ndarray:
    return np.asarray(p[:, 0] * q[:, 1] - p[:, 1] * q[:, 0])
