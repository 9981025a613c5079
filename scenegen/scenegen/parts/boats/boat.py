"""Boats as templates: floating at z = 0, facing +x."""

from __future__ import annotations

from functools import cache
from itertools import pairwise

import numpy as np

from scenegen.classes import Semantic
from scenegen.foundation.errors import InputError, nearest
from scenegen.geometry.part import LUMP_STANDOFF_M
from scenegen.geometry.template import Template
from scenegen.parts.boats.hull import HullShape, hull
from scenegen.parts.boats.slots import DECK, ENGINE, EXHAUST, GLASS, HULL, METAL, SAIL
from scenegen.parts.lofts import fan_faces, loft_faces
from scenegen.parts.skin import Skin

KINDS = ("rowing", "sailing", "motor", "fishing")

_SHAPES = {
    "rowing": HullShape(4.2, 1.5, 0.18, (0.48, 0.4, 0.62), 0.68, 0.25, floor_m=0.06, decked=0.0),
    "sailing": HullShape(9.4, 3.0, 0.45, (0.85, 0.9, 1.15), 0.6, 0.7),
    "motor": HullShape(6.4, 2.3, 0.35, (0.75, 0.8, 1.05), 0.9, 0.8, floor_m=0.2, decked=0.42),
    "fishing": HullShape(11.5, 3.8, 0.8, (1.1, 1.15, 2.1), 0.85, 0.7),
}
_HEIGHT_M = {"rowing": 0.75, "sailing": 12.6, "motor": 1.5, "fishing": 6.2}
_RIG_M = 0.006
"""Radius of stays."""


def size_m(kind: str) -> tuple[float, float, float]:
    """Length, beam and height above the water [m]."""
    if kind not in KINDS:
        raise InputError(f"unknown boat '{kind}'{nearest(kind, KINDS)}")
    return _SHAPES[kind].length_m, _SHAPES[kind].beam_m, _HEIGHT_M[kind]


@cache
def boat(kind: str, running: bool = False) -> Template:
    """A boat of one kind; slots are those of `scenegen.parts.boats.slots`.

    Parameters
    ----------
    kind : str
        "rowing", "sailing", "motor" or "fishing".
    running : bool
        A sailing boat has its sails set; others look the same (their engines are warm by their surfaces).
    """
    size_m(kind)
    skin = Skin(Semantic.BOAT)
    hull(skin, _SHAPES[kind])
    {"rowing": _rowing, "sailing": _sailing, "motor": _motor, "fishing": _fishing}[kind](skin, running)
    return skin.finish()


def _at(*xyz: float) -> np.ndarray:
    return np.array(xyz, np.float64)


def _rowing(skin: Skin, running: bool) -> None:
    for x, half in ((-1.45, 0.53), (-0.35, 0.61), (0.8, 0.5)):
        skin.box((x, -half, 0.26), (x + 0.24, half, 0.3), DECK)
    for side in (-1.0, 1.0):
        swing = 0.5 if running else 0.08
        lock = _at(-0.1, side * 0.74, 0.46)
        blade = lock + _at(0.9 if not running else 0.3, side * 2.2 * swing, -0.38 if running else 0.02)
        skin.tube(_at(-0.5, side * 0.3, 0.5), lock, (0.02, 0.02), DECK, 5)
        skin.tube(lock, blade, (0.02, 0.025), DECK, 5)


def _cabin(
    skin: Skin, x0: float, x1: float, half: tuple[float, float], z: tuple[float, float], glass: bool
) -> None:
    """A deckhouse that tapers upwards; windows are bands on its sides."""
    low, high = z
    ring = np.array([[x0, -half[0]], [x1, -half[0] * 0.8], [x1, half[0] * 0.8], [x0, half[0]]])
    top = np.array([[x0 + 0.1, -half[1]], [x1 - 0.35 * (high - low), -half[1] * 0.8]])
    top = np.concatenate([top, top[::-1] * [1.0, -1.0]])
    levels = (0.0, 0.42, 0.86, 1.0) if glass else (0.0, 1.0)
    rows = [np.column_stack([ring + f * (top - ring), np.full(4, low + f * (high - low))]) for f in levels]
    for k in range(len(rows) - 1):
        points = np.concatenate([rows[k], rows[k + 1]])
        faces = np.array(
            [[0, 1, 5], [0, 5, 4], [1, 2, 6], [1, 6, 5], [2, 3, 7], [2, 7, 6], [3, 0, 4], [3, 4, 7]]
        )
        skin.add(points, faces, GLASS if glass and k == 1 else HULL)
    skin.add(rows[-1], np.array([[0, 1, 2], [0, 2, 3]]), HULL)
    middle = 0.5 * (x0 + x1)
    skin.site(HULL, _at(middle, 0.0, high + 0.01), _at(0.0, 0.0, 1.0))
    if glass:
        level = low + 0.64 * (high - low)
        for y in (-1.0, 1.0):
            skin.site(GLASS, _at(middle, y * (half[0] + 0.02), level), _at(0.0, y, 0.1))
        skin.site(GLASS, _at(x1 + 0.02, 0.0, level), _at(1.0, 0.0, 0.3))


def _sailing(skin: Skin, running: bool) -> None:
    _cabin(skin, -1.0, 2.2, (0.95, 0.8), (0.9, 1.4), True)
    mast, foot, top = 0.7, 1.4, 12.6
    skin.around(METAL, (mast, 0.0, 7.0))
    skin.tube(_at(mast, 0.0, foot - 0.1), _at(mast, 0.0, top), (0.085, 0.06), METAL, 8)
    for z in (5.4, 9.2):
        skin.tube(_at(mast, -0.75, z), _at(mast, 0.75, z), (0.02, 0.02), METAL, 4)
    for end in (_at(4.6, 0.0, 1.2), _at(-4.6, 0.0, 0.95)):
        skin.tube(end, _at(mast, 0.0, top - 0.1), (_RIG_M, _RIG_M), METAL, 3)
    for side in (-1.0, 1.0):
        points = [
            _at(0.5, side * 1.4, 0.95),
            _at(mast, side * 0.75, 5.4),
            _at(mast, side * 0.75, 9.2),
            _at(mast, 0, top - 0.2),
        ]
        for a, b in pairwise(points):
            skin.tube(a, b, (_RIG_M, _RIG_M), METAL, 3)
    _rails(skin)
    boom = 2.05
    skin.tube(_at(mast, 0.0, boom), _at(-3.2, 0.0, boom + 0.05), (0.06, 0.06), METAL, 6)
    for y in (-1.0, 1.0):
        skin.site(SAIL, _at(-1.2, 0.3 * y, 2.3 if not running else 5.0), _at(0.0, y, 0.05), LUMP_STANDOFF_M)
    if running:
        _sails(skin, mast, boom, top)
    else:
        skin.tube(_at(mast - 0.1, 0.0, boom + 0.17), _at(-3.0, 0.0, boom + 0.16), (0.17, 0.1), SAIL, 8)


def _sails(skin: Skin, mast: float, boom: float, top: float) -> None:
    """Main and fore sail as bellied triangles, each seen from both sides."""
    main = (_at(mast - 0.1, 0, boom + 0.1), _at(-3.1, 0, boom + 0.15), _at(mast - 0.08, 0, top - 0.4))
    fore = (_at(4.45, 0, 1.4), _at(0.2, -0.9, 1.9), _at(mast + 0.15, 0, top - 1.0))
    steps = 6
    for tack, clew, head in (main, fore):
        s, t = np.meshgrid(np.linspace(0, 1, steps + 1), np.linspace(0, 1, steps + 1), indexing="ij")
        s, t = s[..., None], t[..., None]
        foot = tack + s * (clew - tack)
        points = foot + t * (tack + s * 0.06 * (clew - tack) + (head - tack) - foot)
        points = points - _at(0, 1.0, 0) * 1.6 * (s * (1 - s) * (1 - 0.6 * t) * np.minimum(4 * t, 1.0))
        faces = loft_faces(steps + 1, steps + 1, closed=False)
        flat = points.reshape(-1, 3)
        skin.add(flat, faces, SAIL)
        skin.add(flat + _at(0, 0.004, 0), faces[:, ::-1], SAIL)


def _rails(skin: Skin) -> None:
    """Guard rails at bow and stern."""
    for side in (-1.0, 1.0):
        line = [
            _at(-4.4, side * 0.85, 1.45),
            _at(-2.6, side * 1.25, 1.45),
            _at(0.5, side * 1.42, 1.5),
            _at(3.0, side * 0.85, 1.6),
            _at(4.6, 0.0, 1.75),
        ]
        for a, b in pairwise(line):
            skin.tube(a, b, (0.008, 0.008), METAL, 3)
        for p in line[:-1]:
            skin.tube(p - _at(0.0, 0.0, 0.6), p, (0.014, 0.014), METAL, 4)


def _motor(skin: Skin, running: bool) -> None:
    _cabin(skin, 0.6, 2.1, (0.8, 0.65), (0.82, 1.12), False)
    screen = np.array([[0.35, -0.95, 0.82], [1.0, -0.75, 0.86], [1.0, 0.75, 0.86], [0.35, 0.95, 0.82]])
    high = screen * [1.0, 0.9, 1.0] + np.array([-0.35, 0.0, 0.6])
    points = np.concatenate([screen, high])
    faces = np.array([[0, 1, 5], [0, 5, 4], [1, 2, 6], [1, 6, 5], [2, 3, 7], [2, 7, 6]])
    skin.site(GLASS, (0.85, 0.0, 1.2), (1.0, 0.0, 0.6))
    skin.site(GLASS, (0.8, 0.0, 1.2), (-1.0, 0.0, -0.3))
    skin.add(points, faces, GLASS)
    skin.add(points - np.array([0.012, 0.0, 0.0]), faces[:, ::-1], GLASS)
    skin.box((0.1, -0.8, 0.2), (0.5, 0.8, 0.88), DECK)
    for y in (-0.6, 0.18):
        skin.box((-0.75, y, 0.2), (-0.3, y + 0.42, 0.62), DECK)
        skin.box((-0.85, y, 0.2), (-0.75, y + 0.42, 1.1), DECK)
    skin.box((-2.75, -0.85, 0.2), (-2.25, 0.85, 0.62), DECK)
    _outboard(skin, -3.3)


def _outboard(skin: Skin, x: float) -> None:
    """An outboard engine: cowl above the transom, leg into the water."""
    for normal in (_at(0, 0, 1.0), _at(-1.0, 0, 0)):
        skin.site(ENGINE, _at(x, 0.0, 1.15) + 0.32 * normal, normal)
    skin.site(EXHAUST, _at(x - 0.15, 0.0, 0.4), _at(-1.0, 0.0, 0.0), 0.05)
    low = np.array([[x - 0.3, -0.2], [x + 0.25, -0.2], [x + 0.25, 0.2], [x - 0.3, 0.2]])
    rows = [
        np.column_stack([(low - [x, 0]) * f + [x, 0], np.full(4, z)])
        for f, z in ((0.8, 0.8), (1.0, 1.0), (0.95, 1.3), (0.55, 1.45))
    ]
    points = np.concatenate(rows)
    skin.add(points, np.concatenate([loft_faces(4, 4), fan_faces(4, 12)]), ENGINE)
    skin.box((x - 0.12, -0.08, -0.6), (x + 0.12, 0.08, 0.82), EXHAUST)


def _fishing(skin: Skin, running: bool) -> None:
    _cabin(skin, 1.1, 3.7, (1.25, 1.1), (1.35, 3.6), True)
    skin.box((-1.0, -0.8, 1.2), (0.7, 0.8, 1.75), ENGINE)
    skin.site(ENGINE, _at(-0.15, 0.0, 1.77), _at(0.0, 0.0, 1.0))
    skin.site(ENGINE, _at(-1.02, 0.0, 1.5), _at(-1.0, 0.0, 0.0))
    skin.site(EXHAUST, _at(1.0, 0.75, 3.0), _at(-1.0, 0.3, 0.2), LUMP_STANDOFF_M)
    skin.tube(_at(0.95, 0.7, 1.7), _at(0.95, 0.7, 4.3), (0.09, 0.09), EXHAUST, 8)
    skin.around(METAL, (0.8, 0.0, 4.0))
    skin.tube(_at(0.8, 0.0, 1.3), _at(0.8, 0.0, 6.2), (0.1, 0.06), METAL, 8)
    skin.tube(_at(0.8, 0.0, 2.6), _at(-3.6, 0.0, 4.4), (0.06, 0.05), METAL, 6)
    skin.tube(_at(-3.6, 0.0, 4.4), _at(0.8, 0.0, 6.1), (0.012, 0.012), METAL, 3)
    for side in (-1.0, 1.0):
        skin.tube(_at(-0.4, side * 1.75, 1.2), _at(0.8, 0.0, 6.1), (0.012, 0.012), METAL, 3)
        skin.tube(_at(-5.2, side * 1.35, 1.1), _at(-5.2, side * 1.35, 3.0), (0.06, 0.06), METAL, 6)
    skin.tube(_at(-5.2, -1.35, 3.0), _at(-5.2, 1.35, 3.0), (0.06, 0.06), METAL, 6)
    for y in (-1.0, 1.0):
        skin.site(SAIL, _at(-3.9, 0.0, 1.75) + 0.5 * _at(y, 0.0, 0.5), _at(y, 0.0, 0.5), LUMP_STANDOFF_M)
    skin.tube(_at(-3.9, -0.9, 1.6), _at(-3.9, 0.9, 1.6), (0.42, 0.42), SAIL, 10)
    skin.box((-2.6, -1.2, 1.15), (-1.6, 0.2, 1.5), DECK)
