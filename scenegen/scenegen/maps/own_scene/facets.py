"""Which triangles make up one surface: neighbours that meet without a crease."""

from __future__ import annotations

import math

import numpy as np
from jaxtyping import Float64, Int64
from scipy import sparse
from scipy.sparse.csgraph import connected_components

CREASE_DEG = 30.0
"""Largest angle between the normals of neighbours that still belong to one smooth surface."""


def smooth_facets(
    faces: Int64[np.ndarray, "faces 3"],
    normals: Float64[np.ndarray, "faces 3"],
    group: Int64[np.ndarray, "faces"],
) -> Int64[np.ndarray, "faces"]:
    """Number the smooth surfaces of a welded mesh.

    Parameters
    ----------
    faces : int64 (faces, 3)
    normals : float64 (faces, 3)
        Unit normals.
    group : int64 (faces,)
        Faces of different groups (objects, materials) never share a surface.

    Returns
    -------
    int64 (faces,)
        Surface of each face, 0, 1, ...
    """
    start = faces.ravel()
    end = faces[:, [1, 2, 0]].ravel()
    owner = np.repeat(np.arange(len(faces)), 3)
    code = np.minimum(start, end) * (int(faces.max(initial=0)) + 1) + np.maximum(start, end)
    order = np.argsort(code, kind="stable")
    same = code[order][1:] == code[order][:-1]
    one, two = order[:-1][same], order[1:][same]
    a, b = owner[one], owner[two]
    level = np.einsum("pk,pk->p", normals[a], normals[b]) > math.cos(math.radians(CREASE_DEG))
    # Where both run along the edge in the same direction, one of them is inside out: no surface goes on there.
    joined = level & (group[a] == group[b]) & (start[one] == end[two])
    graph = sparse.coo_array(
        (np.ones(int(joined.sum()), np.int8), (a[joined], b[joined])), shape=(len(faces),) * 2
    )
    _, label = connected_components(graph, directed=False)
    return np.asarray(label, np.int64)
