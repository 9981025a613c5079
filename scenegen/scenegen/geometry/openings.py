"""What is cut into walls, and who shares a thermal site there: doors, panes, reveals.

Panes have sites of their own, or share one with their neighbours; and so do the reveals of a few windows: sills see
the sky where the wall sees the street.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from jaxtyping import Float64, Int64

from scenegen.geometry.wall_grid import Walls, column_lines, on_wall

_DOOR_LOWER_M, _DOOR_UPPER = 0.3, 0.7
"""Height of the two sites of a door: above the floor, and in heights of its head."""


@dataclass(frozen=True, eq=False)
class Doors:
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


def doors(walls: Walls, item: np.ndarray, i: np.ndarray, j: np.ndarray) -> Doors:
    """Sites of the doors whose quads lie at columns i and rows j of walls `item`."""
    _, first, door = np.unique(item * (i.max(initial=0) + 1) + i, return_index=True, return_inverse=True)
    low, high = 2 * door.ravel(), 2 * door.ravel() + 1
    below, above = np.where(j < 2, low, high), np.where(j < 1, low, high)
    wall, column = np.repeat(item[first], 2), np.repeat(i[first], 2)
    x = (column_lines(walls, wall, column) + column_lines(walls, wall, column + 1)) / 2
    upper = np.arange(len(wall)) % 2 == 1
    z = np.where(upper, _DOOR_UPPER * walls.first_head_m[wall], _DOOR_LOWER_M)
    return Doors(np.stack([below, below, above, above], axis=1), on_wall(walls, wall, x, z), wall)


def grouped(
    walls: Walls,
    item: Int64[np.ndarray, "panes"],
    column: Int64[np.ndarray, "panes"],
    storey: Int64[np.ndarray, "panes"],
    glass: Int64[np.ndarray, "panes"],
    cell: tuple[int, int],
) -> Int64[np.ndarray, "panes"]:
    """Number of the group of each pane: so many columns by so many storeys of a wall, of one kind of glass."""
    low = glass.min(initial=0)
    key = item * (walls.storeys.max() + 1) + storey // cell[1]
    key = key * (walls.columns.max() + 1) + column // cell[0]
    key = key * (glass.max(initial=0) - low + 1) + glass - low
    return np.asarray(np.unique(key, return_inverse=True)[1].ravel())


def leaders(group: Int64[np.ndarray, "panes"]) -> Int64[np.ndarray, "groups"]:
    """A pane near the middle of the lowest row of each group."""
    order = np.argsort(group, kind="stable")
    _, first, count = np.unique(group[order], return_index=True, return_counts=True)
    return np.asarray(order[first + (count + 1) // 4])


@dataclass(frozen=True, eq=False)
class Reveals:
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


def reveals(corners: np.ndarray, inner: np.ndarray, group: np.ndarray) -> Reveals:
    """Sites of the reveals between the corners of openings (counter-clockwise from the lower left) and of panes."""
    lead = leaders(group)
    outer, inner = corners[lead], inner[lead]
    ring = np.array([1, 2, 3, 0])
    middle = (outer + outer[:, ring] + inner + inner[:, ring]) / 4
    across = np.cross(outer[:, ring] - outer, inner - outer)
    normal = across / np.linalg.norm(across, axis=2)[..., None]
    site = (4 * group[:, None] + np.arange(4)).reshape(-1, 1)
    return Reveals(np.repeat(site, 4, axis=1), middle.reshape(-1, 3), normal.reshape(-1, 3))
