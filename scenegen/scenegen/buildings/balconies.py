"""Balconies before some windows of apartment buildings and towers."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from jaxtyping import Bool, Int64

from scenegen.buildings.building import Building
from scenegen.classes import Semantic
from scenegen.geometry.facade import WINDOW, Walls
from scenegen.geometry.modelling import Modeller
from scenegen.geometry.part import Part
from scenegen.geometry.template import Template, place

_DEPTH_M, _RAIL_M, _SLAB_M, _THICK_M = 1.15, 1.0, 0.14, 0.06


def _balcony() -> Template:
    """Of unit width along +x, projecting to -y from a wall in the plane y = 0, floor at z = 0."""
    model = Modeller()
    d, r, s, t = _DEPTH_M, _RAIL_M, _SLAB_M, _THICK_M
    a, b = -0.5, 0.5

    def side(x: float, turn: int) -> list[list[float]]:
        quad = [[x, 0, -s], [x, -d, -s], [x, -d, r], [x, 0, r]]
        return quad[::turn]

    outer = [[[a, -d, -s], [b, -d, -s], [b, -d, r], [a, -d, r]], side(a, 1), side(b, -1)]
    under = [[[a, 0, -s], [b, 0, -s], [b, -d, -s], [a, -d, -s]]]
    floor = [[[a, -d, 0], [b, -d, 0], [b, 0, 0], [a, 0, 0]]]
    inner = [
        [[b - t, t - d, 0], [a + t, t - d, 0], [a + t, t - d, r], [b - t, t - d, r]],
        [[a + t, t - d, 0], [a + t, 0, 0], [a + t, 0, r], [a + t, t - d, r]],
        [[b - t, 0, 0], [b - t, t - d, 0], [b - t, t - d, r], [b - t, 0, r]],
    ]
    rim = [
        [[a, -d, r], [b, -d, r], [b - t, t - d, r], [a + t, t - d, r]],
        [[a, 0, r], [a, -d, r], [a + t, t - d, r], [a + t, 0, r]],
        [[b, -d, r], [b, 0, r], [b - t, 0, r], [b - t, t - d, r]],
    ]
    for quads in (outer, under, floor, inner):
        model.quads(np.array(quads, np.float64), 0, Semantic.BALCONY)
    shared = np.array(rim, np.float64)
    site = model.site(np.array([0.0, t / 2 - d, r]), np.array([0.0, 0.0, 1.0]))
    faces = np.arange(4 * len(shared)).reshape(-1, 4)[:, [0, 1, 2, 0, 2, 3]].reshape(-1, 3)
    model.mesh(shared.reshape(-1, 3), faces, 0, Semantic.BALCONY, np.full(faces.shape, site))
    return model.finish()


@dataclass(frozen=True, eq=False)
class BalconyPlan:
    """Cells of the window grids that have a balcony before them.

    Attributes
    ----------
    wall, column, storey : int64 (balconies,)
    """

    wall: Int64[np.ndarray, "balconies"]
    column: Int64[np.ndarray, "balconies"]
    storey: Int64[np.ndarray, "balconies"]

    def walls(self, count: int) -> Bool[np.ndarray, "walls"]:
        """Which of `count` walls have any."""
        return np.bincount(self.wall, minlength=count) > 0


def plan_balconies(
    walls: Walls, filling: np.ndarray, buildings: Sequence[Building], rng: np.random.Generator
) -> BalconyPlan:
    """Balconies at every second or third window column of chosen walls, above the ground floor."""
    wall, column, storey = walls.cells()
    chosen = np.array([b.object for b in buildings if b.style.balconies], np.int64)
    length = np.linalg.norm(walls.end - walls.start, axis=1)
    rhythm, phase = rng.integers(2, 4, len(length)), rng.integers(0, 3, len(length))
    fits = np.isin(walls.object, chosen) & (length / walls.columns > 2.4) & (length > 9.0)
    fits &= rng.uniform(size=len(length)) < 0.6
    here = fits[wall] & (storey > 0) & (filling == WINDOW) & ((column + phase[wall]) % rhythm[wall] == 0)
    return BalconyPlan(wall[here], column[here], storey[here])


def build_balconies(walls: Walls, plan: BalconyPlan) -> Part:
    """Balconies as planned."""
    wall, column, storey = plan.wall, plan.column, plan.storey
    length = np.linalg.norm(walls.end - walls.start, axis=1)
    along = (walls.end - walls.start) / length[:, None]
    middle = walls.start[wall] + along[wall] * ((column + 0.5) / walls.columns[wall] * length[wall])[:, None]
    floor = walls.floor_m[wall] + walls.first_storey_m[wall] + (storey - 1) * walls.storey_m[wall]
    heading = np.arctan2(along[wall, 1], along[wall, 0])
    width = np.minimum(0.86 * length[wall] / walls.columns[wall], 3.6)
    ones = np.ones(len(wall))
    return place(
        _balcony(),
        np.column_stack([middle, floor]),
        heading,
        np.column_stack([width, ones, ones]),
        walls.surface[wall][:, None],
        walls.object[wall],
    )
