"""Boulders: convex lumps of rock, cut by random planes, as templates; and tumbled blocks of concrete."""

from __future__ import annotations

import numpy as np
from scipy.spatial import ConvexHull

from scenegen.geometry.modelling import Modeller
from scenegen.geometry.template import Template

_SITE_RISE = 0.45


def boulder(rng: np.random.Generator, semantic: int, splits: int = 2, planes: int = 15) -> Template:
    """A rock of about unit radius around the origin, to be buried to its middle. Slot: 0.

    Parameters
    ----------
    rng : numpy.random.Generator
    semantic : int
    splits : int
        How often the faces of an icosahedron are quartered: 80, 320, 1280 triangles.
    planes : int
        Planes that cut it.
    """
    direction, faces = _sphere(splits)
    normal = rng.normal(size=(planes, 3))
    normal /= np.linalg.norm(normal, axis=1)[:, None]
    reach = rng.uniform(0.72, 1.0, planes)
    facing = np.maximum(direction @ normal.T, 1e-3)
    radius = np.minimum((reach / facing).min(axis=1), 1.1)
    rough = 1 + 0.035 * rng.normal(size=len(direction)) * (splits > 1)
    return _lump(direction * (radius * rough)[:, None], faces, semantic)


def block(rng: np.random.Generator, semantic: int) -> Template:
    """A cube of concrete with chamfered edges, tumbled, of unit half side. Slot: 0."""
    corner = np.array([[x, y, z] for x in (-1, 1) for y in (-1, 1) for z in (-1, 1)], np.float64)
    points = np.concatenate(
        [corner * s for s in (np.array([1, 1, 0.82]), np.array([1, 0.82, 1]), np.array([0.82, 1, 1]))]
    )
    q = rng.normal(size=4)
    w, x, y, z = q / np.linalg.norm(q)
    turn = np.array(
        [
            [1 - 2 * (y * y + z * z), 2 * (x * y - w * z), 2 * (x * z + w * y)],
            [2 * (x * y + w * z), 1 - 2 * (x * x + z * z), 2 * (y * z - w * x)],
            [2 * (x * z - w * y), 2 * (y * z + w * x), 1 - 2 * (x * x + y * y)],
        ]
    )
    points = 0.8 * points @ turn.T
    return _lump(points, _hull_faces(points), semantic)


def _hull_faces(points: np.ndarray) -> np.ndarray:
    """Triangles of the convex hull, counter-clockwise from outside."""
    hull = ConvexHull(points)
    a, b, c = (points[hull.simplices[:, k]] for k in range(3))
    inward = (np.cross(b - a, c - a) * hull.equations[:, :3]).sum(axis=1) < 0
    faces = hull.simplices.astype(np.int64)
    faces[inward] = faces[inward][:, ::-1]
    return np.asarray(faces)


def _lump(points: np.ndarray, faces: np.ndarray, semantic: int) -> Template:
    """Seven sites above the middle: the top and six around."""
    model = Modeller()
    turn = 2 * np.pi * np.arange(6) / 6
    out = np.column_stack([np.cos(turn), np.sin(turn), np.full(6, _SITE_RISE)])
    directions = np.concatenate([[[0.0, 0.0, 1.0]], out / np.linalg.norm(out, axis=1)[:, None]])
    unit = points / np.linalg.norm(points, axis=1)[:, None]
    for d in directions:
        model.site(1.04 * d * np.linalg.norm(points[np.argmax(unit @ d)]), d)
    site = np.argmax(unit @ directions.T, axis=1)
    model.mesh(points, faces, 0, semantic, site[faces])
    return model.finish()


def _sphere(splits: int) -> tuple[np.ndarray, np.ndarray]:
    """Unit vectors and triangles of a repeatedly split icosahedron."""
    g = (1 + np.sqrt(5)) / 2
    base = np.array([[-1, g, 0], [1, g, 0], [-1, -g, 0], [1, -g, 0]], np.float64)
    points = np.concatenate([np.roll(base, k, axis=1) for k in range(3)])
    points /= np.linalg.norm(points[0])
    faces = _hull_faces(points)
    for _ in range(splits):
        edges, index = np.unique(
            np.sort(faces[:, [0, 1, 1, 2, 2, 0]].reshape(-1, 2), axis=1), axis=0, return_inverse=True
        )
        middle = points[edges].sum(axis=1)
        m = len(points) + index.reshape(-1, 3)
        points = np.concatenate([points, middle / np.linalg.norm(middle, axis=1)[:, None]])
        a, b, c = faces.T
        faces = np.concatenate(
            [
                np.column_stack([a, m[:, 0], m[:, 2]]),
                np.column_stack([m[:, 0], b, m[:, 1]]),
                np.column_stack([m[:, 2], m[:, 1], c]),
                m,
            ]
        )
    return points, faces
