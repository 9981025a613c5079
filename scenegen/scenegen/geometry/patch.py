"""Bilinear patches: four corners become a lattice of quads with one site per lattice point.

The work-horse for everything planar: blank walls, pitched roofs, parapets, decks, far buildings.
"""

from __future__ import annotations

import numpy as np
from jaxtyping import Float64, Int64

from scenegen.geometry.part import STANDOFF_M, Part
from scenegen.geometry.ragged import offsets, ragged_grid


def lattice_quads(
    columns: Int64[np.ndarray, "items"], rows: Int64[np.ndarray, "items"]
) -> tuple[
    Int64[np.ndarray, "cells"],
    Int64[np.ndarray, "cells"],
    Int64[np.ndarray, "cells"],
    Int64[np.ndarray, "cells 4"],
]:
    """Item, column, row and the four lattice points (counter-clockwise) of every cell of many lattices.

    Parameters
    ----------
    columns, rows : int64 (items,)
        Number of lattice points along each axis, at least 2.
    """
    item, i, j = ragged_grid(columns - 1, rows - 1)
    width = columns[item]
    first = offsets(columns * rows)[item] + j * width + i
    return item, i, j, np.stack([first, first + 1, first + 1 + width, first + width], axis=1)


def quads_to_triangles(quads: Int64[np.ndarray, "cells 4"]) -> Int64[np.ndarray, "triangles 3"]:
    """Two triangles per quad, quad by quad."""
    return quads[:, [0, 1, 2, 0, 2, 3]].reshape(-1, 3)


def patches(
    corners: Float64[np.ndarray, "items 4 3"],
    spacing_m: float,
    surface: Int64[np.ndarray, "items"],
    semantic: Int64[np.ndarray, "items"],
    owner: Int64[np.ndarray, "items"],
    standoff_m: float = STANDOFF_M,
    lumped_rows: bool = False,
) -> Part:
    """Tessellate quads; two corners may coincide (a triangle): faces without area go when parts are merged.

    Parameters
    ----------
    corners : float64 (items, 4, 3)
        Counter-clockwise seen from outside [m].
    spacing_m : float
        Largest distance between lattice points [m].
    surface, semantic, owner : int64 (items,)
        Labels of each patch.
    standoff_m : float
        Standoff of the sites [m].
    lumped_rows : bool
        One row of sites along the middle, for strips too narrow to have a gradient across.
    """
    bottom, top = np.linalg.norm(corners[:, [1, 2]] - corners[:, [0, 3]], axis=2).T
    right, left = np.linalg.norm(corners[:, [2, 3]] - corners[:, [1, 0]], axis=2).T
    columns = np.maximum(np.ceil(np.maximum(bottom, top) / spacing_m - 1e-9).astype(np.int64), 1) + 1
    rows = np.maximum(np.ceil(np.maximum(left, right) / spacing_m - 1e-9).astype(np.int64), 1) + 1
    item, i, j = ragged_grid(columns, rows)
    u = (i / (columns[item] - 1))[:, None]
    v = (j / (rows[item] - 1))[:, None]
    a, b, c, d = (corners[item, k] for k in range(4))
    points = (1 - v) * ((1 - u) * a + u * b) + v * ((1 - u) * d + u * c)
    normal = np.cross(corners[:, 2] - corners[:, 0], corners[:, 3] - corners[:, 1])
    normal /= np.maximum(np.linalg.norm(normal, axis=1), 1e-12)[:, None]
    cell_item, _, _, quads = lattice_quads(columns, rows)
    faces = quads_to_triangles(quads)
    face_item = np.repeat(cell_item, 2)
    corner_site, position, site_item = faces, points + (corners.mean(axis=1)[item] - points) * 0.02, item
    if lumped_rows:
        site = offsets(columns)[item] + i
        middle = np.stack(
            [
                np.bincount(site, points[:, k]) / rows[np.repeat(np.arange(len(columns)), columns)]
                for k in range(3)
            ]
        )
        corner_site, position, site_item = site[faces], middle.T, np.repeat(np.arange(len(columns)), columns)
    return Part(
        vertices=points,
        faces=faces,
        surface=surface[face_item],
        semantic=semantic[face_item],
        object=owner[face_item],
        corner_site=corner_site,
        site_position=position,
        site_normal=normal[site_item],
        site_standoff=np.full(len(position), standoff_m),
    )
