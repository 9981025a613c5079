"""Facades: planar walls with a grid of recessed windows and doors, all walls of a world at once."""

from __future__ import annotations

import numpy as np
from jaxtyping import Bool, Int64

from scenegen.classes import Semantic
from scenegen.geometry.openings import Doors, doors, grouped, leaders, reveals
from scenegen.geometry.part import STANDOFF_M, Part
from scenegen.geometry.patch import lattice_quads, quads_to_triangles
from scenegen.geometry.ragged import offsets
from scenegen.geometry.wall_grid import Lattice, Walls, lattice, outward

__all__ = ["BLANK", "DOOR", "WINDOW", "Walls", "facades"]

BLANK, WINDOW, DOOR = 0, 1, 2
"""What fills a cell of the window grid."""

_REVEALS_PER_SITE = (5, 4)
"""Window columns and storeys that share the sites of their reveals."""


def facades(
    walls: Walls,
    filling: Int64[np.ndarray, "cells"],
    balconied: Bool[np.ndarray, "walls"] | None = None,
    panes_per_site: tuple[int, int] = (1, 1),
    glass: Int64[np.ndarray, "cells"] | None = None,
) -> Part:
    """Build all walls.

    Parameters
    ----------
    walls : Walls
    filling : int64 (cells,)
        `BLANK`, `WINDOW` or `DOOR` for every cell of `Walls.cells`. Doors are honoured on the ground floor
        and reach from the floor to the window's head; they lie flush.
    balconied : bool (walls,), optional
        Walls whose upper storeys have balconies: their sites lie beside the windows, above the rails. At the height
        of the floors they would see balconies alone.
    panes_per_site : (int, int)
        Window columns and storeys whose panes share a site.
    glass : int64 (cells,), optional
        Palette index of the pane in each cell, where it is not that of the wall.
    """
    normal = outward(walls)
    if balconied is None:
        balconied = np.zeros(len(normal), bool)
    points = lattice(walls, normal, balconied)
    columns, rows = 2 * walls.columns + 2, 2 * walls.storeys + 3
    item, i, j, quads = lattice_quads(columns, rows)
    cell = _cell_of(walls, item, i, j)
    kind = np.where(i % 2 == 1, filling[cell], BLANK)
    pane = (kind == WINDOW) & (j >= 2) & (j % 2 == 0)
    skins = walls.glass[item[pane]] if glass is None else glass[cell[pane]]
    where = walls, item[pane], (i[pane] - 1) // 2, (j[pane] - 2) // 2
    groups = (
        grouped(*where, skins, panes_per_site),
        grouped(*where, np.zeros_like(skins), _REVEALS_PER_SITE),
    )
    door = (kind == DOOR) & (j <= 2)
    semantic = np.where(door, int(Semantic.DOOR), int(Semantic.WALL))
    surface = np.where(door, walls.door[item], walls.surface[item])
    entrances = doors(walls, item[door], i[door], j[door])
    return _assemble(
        walls, normal, points, item, quads, pane, groups, skins, door, entrances, semantic, surface
    )


def _cell_of(walls: Walls, item: np.ndarray, i: np.ndarray, j: np.ndarray) -> np.ndarray:
    """Window cell a quad lies in or beside; the strip below a door belongs to the door's."""
    storey = np.clip((j - 2) // 2, 0, walls.storeys[item] - 1)
    column = np.clip((i - 1) // 2, 0, walls.columns[item] - 1)
    return np.asarray(offsets(walls.columns * walls.storeys)[item] + storey * walls.columns[item] + column)


def _assemble(
    walls: Walls,
    normal: np.ndarray,
    points: Lattice,
    item: np.ndarray,
    quads: np.ndarray,
    pane: Bool[np.ndarray, "quads"],
    groups: tuple[Int64[np.ndarray, "panes"], Int64[np.ndarray, "panes"]],
    glass: Int64[np.ndarray, "panes"],
    door: Bool[np.ndarray, "quads"],
    entrances: Doors,
    semantic: np.ndarray,
    surface: np.ndarray,
) -> Part:
    """Solid quads, then reveals, then panes; `groups` tells which panes, and which reveals, share a site."""
    solid = ~pane
    opening = quads[pane]
    owner = item[pane]
    inner = points.vertices[opening] - normal[owner][:, None, :] * walls.recess_m[owner][:, None, None]
    count = len(opening)
    base = len(points.vertices)
    inner_id = base + np.arange(4 * count).reshape(-1, 4)
    ring = np.array([1, 2, 3, 0])
    after = opening[:, ring]
    sides = np.stack([opening, after, inner_id[:, ring], inner_id], axis=2).reshape(-1, 4)

    site_count = len(points.site_position)
    door_count = len(entrances.position)
    quad_site = points.site[quads]
    quad_site[door] = site_count + entrances.corner_site
    first_pane, pane_lead = site_count + door_count, leaders(groups[0])
    first_reveal = first_pane + len(pane_lead)
    pane_site = np.repeat((first_pane + groups[0])[:, None], 4, axis=1)
    around = reveals(points.vertices[opening], inner, groups[1])

    all_quads = np.concatenate([quads[solid], sides, inner_id])
    all_sites = np.concatenate([quad_site[solid], first_reveal + around.corner_site, pane_site])
    wall_of = np.concatenate([item[solid], np.repeat(owner, 4), owner])
    labels = np.concatenate(
        [semantic[solid], np.full(4 * count, int(Semantic.WALL)), np.full(count, int(Semantic.WINDOW))]
    )
    skins = np.concatenate([surface[solid], walls.surface[np.repeat(owner, 4)], glass])
    vertices = np.concatenate([points.vertices, inner.reshape(-1, 3)])
    return Part(
        vertices=vertices,
        faces=quads_to_triangles(all_quads),
        surface=np.repeat(skins, 2),
        semantic=np.repeat(labels, 2),
        object=np.repeat(walls.object[wall_of], 2),
        corner_site=quads_to_triangles(all_sites),
        site_position=np.concatenate(
            [points.site_position, entrances.position, inner.mean(axis=1)[pane_lead], around.position]
        ),
        site_normal=np.concatenate(
            [points.site_normal, normal[entrances.wall], normal[owner[pane_lead]], around.normal]
        ),
        site_standoff=np.full(first_reveal + len(around.position), STANDOFF_M),
    )
