"""Feather palms: a curved trunk, and fronds whose leaflets hang in a V from an arching rachis."""

from __future__ import annotations

import numpy as np

from scenegen.parts.vegetation.branches import GOLDEN_RAD, Branches, sprout, unit
from scenegen.parts.vegetation.growth import Grown, Plan
from scenegen.parts.vegetation.habits import Feather
from scenegen.parts.vegetation.mesh import NOTHING, Mesh, merged
from scenegen.parts.vegetation.tubes import tubes

_FOOT = -0.03
_FULL_FACES = 1500
_NODES = 7
_SHAFT = 0.86
"""Height of the trunk under the fronds, before the palm is brought to unit height."""


def grow(species: Feather, plan: Plan, rng: np.random.Generator) -> Grown:
    """Grow one palm of about unit height."""
    q = (plan.faces / _FULL_FACES) ** 0.5
    trunk = _trunk(species, rng)
    fronds = _fronds(species, trunk.points[0, -1], max(13, round(species.fronds * min(q, 1.2))), rng)
    leaflets = max(7, round(species.leaflets * min(q, 1.3)))
    body = tubes(trunk, 6, False)
    stalks = tubes(Branches(fronds.points[:, [0, 3]], fronds.radius[:, [0, 3]]), 3, True)
    return Grown(body, stalks, NOTHING, merged([_leaflets(fronds, leaflets, rng), _ribs(fronds)]))


def _trunk(species: Feather, rng: np.random.Generator) -> Branches:
    turn, lean = rng.uniform(0, 2 * np.pi), rng.uniform(0.2, 1.0) * species.lean
    direction = unit(np.array([[lean * np.cos(turn), lean * np.sin(turn), 1.0]]))
    trunk = sprout(
        np.array([[0.0, 0.0, _FOOT]]), direction, np.array([_SHAFT - _FOOT]),
        (np.array([species.girth]), np.array([0.72 * species.girth])), 7, 1.2 * lean, 0.01, rng,
    )  # fmt: skip
    flare = 1.0 + 0.5 * np.exp(-np.maximum(trunk.points[..., 2], 0.0) / 0.04)
    return Branches(trunk.points, trunk.radius * flare)


def _fronds(species: Feather, top: np.ndarray, count: int, rng: np.random.Generator) -> Branches:
    """Rachises: the youngest upright, the oldest hanging; all arch under their weight."""
    age = (np.arange(count) + rng.uniform(0.0, 0.8, count)) / count
    turn = GOLDEN_RAD * np.arange(count) + rng.normal(0.0, 0.2, count)
    rise = np.deg2rad(74.0 - 112.0 * age**0.9 + rng.normal(0.0, 6.0, count))
    direction = np.column_stack([np.cos(turn) * np.cos(rise), np.sin(turn) * np.cos(rise), np.sin(rise)])
    length = (
        1.3 * species.outline.radius * rng.uniform(0.85, 1.05, count) * (0.75 + 0.25 * np.sin(np.pi * age))
    )
    thick = np.full(count, 0.12 * species.girth)
    start = top + 0.6 * species.girth * direction * np.array([1.0, 1.0, 0.5])
    sag = -2.3 * rng.uniform(0.85, 1.15)
    return sprout(start, direction, length, (thick, 0.15 * thick), _NODES, sag, 0.02, rng)


def _leaflets(fronds: Branches, pairs: int, rng: np.random.Generator) -> Mesh:
    """Narrow triangles on both sides of each rachis, longest in its middle."""
    count = len(fronds.points)
    frond = np.repeat(np.arange(count), 2 * pairs)
    side = np.tile(np.repeat([1.0, -1.0], pairs), count)
    t = np.tile(np.tile(0.14 + 0.84 * (np.arange(pairs) + 0.5) / pairs, 2), count)
    base, along, _ = fronds.at(frond, t)
    level = unit(np.cross(along, np.array([0.0, 0.0, 1.0])) + 1e-6)
    above = np.cross(level, along)
    reach = fronds.length()[frond]
    long = reach * 0.34 * np.sin(np.pi * (0.12 + 0.82 * t)) ** 0.7 * rng.uniform(0.85, 1.15, len(t))
    hang = rng.uniform(0.15, 0.7, len(t))[:, None]
    toward = unit(side[:, None] * level + 0.65 * along + 0.25 * above - hang * np.array([0.0, 0.0, 1.0]))
    half = (0.48 / pairs * reach)[:, None] * along
    tip = base + long[:, None] * toward
    return Mesh.of(np.stack([base - half, base + half, tip], axis=1))


def _ribs(fronds: Branches) -> Mesh:
    """The rachis as a thin ribbon of leaf, so that a frond stays whole against the sky."""
    points = fronds.points
    ahead = unit(np.gradient(points, axis=1))
    level = unit(np.cross(ahead, np.array([0.0, 0.0, 1.0])) + 1e-6)
    half = 1.6 * fronds.radius[..., None] * level
    strip = np.stack([points - half, points + half], axis=2).reshape(len(points), -1, 3)
    k = 2 * np.arange(_NODES - 1)[:, None]
    faces = (k + np.array([0, 2, 3, 0, 3, 1])).reshape(-1, 3)
    shifted = faces[None] + strip.shape[1] * np.arange(len(points))[:, None, None]
    return Mesh(strip.reshape(-1, 3), shifted.reshape(-1, 3))
