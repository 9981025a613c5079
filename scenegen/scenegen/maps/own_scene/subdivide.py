"""Cutting large triangles, so that heat has places to live.

Edges are halved until they are as short as they should be where they lie, or until the triangles on both sides are so
small that cutting gains nothing: thin slivers stay long. Both triangles of an edge are cut at the same point, so that
neighbours keep sharing vertices and no ray slips through between them.
"""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
from jaxtyping import Bool, Float64, Int64

from scenegen.geometry.part import face_areas

_MAX_ROUNDS = 40
_SMALL = 0.25
"""Area, in squares of the longest edge allowed, below which a triangle is not cut for its own sake."""

Longest = Callable[[Float64[np.ndarray, "edges 3"]], Float64[np.ndarray, "edges"]]
"""Longest edge allowed [m] at the middles of edges: a function of the place alone, so that neighbours agree."""


def subdivide(
    vertices: Float64[np.ndarray, "vertices 3"],
    faces: Int64[np.ndarray, "faces 3"],
    longest: Longest,
    most: int,
) -> tuple[Float64[np.ndarray, "more 3"], Int64[np.ndarray, "cut 3"], Int64[np.ndarray, "cut"]] | None:
    """Halve edges that are longer than allowed; None if that makes more than `most` faces.

    Returns
    -------
    vertices : float64 (more, 3)
        The given ones first.
    faces : int64 (cut, 3)
        Same orientation as before; in the order of the faces they come from.
    parent : int64 (cut,)
        The face each one is a piece of.
    """
    parent = np.arange(len(faces))
    done_faces, done_parents = [], []
    done = 0
    for _ in range(_MAX_ROUNDS):
        corners = vertices[faces]
        length = np.linalg.norm(corners[:, [1, 2, 0]] - corners, axis=2)
        middle = (corners[:, [1, 2, 0]] + corners) / 2
        allowed = longest(middle.reshape(-1, 3)).reshape(-1, 3)
        area = face_areas(vertices, faces)
        long = _worth_it(faces, length > allowed, area[:, None] > _SMALL * allowed**2)
        active = long.any(axis=1)
        done_faces.append(faces[~active])
        done_parents.append(parent[~active])
        if not active.any():
            break
        vertices, faces, pieces = _halve(vertices, faces[active], long[active])
        parent = parent[active][pieces]
        done += int((~active).sum())
        if done + len(faces) > most:
            return None
    else:
        done_faces.append(faces)
        done_parents.append(parent)
    parent = np.concatenate(done_parents)
    order = np.argsort(parent, kind="stable")
    return vertices, np.concatenate(done_faces)[order], parent[order]


def _worth_it(
    faces: Int64[np.ndarray, "faces 3"], long: Bool[np.ndarray, "faces 3"], large: Bool[np.ndarray, "faces 3"]
) -> Bool[np.ndarray, "faces 3"]:
    """Long edges with a large triangle on at least one side; both sides agree."""
    code = _edge_codes(faces, int(faces.max(initial=0)) + 1)[long]
    _, which = np.unique(code, return_inverse=True)
    gains = np.bincount(which.ravel(), large[long]) > 0
    worth = np.zeros_like(long)
    worth[long] = gains[which.ravel()]
    return worth


def _edge_codes(faces: Int64[np.ndarray, "faces 3"], count: int) -> Int64[np.ndarray, "faces 3"]:
    """One number for each edge, whichever way round; `count` vertices."""
    ends = np.sort(np.stack([faces, faces[:, [1, 2, 0]]], axis=2), axis=2)
    return np.asarray(ends[..., 0] * count + ends[..., 1])


def _halve(
    vertices: Float64[np.ndarray, "vertices 3"],
    faces: Int64[np.ndarray, "faces 3"],
    long: Bool[np.ndarray, "faces 3"],
) -> tuple[Float64[np.ndarray, "more 3"], Int64[np.ndarray, "cut 3"], Int64[np.ndarray, "cut"]]:
    """Cut every long edge once; returns vertices, faces and the face each one comes from."""
    code = _edge_codes(faces, len(vertices))
    cut, which = np.unique(code[long], return_inverse=True)
    middle = np.full(faces.shape, -1, np.int64)
    middle[long] = len(vertices) + which
    a, b = np.divmod(cut, len(vertices))
    vertices = np.concatenate(
        [vertices, ((vertices[a] + vertices[b]) / 2).astype(np.float32).astype(np.float64)]
    )
    count = long.sum(axis=1)
    pieces, owners = [], []
    for cuts, pattern in ((1, _one), (2, _two), (3, _three)):
        chosen = np.flatnonzero(count == cuts)
        # Turned so that the first `cuts` edges are the long ones.
        turn = (
            np.argmax(long[chosen], axis=1)
            if cuts == 1
            else np.argmin(long[chosen], axis=1) + 1
            if cuts == 2
            else 0
        )
        columns = (np.arange(3) + np.broadcast_to(turn, len(chosen))[:, None]) % 3
        new = pattern(faces[chosen[:, None], columns], middle[chosen[:, None], columns], vertices)
        pieces.append(new.reshape(-1, 3))
        owners.append(np.repeat(chosen, new.shape[1]))
    return vertices, np.concatenate(pieces), np.concatenate(owners)


def _one(v: np.ndarray, m: np.ndarray, _: np.ndarray) -> np.ndarray:
    """Two pieces of triangles whose first edge is cut."""
    return np.stack([_triangle(v[:, 0], m[:, 0], v[:, 2]), _triangle(m[:, 0], v[:, 1], v[:, 2])], axis=1)


def _two(v: np.ndarray, m: np.ndarray, vertices: np.ndarray) -> np.ndarray:
    """Three pieces of triangles whose first two edges are cut; the quadrangle is cut along its shorter diagonal."""
    one = np.linalg.norm(vertices[v[:, 0]] - vertices[m[:, 1]], axis=1)
    other = np.linalg.norm(vertices[m[:, 0]] - vertices[v[:, 2]], axis=1)
    short = (one <= other)[:, None]
    left = np.where(short, _triangle(v[:, 0], m[:, 0], m[:, 1]), _triangle(v[:, 0], m[:, 0], v[:, 2]))
    right = np.where(short, _triangle(v[:, 0], m[:, 1], v[:, 2]), _triangle(m[:, 0], m[:, 1], v[:, 2]))
    return np.stack([_triangle(m[:, 0], v[:, 1], m[:, 1]), left, right], axis=1)


def _three(v: np.ndarray, m: np.ndarray, _: np.ndarray) -> np.ndarray:
    """Four pieces of triangles whose edges are all cut."""
    return np.stack(
        [
            _triangle(v[:, 0], m[:, 0], m[:, 2]),
            _triangle(m[:, 0], v[:, 1], m[:, 1]),
            _triangle(m[:, 2], m[:, 1], v[:, 2]),
            _triangle(m[:, 0], m[:, 1], m[:, 2]),
        ],
        axis=1,
    )


def _triangle(a: np.ndarray, b: np.ndarray, c: np.ndarray) -> np.ndarray:
    return np.stack([a, b, c], axis=1)
