"""Planar walls as tensor grids: jambs of the window columns across, sills and heads of the storeys upwards.

The thermal sites of a wall are coarser than its vertices: one per crossing of every second pier with a spandrel,
shared by all grid points around that crossing.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from jaxtyping import Bool, Float64, Int64

from scenegen.geometry.ragged import offsets, ragged_grid

_PLINTH_M = 0.6


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
class Lattice:
    """Grid points of all walls."""

    vertices: Float64[np.ndarray, "points 3"]
    site: Int64[np.ndarray, "points"]
    site_position: Float64[np.ndarray, "sites 3"]
    site_normal: Float64[np.ndarray, "sites 3"]


def outward(walls: Walls) -> Float64[np.ndarray, "walls 3"]:
    """Level unit normals of the walls."""
    along = walls.end - walls.start
    along = along / np.linalg.norm(along, axis=1)[:, None]
    return np.column_stack([along[:, 1], -along[:, 0], np.zeros(len(along))])


def column_lines(walls: Walls, item: np.ndarray, i: np.ndarray) -> np.ndarray:
    """Position of grid line i along the wall, 0..1: wall ends and window jambs."""
    count = walls.columns[item]
    share = walls.window_share[item]
    k = (i - 1) // 2
    side = np.where(i % 2 == 1, (1 - share) / 2, (1 + share) / 2)
    return np.where(i == 0, 0.0, np.where(i == 2 * count + 1, 1.0, (k + side) / count))


def row_lines(walls: Walls, item: np.ndarray, j: np.ndarray) -> np.ndarray:
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


def lattice(
    walls: Walls, normal: Float64[np.ndarray, "walls 3"], balconied: Bool[np.ndarray, "walls"]
) -> Lattice:
    """Grid points and sites of all walls."""
    columns, rows = 2 * walls.columns + 2, 2 * walls.storeys + 3
    item, i, j = ragged_grid(columns, rows)
    vertices = on_wall(walls, item, column_lines(walls, item, i), row_lines(walls, item, j))
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
    z = (row_lines(walls, s_item, low) + row_lines(walls, s_item, high)) / 2
    z = np.where((s_j == 0), 0.15, z)
    raised = balconied[s_item] & (s_j >= 2) & (s_j <= walls.storeys[s_item])
    beside = (row_lines(walls, s_item, high) + row_lines(walls, s_item, np.where(raised, high + 1, high))) / 2
    z = np.where(raised, beside, z)
    return Lattice(vertices, site, on_wall(walls, s_item, x, z), normal[s_item])


def on_wall(walls: Walls, item: np.ndarray, x: np.ndarray, z: np.ndarray) -> np.ndarray:
    """Points of walls `item` at shares x of their length, and heights z [m] above their floors."""
    xy = walls.start[item] + (walls.end - walls.start)[item] * x[:, None]
    return np.column_stack([xy, walls.floor_m[item] + z])
