"""Hulls: lofts from transom to stem, decked, open or half decked, floating at z = 0."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from jaxtyping import Float64

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
    floor_m : float
        Height of the inner bottom where the boat is open.
    decked : float
        Share of the length, from the stem, that has a deck: 1 a decked boat, 0 an open one.
    """

    length_m: float
    beam_m: float
    draught_m: float
    freeboard_m: tuple[float, float, float]
    transom: float
    rake_m: float
    floor_m: float = 0.0
    decked: float = 1.0


@dataclass(frozen=True, eq=False)
class _Lines:
    """The lines of a hull, one entry per station from the transom to the stem.

    Attributes
    ----------
    x, half, sheer, keel, rake : float64 (stations,)
        Place along the boat, half-beam at the edge, heights of edge and keel, and how far the keel lies behind the
        edge [m].
    """

    x: Float64[np.ndarray, "stations"]
    half: Float64[np.ndarray, "stations"]
    sheer: Float64[np.ndarray, "stations"]
    keel: Float64[np.ndarray, "stations"]
    rake: Float64[np.ndarray, "stations"]

    @staticmethod
    def of(shape: HullShape) -> _Lines:
        t = np.linspace(0.0, 1.0, _STATIONS)
        freeboard = np.interp(t, [0.0, 0.5, 1.0], shape.freeboard_m)
        fore = np.clip((1.0 - t) / 0.35, 0.0, 1.0) ** 0.6
        aft = 0.45 + 0.55 * np.sin(np.pi * np.clip(t + 0.2, 0.0, 0.5))
        return _Lines(
            x=(t - 0.5) * shape.length_m,
            half=shape.beam_m / 2 * _plan(t, shape.transom),
            sheer=freeboard - 0.06 * shape.freeboard_m[1] * np.sin(np.pi * t),
            keel=-shape.draught_m * fore * aft,
            rake=shape.rake_m * np.clip((t - 0.7) / 0.3, 0.0, 1.0) ** 2,
        )

    def row(self, across: np.ndarray, z: np.ndarray) -> np.ndarray:
        """Points at heights, drawn back with the stem's rake below the edge, (stations, 3)."""
        down = np.clip((self.sheer - z) / np.maximum(self.sheer - self.keel, 0.05), 0.0, 1.0)
        return np.column_stack([self.x - self.rake * down, across, z])


def hull(skin: Skin, shape: HullShape) -> None:
    """Add a hull and its sites."""
    lines = _Lines.of(shape)
    chine = 0.35 * lines.keel
    for side in (-1.0, 1.0):
        rows = [
            lines.row(0.0 * lines.half, lines.keel),
            lines.row(side * 0.78 * lines.half, chine),
            lines.row(side * lines.half, lines.sheer),
        ]
        faces = loft_faces(_STATIONS, 3, closed=False)
        skin.add(np.stack(rows, axis=1).reshape(-1, 3), faces if side > 0 else faces[:, ::-1], HULL)
    _stern(skin, lines)
    first = round((1.0 - shape.decked) * (_STATIONS - 1))
    if first < _STATIONS - 1:
        _deck(skin, lines, first)
    if first > 0:
        _inside(skin, lines, shape.floor_m, first)
    half, high, back = shape.beam_m / 2, 0.6 * shape.freeboard_m[1], -shape.length_m / 2
    for y in (-1.0, 1.0):
        skin.site(HULL, (0.0, y * half, high), (0.1, y, 0.0))
    skin.site(HULL, (back, 0.35 * shape.beam_m * shape.transom, high), (-1.0, 0.0, 0.0))
    level = shape.floor_m if first > 0 else shape.freeboard_m[1]
    skin.site(DECK, (-0.28 * shape.length_m, 0.0, level), (0.0, 0.0, 1.0), 0.1)


def _plan(t: np.ndarray, transom: float) -> np.ndarray:
    """Half-beam along the boat as a share of the largest: full at 0.4 of the length, pointed at the stem."""
    aft = transom + (1.0 - transom) * np.sin(0.5 * np.pi * np.clip(t / 0.42, 0.0, 1.0))
    fore = np.cos(0.5 * np.pi * np.clip((t - 0.42) / 0.58, 0.0, 1.0)) ** 0.75
    return np.asarray(np.where(t < 0.42, aft, np.maximum(fore, 0.015)))


def _stern(skin: Skin, lines: _Lines) -> None:
    x, half, chine = lines.x[0], lines.half[0], 0.35 * lines.keel[0]
    ring = [(0.0, lines.keel[0]), (0.78 * half, chine), (half, lines.sheer[0])]
    ring += [(-half, lines.sheer[0]), (-0.78 * half, chine)]
    points = np.array([[x, y, z] for y, z in ring])
    skin.add(points, np.array([[0, 2, 1], [0, 3, 2], [0, 4, 3]]), HULL)


def _deck(skin: Skin, lines: _Lines, first: int) -> None:
    """A slightly cambered deck from a station to the stem."""
    x, half, sheer = lines.x[first:], lines.half[first:], lines.sheer[first:]
    rows = [np.column_stack([x, y, z]) for y, z in ((-half, sheer), (0 * half, sheer + 0.03), (half, sheer))]
    skin.add(np.stack(rows, axis=1).reshape(-1, 3), loft_faces(len(x), 3, closed=False)[:, ::-1], DECK)


def _inside(skin: Skin, lines: _Lines, floor_m: float, last: int) -> None:
    """Gunwale, inner sides, bottom and both ends of the open part, from the transom to a station."""
    wall = np.minimum(0.06, 0.5 * lines.half)
    inner, low = lines.half - wall, np.minimum(0.72 * lines.half, lines.half - wall)
    rise = 0.35 * np.clip(lines.x / lines.x[-1], 0.0, 1.0) ** 3
    z = np.minimum(floor_m + rise, lines.sheer - 0.02)
    ring = [(-lines.half, lines.sheer), (-inner, lines.sheer), (-low, z)]
    ring += [(-y, h) for y, h in reversed(ring)]
    points = np.stack([lines.row(y, h) for y, h in ring], axis=1)[: last + 1]
    skin.add(points.reshape(-1, 3), loft_faces(len(points), 6, closed=False)[:, ::-1], DECK)
    lid = np.array([[0, 1, 2], [0, 2, 3]])
    skin.add(points[0, 1:5] + np.array([0.04, 0.0, 0.0]), lid[:, ::-1], DECK)
    if last < _STATIONS - 1:
        skin.add(points[-1, 1:5], lid, DECK)
