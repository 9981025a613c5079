"""Stands: stepped rows on solid concrete, seats, aisles with steps, and a roof on posts over the main one."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from scenegen.classes import Semantic
from scenegen.geometry.modelling import Modeller
from scenegen.geometry.part import Part
from scenegen.geometry.patch import patches
from scenegen.geometry.template import Template, place
from scenegen.maps.field.grounds import AISLE_M, TREAD_M, Stand
from scenegen.maps.field.stand_roof import stand_roof
from scenegen.maps.field.workshop import FieldWorkshop

RISE_M, WALK_M = 0.40, 0.62
"""Rise of a row; height of the walkway before the first row [m]."""

SEAT_Y_M = 0.56
"""Middle of the seats behind the front edge of their tread [m]."""

_BELOW_M, _RAIL_M, _WALL_M = 0.6, 0.95, 1.15
_BLOCK, _SEAT_M, _STAIRS_M = 4, 0.5, 1.3
_BLOCKS_BETWEEN_STAIRS = 5
_SPACING_M = 3.2


@dataclass(frozen=True, eq=False)
class Seats:
    """Seats of one stand.

    Attributes
    ----------
    position : float64 (seats, 3)
        On the tread below the middle of each seat [m], in the world.
    heading_rad : float
        Where people look.
    """

    position: np.ndarray
    heading_rad: float


def row_height_m(row: np.ndarray | int) -> np.ndarray:
    """Height of the tread of a row above the ground [m]."""
    return np.asarray(WALK_M + RISE_M * (np.asarray(row) + 1.0))


def build_stand(stand: Stand, shop: FieldWorkshop, rng: np.random.Generator) -> tuple[list[Part], Seats]:
    """A stand as one instance, and where its seats are."""
    owner = shop.builder.new_objects()
    ground = float(shop.relief(np.array([[stand.frame.x_m, stand.frame.y_m]]))[0])
    concrete, steel = shop.palette.pick("concrete_pavement", rng), shop.palette.pick("steel_painted", rng)
    plastic = shop.palette.special("plastic_dark", "seat", solar_absorptance=0.72)
    base = np.array([stand.frame.x_m, stand.frame.y_m, ground])
    steps, semantic = _shell(stand)
    corners = _raise(stand, steps, ground)
    skin, own = np.full(len(corners), concrete), np.full(len(corners), owner)
    parts = [patches(corners, _SPACING_M, skin, semantic, own, lumped_rows=True)]
    x, stairs = _blocks(stand)
    row, block = (g.ravel() for g in np.meshgrid(np.arange(stand.rows), np.arange(len(x)), indexing="ij"))
    local = np.column_stack([x[block], AISLE_M + row * TREAD_M + SEAT_Y_M, row_height_m(row)])
    parts.append(_copies(seat_block(), local, stand, ground, plastic, owner))
    row, stair = (
        g.ravel() for g in np.meshgrid(np.arange(stand.rows), np.arange(len(stairs)), indexing="ij")
    )
    at = np.column_stack([stairs[stair], AISLE_M + row * TREAD_M - TREAD_M / 4, row_height_m(row) - RISE_M])
    parts.append(_copies(half_step(), at, stand, ground, concrete, owner))
    parts.append(_copies(entrance(), _entrances(stand), stand, ground, concrete, owner))
    rail = np.column_stack([_bays(stand.length_m, 2.0), np.zeros((_bays(stand.length_m, 2.0).size, 2))])
    rail[:, 1:] = [0.06, WALK_M]
    parts.append(_copies(rail_bay(stand.length_m / len(rail)), rail, stand, ground, steel, owner))
    if stand.roofed:
        parts += stand_roof(stand, float(row_height_m(stand.rows - 1)), base, owner, shop, rng)
    offset = ((np.arange(_BLOCK) - (_BLOCK - 1) / 2) * _SEAT_M)[None, :, None] * np.array([1.0, 0.0, 0.0])
    seats = (local[:, None, :] + offset).reshape(-1, 3)
    world = np.column_stack([stand.frame.world(seats[:, :2]), seats[:, 2] + ground])
    return parts, Seats(world, stand.frame.heading_rad - np.pi / 2)


def _raise(stand: Stand, corners: np.ndarray, ground_m: float) -> np.ndarray:
    """Local quads in the world."""
    flat = corners.reshape(-1, 3)
    moved = np.column_stack([stand.frame.world(flat[:, :2]), flat[:, 2] + ground_m])
    return moved.reshape(corners.shape)


def _copies(
    template: Template, local: np.ndarray, stand: Stand, ground_m: float, surface: int, owner: int
) -> Part:
    """Copies of a template at local places, headed along the rows."""
    count = len(local)
    position = np.column_stack([stand.frame.world(local[:, :2]), local[:, 2] + ground_m])
    heading = np.full(count, stand.frame.heading_rad)
    skins = np.full((count, 1), surface)
    return place(template, position, heading, np.ones((count, 3)), skins, np.full(count, owner))


def _shell(stand: Stand) -> tuple[np.ndarray, np.ndarray]:
    """Treads, risers, ends and back wall in the stand's frame (quads, 4, 3), and their classes."""
    a, rows = stand.length_m / 2, stand.rows
    edge = np.concatenate([[0.0], AISLE_M + TREAD_M * np.arange(rows + 1)])
    height = np.concatenate([[WALK_M], row_height_m(np.arange(rows))])
    low = np.concatenate([[-_BELOW_M], height[:-1]])
    quads = []
    for y0, y1, z, below in zip(edge[:-1], edge[1:], height, low, strict=True):
        quads.append([[-a, y0, z], [a, y0, z], [a, y1, z], [-a, y1, z]])
        quads.append([[-a, y0, below], [a, y0, below], [a, y0, z], [-a, y0, z]])
        quads.append([[a, y0, -_BELOW_M], [a, y1, -_BELOW_M], [a, y1, z], [a, y0, z]])
        quads.append([[-a, y1, -_BELOW_M], [-a, y0, -_BELOW_M], [-a, y0, z], [-a, y1, z]])
    back, top, seat = edge[-1], height[-1] + _WALL_M, height[-1]
    quads.append([[a, back, -_BELOW_M], [-a, back, -_BELOW_M], [-a, back, top], [a, back, top]])
    quads.append(
        [[-a, back - 0.18, seat], [a, back - 0.18, seat], [a, back - 0.18, top], [-a, back - 0.18, top]]
    )
    quads.append([[-a, back - 0.18, top], [a, back - 0.18, top], [a, back, top], [-a, back, top]])
    for x, turn in ((a, 1), (-a, -1)):
        quads.append([[x, back - 0.18, seat], [x, back, seat], [x, back, top], [x, back - 0.18, top]][::turn])
    semantic = np.full(len(quads), int(Semantic.STAND))
    semantic[-5] = int(Semantic.WALL)
    return np.array(quads), semantic


def _blocks(stand: Stand) -> tuple[np.ndarray, np.ndarray]:
    """Middles of the blocks of seats along a row, and of the stairs between groups of blocks."""
    wide = _BLOCK * _SEAT_M
    blocks, stairs, x = [], [], 0.4
    while x + wide <= stand.length_m - 0.4:
        blocks.append(x + wide / 2)
        x += wide
        if len(blocks) % _BLOCKS_BETWEEN_STAIRS == 0 and x + wide + _STAIRS_M < stand.length_m:
            stairs.append(x + _STAIRS_M / 2)
            x += _STAIRS_M
    shift = -(x + 0.4) / 2
    return np.array(blocks) + shift, np.array(stairs) + shift


def _bays(length_m: float, bay_m: float) -> np.ndarray:
    """Middles of equal bays along a stand."""
    count = max(round(length_m / bay_m), 1)
    return np.asarray((np.arange(count) + 0.5) / count * length_m - length_m / 2)


def _entrances(stand: Stand) -> np.ndarray:
    """Where flights of steps lead up to the walkway, at both ends."""
    x = stand.length_m / 2 - 1.2
    return np.array([[-x, 0.0, 0.0], [x, 0.0, 0.0]])


def seat_block() -> Template:
    """Four tip-up seats that look along -y, on a tread at z = 0; one slot, three sites."""
    model = Modeller()
    half = _BLOCK * _SEAT_M / 2
    pan = model.site(np.array([0.0, 0.0, 0.46]), np.array([0.0, 0.0, 1.0]))
    front = model.site(np.array([0.0, 0.14, 0.65]), np.array([0.0, -1.0, 0.3]))
    back = model.site(np.array([0.0, 0.26, 0.65]), np.array([0.0, 1.0, 0.1]))
    for k in range(_BLOCK):
        x0 = -half + k * _SEAT_M + 0.03
        _slab(model, (x0, -0.18, 0.40), (x0 + _SEAT_M - 0.06, 0.18, 0.45), pan)
        _slab(model, (x0, 0.17, 0.47), (x0 + _SEAT_M - 0.06, 0.22, 0.80), front, back)
    for x in (-0.75 * half, 0.7 * half):
        _slab(model, (x, 0.0, 0.0), (x + 0.05, 0.08, 0.40), back)
    return model.finish()


def _slab(
    model: Modeller,
    low: tuple[float, float, float],
    high: tuple[float, float, float],
    site: int,
    behind: int = -1,
) -> None:
    """A closed box whose faces share one site, or two: those that look along +y take `behind`."""
    (x0, y0, z0), (x1, y1, z1) = low, high
    p = np.array([[x0, y0, z0], [x1, y0, z0], [x1, y1, z0], [x0, y1, z0]])
    points = np.concatenate([p, p + np.array([0.0, 0.0, z1 - z0])])
    quads = np.array([[0, 1, 5, 4], [1, 2, 6, 5], [2, 3, 7, 6], [3, 0, 4, 7], [4, 5, 6, 7], [3, 2, 1, 0]])
    sites = np.full(6, site)
    if behind >= 0:
        sites[2] = behind
    faces = quads[:, [0, 1, 2, 0, 2, 3]].reshape(-1, 3)
    corner_site = np.repeat(np.repeat(sites, 2)[:, None], 3, axis=1)
    model.mesh(points, faces, 0, Semantic.STAND, corner_site)


def half_step() -> Template:
    """The step between two treads of a stair; its upper side lies half a rise above the lower tread."""
    model = Modeller()
    a, b = _STAIRS_M / 2 - 0.05, TREAD_M / 4 - 0.005
    model.box((-a, -b, 0.0), (a, b, RISE_M / 2), 0, Semantic.STAND)
    return model.finish()


def entrance() -> Template:
    """Three steps from the ground to the walkway, before the front wall."""
    model = Modeller()
    for k in range(3):
        y1 = -0.3 * k - 0.004
        model.box((-0.9, y1 - 0.3, -0.2), (0.9, y1, WALK_M * (3 - k) / 4), 0, Semantic.STAND)
    return model.finish()


def rail_bay(length_m: float) -> Template:
    """A bay of the railing in front of the walkway: two rails and a post; one slot."""
    model = Modeller()
    a = length_m / 2
    for z in (0.5, _RAIL_M):
        model.tube(np.array([-a, 0, z]), np.array([a, 0, z]), 0.025, 0.025, 0, Semantic.STAND, sides=5)
    model.tube(np.array([-a, 0, -0.02]), np.array([-a, 0, _RAIL_M]), 0.025, 0.025, 0, Semantic.STAND, sides=5)
    return model.finish()
