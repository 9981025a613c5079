"""Trees: trunk, branches and a crown of leaf cards around lumpy boughs; broad-leaved and conifer.

A crown has six lumped sites on an ellipsoid around all its leaves: rays that leave the ellipsoid outwards
never meet the crown again. Each leaf card takes the site whose direction it lies in.
"""

from __future__ import annotations

import numpy as np

from scenegen.classes import Semantic
from scenegen.geometry.modelling import Modeller
from scenegen.geometry.part import LUMP_STANDOFF_M
from scenegen.geometry.template import Template

BARK, LEAVES = 0, 1
"""Surface slots of a tree."""

_ICOSAHEDRON_FACES = np.array(
    [
        [0, 11, 5], [0, 5, 1], [0, 1, 7], [0, 7, 10], [0, 10, 11],
        [1, 5, 9], [5, 11, 4], [11, 10, 2], [10, 7, 6], [7, 1, 8],
        [3, 9, 4], [3, 4, 2], [3, 2, 6], [3, 6, 8], [3, 8, 9],
        [4, 9, 5], [2, 4, 11], [6, 2, 10], [8, 6, 7], [9, 8, 1],
    ]
)  # fmt: skip


def _icosahedron() -> np.ndarray:
    t = (1 + np.sqrt(5)) / 2
    p = [[-1, t, 0], [1, t, 0], [-1, -t, 0], [1, -t, 0], [0, -1, t], [0, 1, t], [0, -1, -t], [0, 1, -t]]
    p += [[t, 0, -1], [t, 0, 1], [-t, 0, -1], [-t, 0, 1]]
    points = np.array(p, np.float64)
    return np.asarray(points / np.linalg.norm(points, axis=1)[:, None])


def broadleaf(rng: np.random.Generator, boughs: int = 6, cards: int = 92) -> Template:
    """A broad-leaved tree of unit height 1 and crown diameter about 0.75; scale it to size.

    Parameters
    ----------
    rng : numpy.random.Generator
    boughs : int
        Lumps of the crown.
    cards : int
        Leaf triangles around the lumps.
    """
    centre, radii = np.array([0.0, 0.0, 0.64]), np.array([0.37, 0.37, 0.36])
    direction = _fibonacci(boughs)
    reach = rng.uniform(0.42, 0.62, boughs)[:, None]
    middle = centre + direction * radii * reach
    size = rng.uniform(0.13, 0.19, boughs)
    model = Modeller()
    _trunk(model, rng, middle)
    _crown(model, rng, centre, radii, middle, size, cards, 0.047)
    return model.finish()


def conifer(rng: np.random.Generator, tiers: int = 6, cards: int = 96) -> Template:
    """A conifer of unit height and base diameter about 0.4; scale it to size."""
    level = (np.arange(tiers) + 0.5) / tiers
    middle = np.column_stack([rng.normal(0, 0.01, tiers), rng.normal(0, 0.01, tiers), 0.14 + 0.8 * level])
    size = 0.19 * (1 - level) + 0.03
    model = Modeller()
    model.tube(np.zeros(3), np.array([0, 0, 0.9]), 0.02, 0.006, BARK, Semantic.TREE, sides=5, sites=2)
    _crown(model, rng, np.array([0, 0, 0.5]), np.array([0.24, 0.24, 0.52]), middle, size, cards, 0.043)
    return model.finish()


def grove(rng: np.random.Generator, boughs: int = 6) -> Template:
    """A mass of trees of unit diameter and height, for the distance; one slot, four sites."""
    model = Modeller()
    ball = _icosahedron()
    directions = _fibonacci(6)[:4] * np.array([1, 1, 0.7])
    centre, radii = np.array([0, 0, 0.4]), np.array([0.6, 0.6, 0.7])
    first = [
        model.site(centre + d / np.linalg.norm(d) * radii, d / radii, LUMP_STANDOFF_M) for d in directions
    ]
    spread = np.sqrt(rng.uniform(0.0, 1.0, boughs)) * 0.4
    angle = 2.4 * np.arange(boughs)
    for r, a in zip(spread, angle, strict=True):
        size = rng.uniform(0.12, 0.2) * np.array([1, 1, 2.2])
        lump = ball * rng.uniform(0.75, 1.0, (12, 1)) * size + np.array(
            [r * np.cos(a), r * np.sin(a), 0.45 - 0.3 * r]
        )
        site = first[0] + np.argmax((lump - centre) @ directions.T, axis=1)
        model.mesh(lump, _ICOSAHEDRON_FACES, 0, Semantic.TREE, site[_ICOSAHEDRON_FACES])
    return model.finish()


def _fibonacci(count: int) -> np.ndarray:
    """Points spread evenly over the unit sphere."""
    z = 1 - 2 * (np.arange(count) + 0.5) / count
    angle = np.pi * (3 - np.sqrt(5)) * np.arange(count)
    r = np.sqrt(1 - z**2)
    return np.column_stack([r * np.cos(angle), r * np.sin(angle), z])


def _trunk(model: Modeller, rng: np.random.Generator, boughs: np.ndarray) -> None:
    fork = np.array([rng.normal(0, 0.01), rng.normal(0, 0.01), 0.34])
    model.tube(np.array([0, 0, -0.03]), fork, 0.024, 0.017, BARK, Semantic.TREE, sides=6, sites=2)
    for tip in boughs[:3]:
        model.tube(fork, fork + 0.8 * (tip - fork), 0.011, 0.004, BARK, Semantic.TREE, sides=4)


def _crown(
    model: Modeller,
    rng: np.random.Generator,
    centre: np.ndarray,
    radii: np.ndarray,
    boughs: np.ndarray,
    size: np.ndarray,
    cards: int,
    card_size: float,
) -> None:
    lumps = [
        middle + _icosahedron() * radius * rng.uniform(0.62, 0.95, (12, 1)) * np.array([1, 1, 0.85])
        for middle, radius in zip(boughs, size, strict=True)
    ]
    corners = _cards(rng, boughs, size, cards, card_size, centre, radii)
    leaves = np.concatenate([*lumps, corners.reshape(-1, 3)])
    hull = radii * np.linalg.norm((leaves - centre) / radii, axis=1).max() * 1.001
    directions = _fibonacci(6)
    first = [model.site(centre + d * hull, d / hull, LUMP_STANDOFF_M) for d in directions]

    def sites_of(points: np.ndarray) -> np.ndarray:
        return np.asarray(first[0] + np.argmax(((points - centre) / radii) @ directions.T, axis=1))

    for lump in lumps:
        model.mesh(lump, _ICOSAHEDRON_FACES, LEAVES, Semantic.TREE, sites_of(lump)[_ICOSAHEDRON_FACES])
    faces = np.arange(3 * cards).reshape(-1, 3)
    owner = sites_of(corners.mean(axis=1))
    model.mesh(corners.reshape(-1, 3), faces, LEAVES, Semantic.TREE, np.repeat(owner[:, None], 3, axis=1))


def _cards(
    rng: np.random.Generator,
    boughs: np.ndarray,
    size: np.ndarray,
    cards: int,
    card_size: float,
    centre: np.ndarray,
    radii: np.ndarray,
) -> np.ndarray:
    """Drooping leaf triangles on the skins of the boughs, facing away from the crown's middle."""
    bough = np.arange(cards) % len(boughs)
    direction = rng.normal(size=(cards, 3))
    direction /= np.linalg.norm(direction, axis=1)[:, None]
    middle = boughs[bough] + direction * (size[bough] * rng.uniform(0.8, 1.15, cards))[:, None]
    relative = (middle - centre) / radii
    middle = centre + relative / np.maximum(np.linalg.norm(relative, axis=1) / 0.86, 1.0)[:, None] * radii
    facing = direction + rng.normal(0.0, 0.45, (cards, 3)) + 0.4 * (middle - centre) / radii
    facing /= np.linalg.norm(facing, axis=1)[:, None]
    u = np.cross(facing, rng.normal(size=(cards, 3)))
    u /= np.linalg.norm(u, axis=1)[:, None]
    v = np.cross(facing, u)
    half = card_size * rng.uniform(0.7, 1.4, (cards, 1))
    tip = middle + half * (1.3 * u - 0.3 * facing)
    corners = [tip, middle - half * (0.8 * u - 0.9 * v), middle - half * (0.8 * u + 0.9 * v)]
    return np.stack(corners, axis=1)


def shrub(rng: np.random.Generator, cards: int = 14) -> Template:
    """A shrub or a metre of hedge of unit size, standing on z = 0; one slot, three sites."""
    model = Modeller()
    centre, radii = np.array([0, 0, 0.5]), np.array([0.62, 0.62, 0.62])
    directions = np.array([[0, -1.0, 0.4], [0, 1.0, 0.4], [0, 0, 1.0]])
    directions /= np.linalg.norm(directions, axis=1)[:, None]
    first = [model.site(centre + d * radii, d, LUMP_STANDOFF_M) for d in directions]

    def sites_of(points: np.ndarray) -> np.ndarray:
        return np.asarray(first[0] + np.argmax((points - centre) @ directions.T, axis=1))

    boughs = np.array([[-0.24, 0.0, 0.45], [0.24, 0.0, 0.48]])
    for middle in boughs:
        lump = middle + _icosahedron() * rng.uniform(0.75, 1.0, (12, 1)) * np.array([0.34, 0.5, 0.52])
        model.mesh(lump, _ICOSAHEDRON_FACES, 0, Semantic.SHRUB, sites_of(lump)[_ICOSAHEDRON_FACES])
    corners = _cards(rng, boughs, np.array([0.4, 0.4]), cards, 0.14, centre, radii)
    corners[..., 2] = np.maximum(corners[..., 2], 0.05)
    faces = np.arange(3 * cards).reshape(-1, 3)
    owner = sites_of(corners.mean(axis=1))
    model.mesh(corners.reshape(-1, 3), faces, 0, Semantic.SHRUB, np.repeat(owner[:, None], 3, axis=1))
    return model.finish()
