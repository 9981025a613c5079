"""Facades: planar walls with a grid of recessed windows and doors, all walls of a world at once.

A wall is a tensor grid of lines: jambs of the window columns across, sills and heads of the storeys
upwards. Its thermal sites are coarser than its vertices: one per crossing of every second pier with a
spandrel, shared by all grid points around that crossing. Panes have sites of their own, or share
one with a neighbour; and so do the reveals of a few windows: sills see the sky where the wall sees the street.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from jaxtyping import Bool, Float64, Int64

from scenegen.classes import Semantic
from scenegen.geometry.part import STANDOFF_M, Part
from scenegen.geometry.patch import lattice_quads, quads_to_triangles
from scenegen.geometry.ragged import offsets, ragged_grid

BLANK, WINDOW, DOOR = 0, 1, 2
"""What fills a cell of the window grid."""

_PLINTH_M = 0.6
_REVEALS_PER_SITE = (5, 4)
"""Window columns and storeys that share the sites of their reveals."""
_DOOR_LOWER_M, _DOOR_UPPER = 0.3, 0.7
"""Height of the two sites of a door: above the floor, and in heights of its head."""


@dataclass(frozen=True, eq=False)
class Walls:
    """One row per planar wall.

    Attributes
    ----------
    start, end : float64 (walls, 2)
        Lower corners in plan [m], left to right seen from outside.
    floor_m : float64 (walls,)
        Height of the ground floor [m].
    foundation_m : float64 (walls,)
        How far the wall continues below its floor [m].
    top_m : float64 (walls,)
        Upper edge [m].
    storeys : int64 (walls,)
        At least 1.
    first_storey_m, storey_m : float64 (walls,)
        Height of the ground floor and of each floor above [m].
    columns : int64 (walls,)
        Window columns, at least 1.
    window_share : float64 (walls,)
        Window width over column width.
    sill_m, head_m : float64 (walls,)
        Above each floor [m].
    first_sill_m, first_head_m : float64 (walls,)
        The same on the ground floor [m].
    surface, glass, door, object : int64 (walls,)
        Palette indices of wall, panes and doors, and the instance.
    recess_m : float64 (walls,)
        Depth of the reveals [m].
    """

    start: Float64[np.ndarray, "walls 2"]
    end: Float64[np.ndarray, "walls 2"]
    floor_m: Float64[np.ndarray, "walls"]
    foundation_m: Float64[np.ndarray, "walls"]
    top_m: Float64[np.ndarray, "walls"]
    storeys: Int64[np.ndarray, "walls"]
    first_storey_m: Float64[np.ndarray, "walls"]
    storey_m: Float64[np.ndarray, "walls"]
    columns: Int64[np.ndarray, "walls"]
    window_share: Float64[np.ndarray, "walls"]
    sill_m: Float64[np.ndarray, "walls"]
    head_m: Float64[np.ndarray, "walls"]
    first_sill_m: Float64[np.ndarray, "walls"]
    first_head_m: Float64[np.ndarray, "walls"]
    surface: Int64[np.ndarray, "walls"]
    glass: Int64[np.ndarray, "walls"]
    door: Int64[np.ndarray, "walls"]
    object: Int64[np.ndarray, "walls"]
    recess_m: Float64[np.ndarray, "walls"]

    def cells(
        self,
    ) -> tuple[Int64[np.ndarray, "cells"], Int64[np.ndarray, "cells"], Int64[np.ndarray, "cells"]]:
        """Wall, column and storey of every cell of the window grids, in the order `facades` expects."""
        return ragged_grid(self.columns, self.storeys)


@dataclass(frozen=True, eq=False)
class _Lattice:
    """Grid points of all walls."""

    vertices: Float64[np.ndarray, "points 3"]
    site: Int64[np.ndarray, "points"]
    site_position: Float64[np.ndarray, "sites 3"]
    site_normal: Float64[np.ndarray, "sites 3"]


def facades(
    walls: Walls,
    filling: Int64[np.ndarray, "cells"],
    balconied: Bool[np.ndarray, "walls"] | None = None,
    panes_per_site: tuple[int, int] = (1, 1),
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
    """
    normal = _outward(walls)
    if balconied is None:
        balconied = np.zeros(len(normal), bool)
    lattice = _lattice(walls, normal, balconied)
    columns, rows = 2 * walls.columns + 2, 2 * walls.storeys + 3
    item, i, j, quads = lattice_quads(columns, rows)
    kind = _quad_filling(walls, filling, item, i, j)
    pane = (kind == WINDOW) & (j >= 2) & (j % 2 == 0)
    groups = (
        _grouped(walls, item[pane], (i[pane] - 1) // 2, (j[pane] - 2) // 2, *panes_per_site),
        _grouped(walls, item[pane], (i[pane] - 1) // 2, (j[pane] - 2) // 2, *_REVEALS_PER_SITE),
    )
    door = (kind == DOOR) & (j <= 2)
    semantic = np.where(door, int(Semantic.DOOR), int(Semantic.WALL))
    surface = np.where(door, walls.door[item], walls.surface[item])
    doors = _doors(walls, item[door], i[door], j[door])
    return _assemble(walls, normal, lattice, item, quads, pane, groups, door, doors, semantic, surface)


def _outward(walls: Walls) -> np.ndarray:
    along = walls.end - walls.start
    along = along / np.linalg.norm(along, axis=1)[:, None]
    return np.column_stack([along[:, 1], -along[:, 0], np.zeros(len(along))])


def _column_lines(walls: Walls, item: np.ndarray, i: np.ndarray) -> np.ndarray:
    """Position of grid line i along the wall, 0..1: wall ends and window jambs."""
    count = walls.columns[item]
    share = walls.window_share[item]
    k = (i - 1) // 2
    side = np.where(i % 2 == 1, (1 - share) / 2, (1 + share) / 2)
    return np.where(i == 0, 0.0, np.where(i == 2 * count + 1, 1.0, (k + side) / count))


def _row_lines(walls: Walls, item: np.ndarray, j: np.ndarray) -> np.ndarray:
    """Height of grid line j above the ground floor [m]: foundation, plinth, sills and heads, top."""
    storeys = walls.storeys[item]
    k = (j - 2) // 2
    floor = np.where(k > 0, walls.first_storey_m[item] + (k - 1) * walls.storey_m[item], 0.0)
    sill = np.where(k > 0, walls.sill_m[item], walls.first_sill_m[item])
    head = np.where(k > 0, walls.head_m[item], walls.first_head_m[item])
    height = floor + np.where(j % 2 == 0, sill, head)
    plinth = np.minimum(_PLINTH_M, 0.5 * walls.first_sill_m[item])
    height = np.where(j == 0, -walls.foundation_m[item], np.where(j == 1, plinth, height))
    return np.asarray(np.where(j == 2 * storeys + 2, (walls.top_m - walls.floor_m)[item], height))


def _lattice(walls: Walls, normal: np.ndarray, balconied: np.ndarray) -> _Lattice:
    columns, rows = 2 * walls.columns + 2, 2 * walls.storeys + 3
    item, i, j = ragged_grid(columns, rows)
    vertices = _on_wall(walls, item, _column_lines(walls, item, i), _row_lines(walls, item, j))
    site_columns, site_rows = (walls.columns + 1) // 2 + 1, walls.storeys + 2
    row = np.minimum(np.where(j <= 2, (j + 1) // 2, 2 + (j - 3) // 2), site_rows[item] - 1)
    site = offsets(site_columns * site_rows)[item] + row * site_columns[item] + (i // 2 + 1) // 2

    s_item, s_i, s_j = ragged_grid(site_columns, site_rows)
    x = np.minimum(2 * s_i / walls.columns[s_item], 1.0)
    x = (
        x
        + np.where(s_i == 0, 0.25, np.where(s_i == site_columns[s_item] - 1, -0.25, 0.0))
        / walls.columns[s_item]
    )
    low, high = np.maximum(2 * s_j - 1, 0), 2 * s_j
    z = (_row_lines(walls, s_item, low) + _row_lines(walls, s_item, high)) / 2
    z = np.where((s_j == 0), 0.15, z)
    raised = balconied[s_item] & (s_j >= 2) & (s_j <= walls.storeys[s_item])
    beside = (
        _row_lines(walls, s_item, high) + _row_lines(walls, s_item, np.where(raised, high + 1, high))
    ) / 2
    z = np.where(raised, beside, z)
    return _Lattice(vertices, site, _on_wall(walls, s_item, x, z), normal[s_item])


@dataclass(frozen=True, eq=False)
class _Doors:
    """Sites of doors: one near the ground, one higher up.

    Attributes
    ----------
    corner_site : int64 (quads, 4)
        Of the quads that are doors.
    position : float64 (sites, 3)
    wall : int64 (sites,)
    """

    corner_site: Int64[np.ndarray, "quads 4"]
    position: Float64[np.ndarray, "sites 3"]
    wall: Int64[np.ndarray, "sites"]


def _doors(walls: Walls, item: np.ndarray, i: np.ndarray, j: np.ndarray) -> _Doors:
    """Sites of the doors whose quads lie at columns i and rows j of walls `item`."""
    _, first, door = np.unique(item * (i.max(initial=0) + 1) + i, return_index=True, return_inverse=True)
    low, high = 2 * door.ravel(), 2 * door.ravel() + 1
    below, above = np.where(j < 2, low, high), np.where(j < 1, low, high)
    wall, column = np.repeat(item[first], 2), np.repeat(i[first], 2)
    x = (_column_lines(walls, wall, column) + _column_lines(walls, wall, column + 1)) / 2
    upper = np.arange(len(wall)) % 2 == 1
    z = np.where(upper, _DOOR_UPPER * walls.first_head_m[wall], _DOOR_LOWER_M)
    return _Doors(np.stack([below, below, above, above], axis=1), _on_wall(walls, wall, x, z), wall)


def _on_wall(walls: Walls, item: np.ndarray, x: np.ndarray, z: np.ndarray) -> np.ndarray:
    xy = walls.start[item] + (walls.end - walls.start)[item] * x[:, None]
    return np.column_stack([xy, walls.floor_m[item] + z])


def _quad_filling(
    walls: Walls, filling: np.ndarray, item: np.ndarray, i: np.ndarray, j: np.ndarray
) -> np.ndarray:
    """Filling of the window cell a quad lies in; piers are blank, the strip below a door is the door."""
    storey = np.clip((j - 2) // 2, 0, walls.storeys[item] - 1)
    column = np.clip((i - 1) // 2, 0, walls.columns[item] - 1)
    cell = offsets(walls.columns * walls.storeys)[item] + storey * walls.columns[item] + column
    return np.where(i % 2 == 1, filling[cell], BLANK)


def _grouped(
    walls: Walls, item: np.ndarray, column: np.ndarray, storey: np.ndarray, columns: int, storeys: int
) -> Int64[np.ndarray, "panes"]:
    """Number of the group of each pane: so many columns by so many storeys of a wall."""
    key = (item * (walls.storeys.max() + 1) + storey // storeys) * (
        walls.columns.max() + 1
    ) + column // columns
    return np.asarray(np.unique(key, return_inverse=True)[1].ravel())


def _leaders(group: Int64[np.ndarray, "panes"]) -> Int64[np.ndarray, "groups"]:
    """A pane near the middle of the lowest row of each group."""
    order = np.argsort(group, kind="stable")
    _, first, count = np.unique(group[order], return_index=True, return_counts=True)
    return np.asarray(order[first + (count + 1) // 4])


@dataclass(frozen=True, eq=False)
class _Reveals:
    """Sites of reveals: a sill sees the sky and a lintel the street, where the wall sees half of each.

    Attributes
    ----------
    corner_site : int64 (quads, 4)
        Four quads per opening: sill, right jamb, lintel, left jamb.
    position, normal : float64 (sites, 3)
    """

    corner_site: Int64[np.ndarray, "quads 4"]
    position: Float64[np.ndarray, "sites 3"]
    normal: Float64[np.ndarray, "sites 3"]


def _reveals(corners: np.ndarray, inner: np.ndarray, group: np.ndarray) -> _Reveals:
    """Sites of the reveals between the corners of openings (counter-clockwise from the lower left) and of panes."""
    lead = _leaders(group)
    outer, inner = corners[lead], inner[lead]
    ring = np.array([1, 2, 3, 0])
    middle = (outer + outer[:, ring] + inner + inner[:, ring]) / 4
    across = np.cross(outer[:, ring] - outer, inner - outer)
    normal = across / np.linalg.norm(across, axis=2)[..., None]
    site = (4 * group[:, None] + np.arange(4)).reshape(-1, 1)
    return _Reveals(np.repeat(site, 4, axis=1), middle.reshape(-1, 3), normal.reshape(-1, 3))


def _assemble(
    walls: Walls,
    normal: np.ndarray,
    lattice: _Lattice,
    item: np.ndarray,
    quads: np.ndarray,
    pane: Bool[np.ndarray, "quads"],
    groups: tuple[Int64[np.ndarray, "panes"], Int64[np.ndarray, "panes"]],
    door: Bool[np.ndarray, "quads"],
    doors: _Doors,
    semantic: np.ndarray,
    surface: np.ndarray,
) -> Part:
    """Solid quads, then reveals, then panes; `groups` tells which panes, and which reveals, share a site."""
    solid = ~pane
    opening = quads[pane]
    owner = item[pane]
    inner = lattice.vertices[opening] - normal[owner][:, None, :] * walls.recess_m[owner][:, None, None]
    count = len(opening)
    base = len(lattice.vertices)
    inner_id = base + np.arange(4 * count).reshape(-1, 4)
    ring = np.array([1, 2, 3, 0])
    after = opening[:, ring]
    reveals = np.stack([opening, after, inner_id[:, ring], inner_id], axis=2).reshape(-1, 4)

    site_count = len(lattice.site_position)
    door_count = len(doors.position)
    quad_site = lattice.site[quads]
    quad_site[door] = site_count + doors.corner_site
    first_pane, pane_lead = site_count + door_count, _leaders(groups[0])
    first_reveal = first_pane + len(pane_lead)
    pane_site = np.repeat((first_pane + groups[0])[:, None], 4, axis=1)
    around = _reveals(lattice.vertices[opening], inner, groups[1])

    all_quads = np.concatenate([quads[solid], reveals, inner_id])
    all_sites = np.concatenate([quad_site[solid], first_reveal + around.corner_site, pane_site])
    wall_of = np.concatenate([item[solid], np.repeat(owner, 4), owner])
    labels = np.concatenate(
        [semantic[solid], np.full(4 * count, int(Semantic.WALL)), np.full(count, int(Semantic.WINDOW))]
    )
    skins = np.concatenate([surface[solid], walls.surface[np.repeat(owner, 4)], walls.glass[owner]])
    vertices = np.concatenate([lattice.vertices, inner.reshape(-1, 3)])
    return Part(
        vertices=vertices,
        faces=quads_to_triangles(all_quads),
        surface=np.repeat(skins, 2),
        semantic=np.repeat(labels, 2),
        object=np.repeat(walls.object[wall_of], 2),
        corner_site=quads_to_triangles(all_sites),
        site_position=np.concatenate(
            [lattice.site_position, doors.position, inner.mean(axis=1)[pane_lead], around.position]
        ),
        site_normal=np.concatenate(
            [lattice.site_normal, normal[doors.wall], normal[owner[pane_lead]], around.normal]
        ),
        site_standoff=np.full(first_reveal + len(around.position), STANDOFF_M),
    )
