"""Wheels: tyres with rims, and a site for all of a side."""

from __future__ import annotations

import numpy as np

from scenegen.geometry.part import LUMP_STANDOFF_M
from scenegen.parts.lofts import fan_faces, loft_faces
from scenegen.parts.skin import Skin
from scenegen.parts.vehicles.slots import TYRE, WHEEL

_RIM = 8
_CONTACT_M = 0.01
"""How far the flat of a loaded tyre lies in the ground."""


def wheels(
    skin: Skin, axles: tuple[float, ...], radius_m: float, outer_m: float, width_m: float = 0.21
) -> None:
    """Add two wheels per axle and the sites of both sides.

    Parameters
    ----------
    skin : Skin
    axles : tuple of float
        Positions along the vehicle [m].
    radius_m : float
    outer_m : float
        Distance of the outer sidewalls from the middle of the vehicle.
    width_m : float
        Of a tyre (of a pair of tyres on trucks).
    """
    turn = 2 * np.pi * (np.arange(_RIM) + 0.5) / _RIM
    circle = np.column_stack([np.cos(turn), np.zeros(_RIM), np.sin(turn)])
    # Profile over the tread and the outer sidewall to the rim: place across, radius.
    profile = ((-width_m, radius_m), (-0.02, radius_m), (0.0, 0.62 * radius_m))
    for side in (-1.0, 1.0):
        out = np.array([0.0, side, 0.0])
        middle = float(np.mean(axles))
        place = np.array([middle, side * (outer_m + 0.02), max(radius_m, LUMP_STANDOFF_M + 0.1)])
        skin.site(TYRE, place, out, LUMP_STANDOFF_M)
        skin.site(WHEEL, place, out, LUMP_STANDOFF_M)
    for x in axles:
        for side in (-1.0, 1.0):
            hub = np.array([x, side * outer_m, radius_m * np.cos(np.pi / _RIM) - _CONTACT_M])
            rings = np.array([hub + [0.0, side * y, 0.0] + r * circle for y, r in profile])
            points, tyre = rings.reshape(-1, 3), loft_faces(3, _RIM)
            disc = fan_faces(_RIM)
            face = rings[2] - [0.0, side * 0.01, 0.0]
            skin.add(points, tyre[:, ::-1] if side > 0 else tyre, TYRE)
            skin.add(face, disc[:, ::-1] if side > 0 else disc, WHEEL)
