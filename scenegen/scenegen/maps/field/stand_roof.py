"""The roof of a stand: a thin slab that rises towards the pitch, on two rows of posts with trusses between."""

from __future__ import annotations

import numpy as np

from scenegen.classes import Semantic
from scenegen.geometry.part import Part
from scenegen.geometry.patch import patches
from scenegen.maps.field.frame import Frame
from scenegen.maps.field.grounds import AISLE_M, Stand
from scenegen.maps.field.workshop import FieldWorkshop
from scenegen.parts.fixtures.strands import prisms, two_sided

_BACK_M, _FRONT_M, _OVER_M, _THICK_M = 2.5, 3.7, 0.6, 0.16
_BAY_M, _POST_M, _TRUSS_M = 7.5, 0.11, 0.7


def stand_roof(
    stand: Stand, top_m: float, base: np.ndarray, owner: int, shop: FieldWorkshop, rng: np.random.Generator
) -> list[Part]:
    """Slab, posts and trusses.

    Parameters
    ----------
    stand : Stand
    top_m : float
        Height of the last tread above the ground.
    base : float64 (3,)
        The stand's origin in the world.
    owner : int
        Instance id.
    shop : FieldWorkshop
    rng : numpy.random.Generator
    """
    sheet, steel = shop.palette.pick("metal_roof_painted_mid", rng), shop.palette.pick("steel_painted", rng)
    corners = _slab(stand, top_m)
    world = _moved(stand.frame, corners, base[2])
    count = len(world)
    roof = np.full(count, int(Semantic.ROOF))
    slab = patches(world[:2], 3.0, np.full(2, sheet), roof[:2], np.full(2, owner))
    edges = patches(
        world[2:], 6.0, np.full(count - 2, sheet), roof[2:], np.full(count - 2, owner), lumped_rows=True
    )
    return [slab, edges, _frame(stand, top_m, base, steel, owner)]


def _moved(frame: Frame, points: np.ndarray, ground_m: float) -> np.ndarray:
    return np.concatenate([frame.world(points[..., :2]), points[..., 2:] + ground_m], axis=-1)


def _underside(stand: Stand, top_m: float, y: np.ndarray) -> np.ndarray:
    """Height [m] of the slab's underside at distances from the front edge."""
    share = (y + _OVER_M) / (stand.depth_m + 2 * _OVER_M)
    return np.asarray(top_m + _FRONT_M + (_BACK_M - _FRONT_M) * share)


def _slab(stand: Stand, top_m: float) -> np.ndarray:
    """Top, underside and four edges (6, 4, 3) in the stand's frame."""
    a, y0, y1 = stand.length_m / 2 + _OVER_M, -_OVER_M, stand.depth_m + _OVER_M
    z0, z1 = _underside(stand, top_m, np.array([y0, y1]))
    low = np.array([[-a, y0, z0], [a, y0, z0], [a, y1, z1], [-a, y1, z1]])
    high = low + np.array([0.0, 0.0, _THICK_M])
    quads = [high, low[::-1]]
    for k in range(4):
        j = (k + 1) % 4
        quads.append(np.array([low[k], low[j], high[j], high[k]]))
    return np.array(quads)


def _frame(stand: Stand, top_m: float, base: np.ndarray, steel: int, owner: int) -> Part:
    """Posts at the back and behind the walkway, a lattice truss under the slab above each pair."""
    bays = max(round(stand.length_m / _BAY_M), 2)
    x = np.linspace(-stand.length_m / 2 + 0.3, stand.length_m / 2 - 0.3, bays + 1)
    front, back = AISLE_M - 0.25, stand.depth_m - 0.09
    members, bay = [], []
    for k, at in enumerate(x):
        under = _underside(stand, top_m, np.array([front, back, -_OVER_M])) - 0.01
        rows = [([at, front, 0.3], [at, front, under[0]]), ([at, back, top_m], [at, back, under[1]])]
        rows += _truss(at, front, back, stand, top_m)
        rows.append(([at, -_OVER_M, under[2] - 0.05], [at, front, under[0] - _TRUSS_M]))
        members += rows
        bay += [k] * len(rows)
    ends = np.array(members, np.float64)
    moved = _moved(stand.frame, ends.reshape(-1, 3), base[2]).reshape(-1, 2, 3)
    vertices, faces = prisms(moved[:, 0], moved[:, 1], _POST_M * 0.7, sides=6)
    middle = np.column_stack([x, np.full(len(x), front), np.full(len(x), top_m + 2.0)])
    facing = np.tile([[0.0, -1.0]], (len(x), 1))
    turned = np.column_stack([Frame(0.0, 0.0, stand.frame.heading_rad).world(facing), np.zeros(len(x))])
    panel = np.repeat(np.array(bay), 12)
    own = np.full(len(x), owner)
    middle = _moved(stand.frame, middle, base[2])
    return two_sided(vertices, faces, panel, middle, turned, steel, int(Semantic.POLE), own, reach_m=0.12)


def _truss(
    x: float, front: float, back: float, stand: Stand, top_m: float
) -> list[tuple[list[float], list[float]]]:
    """Upper and lower chord and the diagonals between them."""
    count = max(round((back - front) / 1.6), 2)
    y = np.linspace(front, back, count + 1)
    upper = _underside(stand, top_m, y) - 0.08
    lower = upper - _TRUSS_M * np.linspace(1.0, 0.45, count + 1)
    rows = []
    for k in range(count):
        rows.append(([x, y[k], upper[k]], [x, y[k + 1], upper[k + 1]]))
        rows.append(([x, y[k], lower[k]], [x, y[k + 1], lower[k + 1]]))
        a, b = (lower, upper) if k % 2 else (upper, lower)
        rows.append(([x, y[k], a[k]], [x, y[k + 1], b[k + 1]]))
    return rows
