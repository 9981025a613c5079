"""Hulls: lofts from transom to stem, decked or open, floating at z = 0."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from scenegen.parts.boats.slots import DECK, HULL
from scenegen.parts.lofts import loft_faces
from scenegen.parts.skin import Skin

_STATIONS = 13


@dataclass(frozen=True)
class HullShape:
    """Proportions of a hull.

    Attributes
    ----------
    length_m, beam_m : float
    draught_m : float
        Depth of the hull below the water, without fins.
    freeboard_m : (float, float, float)
        Height of the edge at transom, middle and stem.
    transom : float
        Width of the stern as a share of the beam.
    rake_m : float
        How far the stem leans forwards over its foot.
    floor_m : float or None
        Height of the inner bottom of an open boat; None for a deck.
    """

    length_m: float
    beam_m: float
    draught_m: float
    freeboard_m: tuple[float, float, float]
    transom: float
    rake_m: float
    floor_m: float | None = None


def hull(skin: Skin, shape: HullShape) -> None:
    """Add a hull and its sites."""
    t = np.linspace(0.0, 1.0, _STATIONS)
    x = (t - 0.5) * shape.length_m
    half = shape.beam_m / 2 * _plan(t, shape.transom)
    sheer = np.interp(t, [0.0, 0.5, 1.0], shape.freeboard_m) - 0.06 * np.sin(np.pi * t) * shape.freeboard_m[1]
    keel = (
        -shape.draught_m
        * np.clip((1.0 - t) / 0.35, 0.0, 1.0) ** 0.6
        * (0.45 + 0.55 * np.sin(np.pi * np.clip(t + 0.2, 0, 0.5)))
    )
    rake = shape.rake_m * np.clip((t - 0.7) / 0.3, 0.0, 1.0) ** 2
    chine_y, chine_z = 0.78 * half, 0.35 * keel
    _sites(skin, shape)
    rows = [(0.0 * half, keel, -rake), (chine_y, chine_z, -0.55 * rake), (half, sheer, 0.0 * rake)]
    for side in (-1.0, 1.0):
        points = np.stack([np.column_stack([x + dx, side * y, z]) for y, z, dx in rows], axis=1)
        faces = loft_faces(_STATIONS, 3, closed=False)
        skin.add(points.reshape(-1, 3), faces if side < 0 else faces[:, ::-1], HULL)
    _stern(skin, x[0], half[0], sheer[0], chine_y[0], chine_z[0], keel[0])
    if shape.floor_m is None:
        _deck(skin, x, half, sheer)
    else:
        _inside(skin, x, half, sheer, shape.floor_m)


def _plan(t: np.ndarray, transom: float) -> np.ndarray:
    """Half-beam along the boat as a share of the largest: full at 0.4 of the length, pointed at the stem."""
    aft = transom + (1.0 - transom) * np.sin(0.5 * np.pi * np.clip(t / 0.42, 0.0, 1.0))
    fore = np.cos(0.5 * np.pi * np.clip((t - 0.42) / 0.58, 0.0, 1.0)) ** 0.75
    return np.asarray(np.where(t < 0.42, aft, np.maximum(fore, 0.015)))


def _stern(
    skin: Skin, x: float, half: float, sheer: float, chine_y: float, chine_z: float, keel: float
) -> None:
    ring = [(0.0, keel), (chine_y, chine_z), (half, sheer), (-half, sheer), (-chine_y, chine_z)]
    points = np.array([[x, y, z] for y, z in ring])
    skin.add(points, np.array([[0, 2, 1], [0, 3, 2], [0, 4, 3]]), HULL)


def _deck(skin: Skin, x: np.ndarray, half: np.ndarray, sheer: np.ndarray) -> None:
    """A cambered deck a hand below the edge."""
    rows = [np.column_stack([x, -half, sheer]), np.column_stack([x, 0 * half, sheer + 0.03])]
    rows.append(np.column_stack([x, half, sheer]))
    faces = loft_faces(len(x), 3, closed=False)
    skin.add(np.stack(rows, axis=1).reshape(-1, 3), faces, DECK)


def _inside(skin: Skin, x: np.ndarray, half: np.ndarray, sheer: np.ndarray, floor: float) -> None:
    """Gunwale, inner sides and bottom of an open boat."""
    wall = np.minimum(0.06, 0.5 * half)
    inner, low = half - wall, np.minimum(0.72 * half, half - wall)
    z = np.minimum(floor + 0.35 * np.clip(x / x[-1], 0, 1) ** 3, sheer - 0.02)
    ring = [(-half, sheer), (-inner, sheer), (-low, z), (low, z), (inner, sheer), (half, sheer)]
    points = np.stack([np.column_stack([x, y, h]) for y, h in ring], axis=1)
    skin.add(points.reshape(-1, 3), loft_faces(len(x), len(ring), closed=False), DECK)
    back = np.array([[x[0] + 0.04, y[0], h[0]] for y, h in ring[1:5]])
    skin.add(back, np.array([[0, 1, 2], [0, 2, 3]]), DECK)


def _sites(skin: Skin, shape: HullShape) -> None:
    half, high = shape.beam_m / 2, 0.6 * shape.freeboard_m[1]
    for y in (-1.0, 1.0):
        skin.site(HULL, np.array([0.0, y * (half + 0.03), high]), np.array([0.1, y, 0.0]), 0.03)
    skin.site(HULL, np.array([-shape.length_m / 2 - 0.03, 0.0, high]), np.array([-1.0, 0.0, 0.0]))
    skin.site(DECK, np.array([0.0, 0.0, shape.freeboard_m[1] + 0.12]), np.array([0.0, 0.0, 1.0]), 0.1)
