"""A mass of trees for the distance: lumpy crowns that reach into the ground, a hundred triangles and four sites."""

from __future__ import annotations

import numpy as np

from scenegen.classes import Semantic
from scenegen.geometry.modelling import Modeller
from scenegen.geometry.part import LUMP_STANDOFF_M
from scenegen.geometry.template import Template

_CROWNS, _SIDES = 6, 5
_RINGS = ((-0.06, 0.72), (0.34, 1.0), (0.78, 0.66))
"""Height and width of the rings of a crown, over its own height and radius."""

_FACING = np.array([[1.0, 1.0, 0.5], [-1.0, 1.0, 0.5], [-1.0, -1.0, 0.5], [1.0, -1.0, 0.5]])


def thicket(rng: np.random.Generator) -> Template:
    """A mass of unit diameter and unit height, standing on z = 0, reaching 0.06 below. Slot: 0 leaves."""
    model = Modeller()
    facing = _FACING / np.linalg.norm(_FACING, axis=1)[:, None]
    first = [model.site(np.array([0.0, 0.0, 0.5]) + 0.62 * d, d, LUMP_STANDOFF_M) for d in facing]
    angle = 2.4 * np.arange(_CROWNS) + rng.uniform(0.0, 2 * np.pi)
    reach = 0.33 * np.sqrt((np.arange(_CROWNS) + 0.3) / _CROWNS)
    middle = reach[:, None] * np.column_stack([np.cos(angle), np.sin(angle)])
    for xy in middle:
        points = _crown(xy, rng.uniform(0.15, 0.22), rng.uniform(0.68, 1.0), rng)
        faces = _faces()
        outward = points[faces].mean(axis=1) - np.array([0.0, 0.0, 0.4])
        site = np.array(first)[np.argmax(outward @ facing.T, axis=1)]
        model.mesh(points, faces, 0, Semantic.TREE, np.repeat(site[:, None], 3, axis=1))
    return model.finish()


def _crown(xy: np.ndarray, radius: float, height: float, rng: np.random.Generator) -> np.ndarray:
    """Rings of an uneven dome and its tip."""
    angle = 2 * np.pi * np.arange(_SIDES) / _SIDES + rng.uniform(0.0, 2 * np.pi)
    rows = []
    for z, wide in _RINGS:
        r = radius * wide * rng.uniform(0.75, 1.15, _SIDES)
        level = z * height + rng.uniform(-0.05, 0.05, _SIDES) * (z > 0.0)
        rows.append(np.column_stack([xy[0] + r * np.cos(angle), xy[1] + r * np.sin(angle), level]))
    tip = np.array([[*(xy + rng.normal(0.0, 0.15 * radius, 2)), height]])
    return np.concatenate([*rows, tip])


def _faces() -> np.ndarray:
    """Quads between rings and a fan to the tip, counter-clockwise from outside."""
    k, after = np.arange(_SIDES), (np.arange(_SIDES) + 1) % _SIDES
    rows = []
    for level in range(len(_RINGS) - 1):
        low, high = level * _SIDES, (level + 1) * _SIDES
        rows.append(np.stack([k + low, after + low, after + high], axis=1))
        rows.append(np.stack([k + low, after + high, k + high], axis=1))
    top = (len(_RINGS) - 1) * _SIDES
    rows.append(np.stack([k + top, after + top, np.full(_SIDES, len(_RINGS) * _SIDES)], axis=1))
    return np.concatenate(rows)
