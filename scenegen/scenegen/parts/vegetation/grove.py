"""A mass of trees for the distance: a few ragged domes with sprays on their skins."""

from __future__ import annotations

import numpy as np

from scenegen.classes import Semantic
from scenegen.geometry.modelling import Modeller
from scenegen.geometry.template import Template
from scenegen.parts.vegetation.branches import GOLDEN_RAD, unit
from scenegen.parts.vegetation.cards import sprays
from scenegen.parts.vegetation.lumps import UP, ring, supports, thrice
from scenegen.parts.vegetation.mesh import Mesh, merged

_SIDES = 5
_SPRAYS = 5
_FOOT = -0.14
"""How deep it stands in the ground, in heights: far ground is coarse and sloped."""
_SITES = np.concatenate([UP, ring(3, 22.0)])


def grove(rng: np.random.Generator, crowns: int = 6) -> Template:
    """Trees in a circle of diameter 1, up to height 1, 35 triangles a crown; one slot, four sites.

    Parameters
    ----------
    rng : numpy.random.Generator
    crowns : int
        Tree tops.
    """
    reach = 0.34 * np.sqrt((np.arange(crowns) + rng.uniform(0.2, 0.8, crowns)) / crowns)
    turn = GOLDEN_RAD * np.arange(crowns) + rng.uniform(0, 2 * np.pi)
    top = rng.uniform(0.66, 1.0, crowns) * (1.0 - 0.35 * (reach / 0.34) ** 2)
    wide = rng.uniform(0.13, 0.19, crowns)
    pieces = []
    for k in range(crowns):
        place = np.array([reach[k] * np.cos(turn[k]), reach[k] * np.sin(turn[k])])
        pieces += [_dome(place, wide[k], top[k], rng), _skin(place, wide[k], top[k], rng)]
    whole = _unit(merged(pieces))
    model = Modeller()
    first = supports(model, whole.vertices, _SITES)
    middle = whole.corners().mean(axis=1) - np.array([0.0, 0.0, 0.35])
    site = np.argmax(unit(middle) @ _SITES.T, axis=1)
    model.mesh(whole.vertices, whole.faces, 0, Semantic.TREE, thrice(first + site))
    return model.finish()


def _dome(place: np.ndarray, wide: float, top: float, rng: np.random.Generator) -> Mesh:
    """A pointed dome that widens downwards and ends well below the ground."""
    angle = 2 * np.pi * (np.arange(_SIDES) + rng.uniform()) / _SIDES
    rings = []
    for height, share in ((_FOOT, 0.9), (0.45 * top, 1.0), (0.82 * top, 0.62)):
        reach = wide * share * rng.uniform(0.82, 1.12, _SIDES)
        z = height + 0.05 * top * rng.normal(size=_SIDES) * (height > 0.0)
        rings.append(np.column_stack([reach * np.cos(angle), reach * np.sin(angle), z]))
    vertices = np.concatenate([*rings, np.array([[0.0, 0.0, top]])])
    vertices[:, :2] += place
    k, after = np.arange(_SIDES), (np.arange(_SIDES) + 1) % _SIDES
    quad = np.stack([k, after, after + _SIDES, k, after + _SIDES, k + _SIDES], axis=1).reshape(-1, 3)
    cap = np.stack([k + 2 * _SIDES, after + 2 * _SIDES, np.full(_SIDES, 3 * _SIDES)], axis=1)
    return Mesh(vertices, np.concatenate([quad, quad + _SIDES, cap]))


def _skin(place: np.ndarray, wide: float, top: float, rng: np.random.Generator) -> Mesh:
    """Sprays that roughen the upper half of a dome against the sky."""
    turn = 2 * np.pi * (np.arange(_SPRAYS) + rng.uniform(size=_SPRAYS)) / _SPRAYS
    rise = rng.uniform(0.5, 0.95, _SPRAYS)
    out = np.column_stack([np.cos(turn), np.sin(turn), np.zeros(_SPRAYS)])
    base = out * (wide * (1.05 - 0.75 * (rise - 0.5) / 0.5))[:, None]
    base[:, :2] += place
    base[:, 2] = top * rise
    heading = unit(out + rng.normal(0.0, 0.5, out.shape) + np.array([0.0, 0.0, 0.8]))
    return sprays(base, heading, out + np.array([0.0, 0.0, 0.5]), wide * rng.uniform(0.5, 0.9, _SPRAYS), 1.2)


def _unit(mesh: Mesh) -> Mesh:
    """Fitted into the cylinder; what is in the ground stays there."""
    vertices = mesh.vertices.copy()
    vertices[:, :2] *= 0.5 / np.hypot(vertices[:, 0], vertices[:, 1]).max()
    above = vertices[:, 2] > 0.0
    vertices[above, 2] /= vertices[:, 2].max()
    return Mesh(vertices, mesh.faces)
