"""The body of a vehicle: one loft from tail to nose with wheel arches, windows, bonnet and roof."""

from __future__ import annotations

from itertools import pairwise

import numpy as np

from scenegen.parts.lofts import loft_faces
from scenegen.parts.skin import Skin
from scenegen.parts.vehicles.shapes import Shape
from scenegen.parts.vehicles.slots import BONNET, GLASS, PAINT, UNDERSIDE

_HALF = 3
"""Points of half a ring: sill, belt, edge of the roof. A crease between the first two would not show in the heat."""
_RING = 2 * _HALF
_ARCH_GAP_M = 0.06
_LEAST_STEP_M = 0.09
"""Stations inside an arch that stand nearer than this to another are left out."""
_ARCH_ANGLES = np.deg2rad([32.0, 90.0, 148.0])


def shell(skin: Skin, shape: Shape, shift_m: float = 0.0) -> None:
    """Add the body of a shape and its sites, moved forwards by `shift_m`."""
    x = _stations(shape)
    rings = _rings(shape, x)
    rings[..., 0] += shift_m
    _sites(skin, shape, shift_m)
    faces = loft_faces(len(x), _RING, closed=False)[:, ::-1]  # rings turn clockwise seen from the nose
    cell = np.arange(_RING - 1)
    half = np.minimum(cell, _RING - 2 - cell)
    middle = 0.5 * (x[1:] + x[:-1])
    slot = np.array([[_slot(shape, m, k) for k in half.tolist()] for m in middle.tolist()])
    skin.add(rings.reshape(-1, 3), faces, np.repeat(slot.ravel(), 2))
    _end(skin, rings[-1], front=True)
    _end(skin, rings[0], front=False)
    _tray(skin, shape, shift_m)


def _stations(shape: Shape) -> np.ndarray:
    """Where rings stand: ends, cabin, pillars, arches."""
    half, reach = shape.length_m / 2, shape.wheel_m + _ARCH_GAP_M
    pillars = [p + side for p in shape.pillars for side in (-0.05, 0.05)]
    arches = [axle + side * 1.02 * reach for axle in shape.axles for side in (-1.0, 1.0)]
    fixed = np.array([-half, -half + 0.1, half - 0.12, half, *shape.cabin, *shape.glazed, *pillars, *arches])
    inner = np.concatenate([axle - reach * np.cos(_ARCH_ANGLES) for axle in shape.axles])
    apart = np.abs(inner[:, None] - fixed).min(axis=1) > _LEAST_STEP_M
    x = np.unique(np.round(np.concatenate([fixed, inner[apart]]), 4))
    x = x[(x >= -half) & (x <= half)]
    return np.asarray(x[np.append(np.diff(x) > 0.012, True)])


def _rings(shape: Shape, x: np.ndarray) -> np.ndarray:
    """Points of all rings from the right sill over the top to the left sill, (stations, ring, 3)."""
    half = shape.length_m / 2
    foot, back, front, screen = shape.cabin
    belt_x = [-half, -half + 0.1, min(foot, -half + 0.35), screen, half - 0.12, half]
    belt_z = [shape.tail_m - 0.08, shape.tail_m, max(shape.tail_m, shape.belt_m), shape.belt_m + 0.02]
    belt = np.interp(x, belt_x, [*belt_z, shape.nose_m, shape.nose_m - 0.12])
    top = np.interp(x, [foot, back, front, screen], [0.0, 1.0, 1.0, 0.0])
    top = np.where((x > foot) & (x < screen), top, 0.0)
    roof = belt + 0.02 + top * (shape.height_m - 0.04 - belt)
    bottom = _bottom(shape, x)
    taper = np.clip((np.abs(x) - half + 0.75) / 0.75, 0.0, 1.0) ** 2
    wide = shape.width_m / 2 - shape.rounding_m * taper
    edge = np.where(top > 0, wide - 0.03 - shape.tuck_m * top, wide - 0.16 * wide)
    y = np.stack([wide, wide - 0.03, np.minimum(edge, wide - 0.04)], axis=1)
    z = np.stack([bottom, belt, roof + 0.02], axis=1)
    right = np.stack([np.repeat(x[:, None], _HALF, axis=1), -y, z], axis=2)
    left = right[:, ::-1] * np.array([1.0, -1.0, 1.0])
    return np.concatenate([right, left], axis=1)


def _bottom(shape: Shape, x: np.ndarray) -> np.ndarray:
    """Lower edge: the sill, raised over the wheels and a little at both ends."""
    half = shape.length_m / 2
    low = shape.sill_m + 0.08 * np.clip((np.abs(x) - half + 0.3) / 0.3, 0.0, 1.0)
    reach = shape.wheel_m + _ARCH_GAP_M
    for axle in shape.axles:
        over = shape.wheel_m + np.sqrt(np.maximum(reach**2 - (x - axle) ** 2, 0.0))
        low = np.where(np.abs(x - axle) < reach, np.maximum(low, over), low)
    return np.asarray(low)


def _slot(shape: Shape, x: float, band: int) -> int:
    """Slot of a cell by its place along the vehicle and its band: side, window, top."""
    foot, back, front, screen = shape.cabin
    if band == 0:
        return PAINT
    if band == 1:
        pillar = any(abs(x - p) < 0.051 for p in shape.pillars)
        return GLASS if shape.glazed[0] < x < shape.glazed[1] and not pillar else PAINT
    if x > screen:
        return BONNET
    if x > front:
        return GLASS
    return GLASS if foot < x < back and shape.rear_screen else PAINT


def _end(skin: Skin, ring: np.ndarray, front: bool) -> None:
    """Close nose or tail by quads from side to side, with lamps; the nose has a grille between them."""
    right, left = ring[:_HALF], ring[: _HALF - 1 : -1]
    waist = np.array([0.5, 0.5])
    right = np.concatenate([right[:1], [waist @ right[:2]], right[1:]])
    left = np.concatenate([left[:1], [waist @ left[:2]], left[1:]])
    for k in range(_HALF):
        low, high = (right[k], left[k]), (right[k + 1], left[k + 1])
        cuts = (0.0, 0.2, 0.8, 1.0) if k == 1 else (0.0, 1.0)
        for a, b in pairwise(cuts):
            corners = [low[0] + f * (low[1] - low[0]) for f in (a, b)]
            corners += [high[0] + f * (high[1] - high[0]) for f in (b, a)]
            slot = PAINT if k != 1 or (a == 0.2 and not front) else UNDERSIDE if a == 0.2 else GLASS
            faces = np.array([[0, 1, 2], [0, 2, 3]])
            skin.add(np.array(corners), faces if front else faces[:, ::-1], slot)


def _tray(skin: Skin, shape: Shape, shift_m: float) -> None:
    """The undertray, between the wheels and a hand above the sill, and its sides: nobody looks through the arches."""
    half, wide = shape.length_m / 2 - 0.05, shape.width_m / 2
    y, low, high = wide - 0.3, shape.sill_m, shape.wheel_m * 2 + 0.1
    x0, x1 = -half + shift_m, half + shift_m
    floor = np.array([[x0, y, low], [x1, y, low], [x1, -y, low], [x0, -y, low]])
    skin.add(floor, np.array([[0, 1, 2], [0, 2, 3]]), UNDERSIDE)
    for side in (-1.0, 1.0):
        wall = np.array(
            [[x0, side * y, low], [x1, side * y, low], [x1, side * y, high], [x0, side * y, high]]
        )
        faces = np.array([[0, 1, 2], [0, 2, 3]])
        skin.add(wall, faces if side < 0 else faces[:, ::-1], UNDERSIDE)
        rim = np.array(
            [
                [x0, side * y, low],
                [x1, side * y, low],
                [x1, side * (wide - 0.03), low],
                [x0, side * (wide - 0.03), low],
            ]
        )
        del rim


def _widest_pane(shape: Shape) -> float:
    """Middle of the longest side window."""
    ends = sorted([*shape.glazed, *shape.pillars])
    return max((b - a, 0.5 * (a + b)) for a, b in pairwise(ends))[1]


def _sites(skin: Skin, shape: Shape, shift_m: float) -> None:
    """Where the heat of the body lives."""
    half, wide = shape.length_m / 2, shape.width_m / 2
    foot, back, front, screen = shape.cabin
    mid, rise = 0.5 * (shape.belt_m + shape.height_m), shape.height_m - shape.belt_m
    window = _widest_pane(shape)
    rows = [
        (PAINT, (0.5 * (back + front), 0.0, shape.height_m + 0.005), (0.0, 0.0, 1.0)),
        (PAINT, (half + 0.005, 0.0, 0.45 * shape.nose_m), (1.0, 0.0, 0.0)),
        (PAINT, (-half - 0.005, 0.0, 0.6 * shape.tail_m), (-1.0, 0.0, 0.0)),
        (GLASS, (0.5 * (front + screen), 0.0, mid + 0.04), (rise, 0.0, screen - front)),
        (GLASS, (0.5 * (foot + back), 0.0, mid + 0.04), (-rise, 0.0, back - foot)),
        (BONNET, (0.5 * (screen + half), 0.0, 0.5 * (shape.belt_m + shape.nose_m) + 0.05), (0.15, 0.0, 1.0)),
        (UNDERSIDE, (0.0, 0.0, shape.sill_m - 0.005), (0.0, 0.0, -1.0)),
        (UNDERSIDE, (half + 0.01, 0.0, 0.7 * shape.nose_m), (1.0, 0.0, 0.0)),
    ]
    for y in (-1.0, 1.0):
        rows.append((PAINT, (0.0, y * wide, 0.62 * shape.belt_m), (0.0, y, 0.0)))
        rows.append((GLASS, (window, y * (wide - 0.04 - shape.tuck_m / 2), mid), (0.0, y, 0.25)))
    for slot, place, normal in rows:
        skin.site(slot, np.array(place) + np.array([shift_m, 0.0, 0.0]), np.array(normal))
