"""The pier: planks on joists, bents of timber piles with braces, a railing, and a wider head."""

from __future__ import annotations

import numpy as np

from scenegen.classes import Semantic
from scenegen.geometry.modelling import Modeller
from scenegen.geometry.part import Part
from scenegen.geometry.template import Template, place
from scenegen.maps.coastline.layout import Layout
from scenegen.maps.coastline.workshop import CoastWorkshop

PLANKS, TIMBER = 0, 1
"""Surface slots of a bay."""

WIDTH_M, HEAD_M = 3.6, (10.0, 9.0)
"""Width of the deck; length and width of the head [m]."""

_BAY_M, _PLANK_M, _GAP_M = 5.0, 0.24, 0.025
_DRIVEN_M = 1.6
"""How far piles reach below the sea bed."""


def bay(length_m: float, width_m: float, sides: tuple[bool, bool, bool]) -> Template:
    """A piece of the deck from x = 0 to `length_m`, its walkway at z = 0.

    Parameters
    ----------
    length_m, width_m : float
    sides : (bool, bool, bool)
        Railing to the right, to the left, and across the far end.
    """
    model, half = Modeller(), width_m / 2
    count = round(length_m / _PLANK_M)
    x = np.arange(count) * length_m / count
    end = x + length_m / count - _GAP_M
    planks = np.zeros((count, 4, 3))
    planks[:, :, 0] = np.stack([x, end, end, x], axis=1)
    planks[:, :, 1] = np.array([-half, -half, half, half])
    model.quads(planks, PLANKS, Semantic.PIER)
    low, edge = -0.14, np.array([[0, -half], [length_m, -half], [length_m, half], [0, half]])
    under = np.column_stack([edge, np.full(4, low)])[::-1]
    model.quads(under[None], TIMBER, Semantic.PIER)
    for a, b in ((0, 1), (1, 2), (2, 3), (3, 0)):
        lower, upper = (
            np.column_stack([edge[[a, b]], [low, low]]),
            np.column_stack([edge[[b, a]], [0.0, 0.0]]),
        )
        model.quads(np.concatenate([lower, upper])[None], TIMBER, Semantic.PIER)
    for y in (-0.8 * half, 0.0, 0.8 * half):
        model.box((0.0, y - 0.08, -0.45), (length_m, y + 0.08, low), TIMBER, Semantic.PIER, covered=True)
    _cap(model, 0.5 * _BAY_M, half)
    _railing(model, length_m, half, sides)
    return model.finish()


def _cap(model: Modeller, x: float, half: float) -> None:
    """The beam across a pair of piles, and a cross of braces below it."""
    model.box((x - 0.13, -half, -0.7), (x + 0.13, half, -0.45), TIMBER, Semantic.PIER)
    high, low = 0.8 * half * np.array([0.0, 1.0, 0.0]), np.array([x, 0.0, 0.0])
    up = np.array([0.0, 0.0, 1.0])
    for side in (-1.0, 1.0):
        ends = low - side * high - 2.4 * up, low + side * high - 0.7 * up
        model.tube(*ends, 0.06, 0.06, TIMBER, Semantic.PIER, sides=4)


def piles(width_m: float) -> Template:
    """A pair of piles from z = -1 up to the deck at z = 0; scale it to its length. Slots as of a bay."""
    model = Modeller()
    for y in (-0.4 * width_m, 0.4 * width_m):
        foot, top = np.array([0.0, y, -1.0]), np.array([0.0, y, -0.02])
        model.tube(foot, top, 0.17, 0.15, TIMBER, Semantic.PIER, sides=8, sites=3)
    return model.finish()


def _railing(model: Modeller, length_m: float, half: float, sides: tuple[bool, bool, bool]) -> None:
    """Posts with a hand rail and two more."""
    runs = []
    if sides[0]:
        runs.append((np.array([0.0, -half + 0.06, 0.0]), np.array([length_m, -half + 0.06, 0.0])))
    if sides[1]:
        runs.append((np.array([0.0, half - 0.06, 0.0]), np.array([length_m, half - 0.06, 0.0])))
    if sides[2]:
        runs.append((np.array([length_m - 0.06, -half, 0.0]), np.array([length_m - 0.06, half, 0.0])))
    up = np.array([0.0, 0.0, 1.0])
    for start, end in runs:
        posts = max(round(float(np.linalg.norm(end - start)) / 1.7), 1)
        for t in (np.arange(posts) + 0.5) / posts:
            foot = start + t * (end - start)
            model.tube(foot - 0.3 * up, foot + 1.05 * up, 0.055, 0.05, TIMBER, Semantic.PIER, sides=4)
        for z in (0.4, 0.72, 1.05):
            model.tube(start + z * up, end + z * up, 0.04, 0.04, TIMBER, Semantic.PIER, sides=4)


def build_pier(layout: Layout, shop: CoastWorkshop, rng: np.random.Generator) -> list[Part]:
    """The world's pier, one instance; its piles stand in the sea bed."""
    start, end = layout.pier
    length = float(np.linalg.norm(end - start))
    ahead = (end - start) / length
    heading = float(np.arctan2(ahead[1], ahead[0]))
    count = max(int((length - HEAD_M[0]) / _BAY_M), 1)
    owner = shop.builder.new_objects()
    planks = shop.palette.variants("timber_weathered")
    skins = np.column_stack([np.full(count, planks[0]), np.full(count, planks[-1])])
    feet = start + np.arange(count)[:, None] * _BAY_M * ahead
    position = np.column_stack([feet, np.full(count, layout.pier_deck_m)])
    parts = [
        place(bay(_BAY_M, WIDTH_M, (True, True, False)), position, np.full(count, heading), np.ones((count, 3)),
              skins, np.full(count, owner))
    ]  # fmt: skip
    tip = np.append(start + count * _BAY_M * ahead, layout.pier_deck_m)
    head = bay(*HEAD_M, (True, True, True))
    parts.append(place(head, tip[None], np.array([heading]), np.ones((1, 3)), skins[:1], np.array([owner])))
    bents = np.concatenate([position[:, :2], tip[None, :2]]) + 0.5 * _BAY_M * ahead
    wide = np.append(np.ones(count), HEAD_M[1] / WIDTH_M)
    long = layout.pier_deck_m - shop.relief(bents) + _DRIVEN_M
    parts.append(
        place(
            piles(WIDTH_M),
            np.column_stack([bents, np.full(count + 1, layout.pier_deck_m)]),
            np.full(count + 1, heading),
            np.column_stack([np.ones(count + 1), wide, long]),
            skins[[*range(count), 0]],
            np.full(count + 1, owner),
        )
    )
    return parts
