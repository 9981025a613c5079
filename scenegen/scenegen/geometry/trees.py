"""Masses of trees for the distance: a few uneven crowns that stand on the ground, with sites around them all.

Trees near a camera are grown branch by branch, see `scenegen.parts.vegetation`.
"""

from __future__ import annotations

import numpy as np

from scenegen.classes import Semantic
from scenegen.geometry.modelling import Modeller
from scenegen.geometry.part import LUMP_STANDOFF_M
from scenegen.geometry.template import Template

_ICOSAHEDRON_FACES = np.array(
    [
        [0, 11, 5], [0, 5, 1], [0, 1, 7], [0, 7, 10], [0, 10, 11],
        [1, 5, 9], [5, 11, 4], [11, 10, 2], [10, 7, 6], [7, 1, 8],
        [3, 9, 4], [3, 4, 2], [3, 2, 6], [3, 6, 8], [3, 8, 9],
        [4, 9, 5], [2, 4, 11], [6, 2, 10], [8, 6, 7], [9, 8, 1],
    ]
)  # fmt: skip

_FOOT = -0.08
"""Where the lowest corner of every crown lies, in heights of the grove: in the ground, on a slope too."""
_CENTRE, _RADII = np.array([0.0, 0.0, 0.4]), np.array([0.6, 0.6, 0.7])
"""Ellipsoid of the sites: rays that leave it outwards never meet the grove."""


def grove(rng: np.random.Generator, crowns: int = 6) -> Template:
    """A mass of trees of unit diameter and height, standing on z = 0; one slot, four sites.

    Parameters
    ----------
    rng : numpy.random.Generator
    crowns : int
        Lumps of 20 triangles.
    """
    model = Modeller()
    way = _fibonacci(6)[:4] * np.array([1, 1, 0.7])
    way /= np.linalg.norm(way, axis=1)[:, None]
    first = [model.site(_CENTRE + d * _RADII, d / _RADII, LUMP_STANDOFF_M) for d in way]
    ball = _icosahedron()
    reach, angle = 0.36 * np.sqrt((np.arange(crowns) + 0.3) / crowns), 2.4 * np.arange(crowns)
    for r, a in zip(reach, angle, strict=True):
        tall = rng.uniform(0.68, 1.0) * (1.0 - 0.5 * r)
        size = np.array([1.0, 1.0, 0.0]) * rng.uniform(0.15, 0.24) + np.array([0.0, 0.0, tall / 2])
        lump = ball * rng.uniform(0.75, 1.0, (12, 1)) * size + np.array(
            [r * np.cos(a), r * np.sin(a), tall / 2]
        )
        lump[np.argmin(lump[:, 2]), 2] = _FOOT
        site = first[0] + np.argmax((lump - _CENTRE) @ way.T, axis=1)
        model.mesh(lump, _ICOSAHEDRON_FACES, 0, Semantic.TREE, site[_ICOSAHEDRON_FACES])
    return model.finish()


def _icosahedron() -> np.ndarray:
    t = (1 + np.sqrt(5)) / 2
    p = [[-1, t, 0], [1, t, 0], [-1, -t, 0], [1, -t, 0], [0, -1, t], [0, 1, t], [0, -1, -t], [0, 1, -t]]
    p += [[t, 0, -1], [t, 0, 1], [-t, 0, -1], [-t, 0, 1]]
    points = np.array(p, np.float64)
    return np.asarray(points / np.linalg.norm(points, axis=1)[:, None])


def _fibonacci(count: int) -> np.ndarray:
    """Points spread evenly over the unit sphere."""
    z = 1 - 2 * (np.arange(count) + 0.5) / count
    angle = np.pi * (3 - np.sqrt(5)) * np.arange(count)
    r = np.sqrt(1 - z**2)
    return np.column_stack([r * np.cos(angle), r * np.sin(angle), z])
