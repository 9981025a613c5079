"""Leaf cards: folded rhombi that stand for a spray of leaves, seen from both sides."""

from __future__ import annotations

import numpy as np
from jaxtyping import Float64

from scenegen.parts.vegetation.branches import across, unit
from scenegen.parts.vegetation.tubes import Mesh

_WIDEST = 0.45
_FOLD = 0.35


def cards(
    base: Float64[np.ndarray, "cards 3"],
    along: Float64[np.ndarray, "cards 3"],
    facing: Float64[np.ndarray, "cards 3"],
    length: Float64[np.ndarray, "cards"],
    width: Float64[np.ndarray, "cards"],
) -> Mesh:
    """Rhombi from `base` in direction `along`, folded along their midrib; two faces and four vertices each.

    Parameters
    ----------
    base, along : float64 (cards, 3)
        Foot and direction of the midrib.
    facing : float64 (cards, 3)
        Where the upper side looks; made perpendicular to `along`.
    length, width : float64 (cards,)
    """
    along = unit(along)
    normal = facing - (facing * along).sum(axis=1, keepdims=True) * along
    flat = (normal**2).sum(axis=1, keepdims=True) < 1e-6
    normal = unit(np.where(flat, across(along), normal))
    side = np.cross(normal, along)
    half = 0.5 * width[:, None]
    rib = base + _WIDEST * length[:, None] * along
    fold = _FOLD * half * normal
    corners = np.stack(
        [base, rib - half * side - fold, base + length[:, None] * along, rib + half * side - fold], axis=1
    )
    first = 4 * np.arange(len(base))[:, None]
    faces = (first + np.array([0, 1, 2, 0, 2, 3])).reshape(-1, 3)
    return corners.reshape(-1, 3), faces
