"""What carries what: every object has to touch the ground, directly or through others."""

from __future__ import annotations

import numpy as np
from jaxtyping import Bool, Float32, Int64
from scipy import sparse
from scipy.sparse import csgraph

from scenegen_render.audit.casting import WALKS, cast
from scenegen_render.audit.things import Things
from scenegen_render.scene import LoadedWorld

_TOUCH_M = 0.15
"""Things nearer than this touch."""
_FOUNDATION_M = 8.0
"""A foundation may reach so far down into the ground."""
_SAMPLES, _LOWEST = 28, 6
"""Corners of each object that send rays: spread over all of them, and the lowest ones."""


def carried(loaded: LoadedWorld, things: Things) -> Bool[np.ndarray, "objects"]:
    """Which objects touch the ground, directly or through others."""
    sample = np.linspace(0.0, 1.0, _SAMPLES)
    spread = things.first[:, None] + (sample * (things.count[:, None] - 1)).astype(np.int64)
    by_height = np.lexsort((things.points[:, 2], things.owner))
    low = by_height[things.first[:, None] + np.minimum(np.arange(_LOWEST), things.count[:, None] - 1)]
    chosen = np.concatenate([spread, low], axis=1)
    index = np.repeat(np.arange(len(things.id)), chosen.shape[1])
    start = things.points[chosen.ravel()]
    pairs = [np.zeros((0, 2), np.int64)]
    for direction in np.concatenate([np.eye(3), -np.eye(3)]).astype(np.float32):
        reach = _FOUNDATION_M if direction[2] > 0.5 else _TOUCH_M
        pairs.append(_touches(loaded, things, start, index, direction, reach))
    touching = np.concatenate(pairs)
    graph = sparse.coo_array(
        (np.ones(len(touching), bool), (touching[:, 0], touching[:, 1])), shape=(len(things.id),) * 2
    )
    _, component = csgraph.connected_components(graph, directed=False)
    grounded = np.zeros(component.max() + 1, bool)
    grounded[component[things.ground]] = True
    return np.asarray(grounded[component])


def _touches(
    loaded: LoadedWorld,
    things: Things,
    start: Float32[np.ndarray, "rays 3"],
    index: Int64[np.ndarray, "rays"],
    direction: Float32[np.ndarray, "3"],
    reach_m: float,
) -> Int64[np.ndarray, "pairs 2"]:
    """Pairs of objects where a short ray from one meets the other, walking through the object it starts from.

    A long ray counts only where it meets the ground from below: a foundation.
    """
    found = [np.zeros((0, 2), np.int64)]
    alive, travelled = np.arange(len(start)), np.full(len(start), -1e-3)
    for _ in range(WALKS):
        origin = start[alive] + direction * travelled[alive, None].astype(np.float32)
        distance, face = cast(loaded, origin, np.broadcast_to(direction, origin.shape))
        total = travelled[alive] + distance
        within = total < reach_m
        met = np.searchsorted(things.id, loaded.world.face_object[face[within]].astype(np.int64))
        mine = index[alive][within]
        other = met != mine
        counts = other & ((total[within] < _TOUCH_M) | things.ground[met])
        found.append(np.column_stack([mine[counts], met[counts]]))
        travelled[alive] = total + 1e-3
        alive = alive[within][~counts]
        if not len(alive):
            break
    return np.unique(np.concatenate(found), axis=0)
