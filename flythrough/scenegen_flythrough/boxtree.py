"""A tree of bounding boxes over triangles, eight children to a node, built and searched with whole arrays.

Triangles are sorted along a space-filling curve and every run of eight becomes a node, every eight nodes a node above.
The tree has no pointers: the children of node ``k`` are ``8 k .. 8 k + 7`` one level below. Against a uniform grid it
needs no cell size, stores every triangle once however long it is, and finds the nearest triangle from any distance.
"""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np
from jaxtyping import Float32, Float64, Int64, UInt64

from scenegen.world import TriangleMesh

FAN_OUT = 8
_TOP = 32  # nodes that may stay at the top: below this, one more level costs more than it prunes
_BITS = 16  # per axis of the space-filling curve


class BoxTree:
    """Bounding boxes over the triangles of a mesh.

    Attributes
    ----------
    face : int64 (triangles,)
        Mesh face of each triangle in tree order.
    corners : float32 (triangles, 3, 3)
        Corners in tree order, exactly the mesh's numbers.
    levels : list of (float32 (nodes, 3), float32 (nodes, 3))
        Lower and upper corners of the boxes; level 0 holds the triangles' own boxes.
    """

    def __init__(self, mesh: TriangleMesh) -> None:
        count = len(mesh.faces)
        self.face: Int64[np.ndarray, "triangles"] = np.argsort(_keys(mesh), kind="stable")
        self.corners: Float32[np.ndarray, "triangles 3 3"] = np.empty((count, 3, 3), np.float32)
        low, high = np.empty((count, 3), np.float32), np.empty((count, 3), np.float32)
        for part in parts(count):
            self.corners[part] = mesh.vertices[mesh.faces[self.face[part]]]
            low[part], high[part] = _bounds(self.corners[part])
        self.levels = [(low, high)]
        while len(low) > _TOP:
            runs = np.arange(0, len(low), FAN_OUT)
            low, high = np.minimum.reduceat(low, runs), np.maximum.reduceat(high, runs)
            self.levels.append((low, high))

    def within(
        self,
        low: Float64[np.ndarray, "queries 3"],
        high: Float64[np.ndarray, "queries 3"],
        reach2: Float64[np.ndarray, "queries"],
    ) -> tuple[Int64[np.ndarray, "pairs"], Int64[np.ndarray, "pairs"]]:
        """Pairs (query, triangle) that may be the nearest and no further apart than sqrt(`reach2`), by query.

        Where `reach2` is infinite, the search shrinks it on the way down: the furthest corner of any box met so far
        bounds the distance from above.
        """
        top = len(self.levels[-1][0])
        query = np.repeat(np.arange(len(low)), top)
        node = np.tile(np.arange(top), len(low))
        # Boxes and squares are rounded in the last digits: what lies on the edge must stay.
        bound2 = reach2 * (1.0 + 1e-9) + 1e-12
        shrink = bool(np.isinf(reach2).any())
        for level in range(len(self.levels) - 1, -1, -1):
            node_low, node_high = self.levels[level][0][node], self.levels[level][1][node]
            ahead, behind = node_low - high[query], low[query] - node_high
            if shrink:
                far2 = _square(np.maximum(-ahead, -behind))
                np.minimum.at(bound2, query, far2 * (1.0 + 1e-9))
            near = _square(np.maximum(np.maximum(ahead, behind), 0.0)) <= bound2[query]
            query, node = query[near], node[near]
            if level > 0:
                query = np.repeat(query, FAN_OUT)
                node = (node[:, None] * FAN_OUT + np.arange(FAN_OUT)).ravel()
                real = node < len(self.levels[level - 1][0])
                query, node = query[real], node[real]
        return query, node


def _square(v: Float64[np.ndarray, "pairs 3"]) -> Float64[np.ndarray, "pairs"]:
    return np.asarray(v[:, 0] ** 2 + v[:, 1] ** 2 + v[:, 2] ** 2)


def _bounds(
    corners: Float32[np.ndarray, "triangles 3 3"],
) -> tuple[Float32[np.ndarray, "triangles 3"], Float32[np.ndarray, "triangles 3"]]:
    a, b, c = corners[:, 0], corners[:, 1], corners[:, 2]
    return np.minimum(np.minimum(a, b), c), np.maximum(np.maximum(a, b), c)


def parts(count: int) -> Iterator[slice]:
    """Ranges that keep a step's arrays in the cache: fresh pages cost more than the arithmetic."""
    return (slice(first, first + 65_536) for first in range(0, count, 65_536))


def _keys(mesh: TriangleMesh) -> UInt64[np.ndarray, "triangles"]:
    """Sort key: size class first, then Morton order of the box centres.

    One long wall among window panes would blow up the box of every node above it; triangles of one size class (a
    factor of eight) share their nodes with their like.
    """
    keys = np.empty(len(mesh.faces), np.uint64)
    if len(keys) == 0:
        return keys
    origin = mesh.vertices.min(axis=0)
    scale = (2**_BITS - 1) / max(float((mesh.vertices.max(axis=0) - origin).max()), 1e-6)
    for part in parts(len(keys)):
        low, high = _bounds(mesh.vertices[mesh.faces[part]])
        # Column by column: numpy reduces an axis of length three an order of magnitude more slowly.
        size = np.maximum(np.maximum(high[:, 0] - low[:, 0], high[:, 1] - low[:, 1]), high[:, 2] - low[:, 2])
        key = (np.log2(np.clip(size, 1e-6, 1e6)) / 3.0 + 8.0).astype(np.uint64) << np.uint64(3 * _BITS)
        for axis in range(3):
            centre = 0.5 * (low[:, axis].astype(np.float64) + high[:, axis])
            grid = ((centre - origin[axis]) * scale).astype(np.uint64)
            key |= _spread(np.minimum(grid, np.uint64(2**_BITS - 1))) << np.uint64(axis)
        keys[part] = key
    return keys


def _spread(x: UInt64[np.ndarray, "n"]) -> UInt64[np.ndarray, "n"]:
    """Move the 16 low bits of each number three apart."""
    for shift, mask in ((16, 0x0000FF0000FF), (8, 0x00F00F00F00F), (4, 0x0C30C30C30C3), (2, 0x249249249249)):
        x = (x | (x << np.uint64(shift))) & np.uint64(mask)
    return x
