"""A mass of trees for the distance: lumpy crowns that reach into the ground, and four sites."""

from __future__ import annotations

import numpy as np

from scenegen.classes import Semantic
from scenegen.geometry.modelling import Modeller
from scenegen.geometry.part import LUMP_STANDOFF_M
from scenegen.geometry.template import Template

_SIDES = 5
_FINE = ((-0.1, 0.34), (0.34, 1.0), (0.78, 0.66))
_COARSE = ((-0.1, 0.42), (0.6, 1.0))
"""Height and width of the rings of a crown, over its own height and radius."""

_FACING = np.array([[1.0, 1.0, 0.5], [-1.0, 1.0, 0.5], [-1.0, -1.0, 0.5], [1.0, -1.0, 0.5]])


def thicket(rng: np.random.Generator, fine: bool) -> Template:
    """A mass of unit diameter and unit height, standing on z = 0, reaching 0.1 below. Slot: 0 leaves.

    The fine one has 150 triangles, the coarse one 75.
    """
    model, rings, crowns = Modeller(), _FINE if fine else _COARSE, 6 if fine else 5
    facing = _FACING / np.linalg.norm(_FACING, axis=1)[:, None]
    first = [model.site(np.array([0.0, 0.0, 0.5]) + 0.62 * d, d, LUMP_STANDOFF_M) for d in facing]
    angle = 2.4 * np.arange(crowns) + rng.uniform(0.0, 2 * np.pi)
    reach = 0.27 * np.sqrt((np.arange(crowns) + 0.3) / crowns)
    middle = reach[:, None] * np.column_stack([np.cos(angle), np.sin(angle)])
    for xy in middle:
        points = _crown(xy, rng.uniform(0.15, 0.22), rng.uniform(0.68, 1.0), rings, rng)
        faces = _faces(len(rings))
        outward = points[faces].mean(axis=1) - np.array([0.0, 0.0, 0.4])
        site = np.array(first)[np.argmax(outward @ facing.T, axis=1)]
        model.mesh(points, faces, 0, Semantic.TREE, np.repeat(site[:, None], 3, axis=1))
    return model.finish()


def _crown(
    xy: np.ndarray,
    radius: float,
    height: float,
    rings: tuple[tuple[float, float], ...],
    rng: np.random.Generator,
) -> np.ndarray:
    """Rings of an uneven dome and its tip."""
    angle = 2 * np.pi * np.arange(_SIDES) / _SIDES + rng.uniform(0.0, 2 * np.pi)
    rows = []
    for z, wide in rings:
        r = radius * wide * rng.uniform(0.75, 1.15, _SIDES)
        level = z * height + rng.uniform(-0.05, 0.05, _SIDES) * (z > 0.0)
        rows.append(np.column_stack([xy[0] + r * np.cos(angle), xy[1] + r * np.sin(angle), level]))
    tip = np.array([[*(xy + rng.normal(0.0, 0.15 * radius, 2)), height]])
    return np.concatenate([*rows, tip])


def _faces(rings: int) -> np.ndarray:
    """Quads between rings and a fan to the tip, counter-clockwise from outside."""
    k, after = np.arange(_SIDES), (np.arange(_SIDES) + 1) % _SIDES
    rows = []
    for level in range(rings - 1):
        low, high = level * _SIDES, (level + 1) * _SIDES
        rows.append(np.stack([k + low, after + low, after + high], axis=1))
        rows.append(np.stack([k + low, after + high, k + high], axis=1))
    top = (rings - 1) * _SIDES
    rows.append(np.stack([k + top, after + top, np.full(_SIDES, rings * _SIDES)], axis=1))
    return np.concatenate(rows)
