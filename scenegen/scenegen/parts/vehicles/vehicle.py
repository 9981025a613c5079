"""Vehicles as templates: wheels on z = 0, facing +x."""

from __future__ import annotations

from functools import cache

import numpy as np

from scenegen.classes import Semantic
from scenegen.foundation.errors import InputError, nearest
from scenegen.geometry.template import Template
from scenegen.parts.skin import Skin
from scenegen.parts.vehicles.shapes import BUS, CARS, TRUCK_CAB, VAN, Shape
from scenegen.parts.vehicles.shell import shell
from scenegen.parts.vehicles.slots import CARGO, EXHAUST, PAINT, UNDERSIDE
from scenegen.parts.vehicles.wheels import wheels

KINDS = ("car", "van", "bus", "truck")

_TRUCK = (8.2, 2.5, 3.45)
"""Length, width, height [m]."""


def bodies(kind: str) -> tuple[str, ...]:
    """Names of the bodies of a kind."""
    return tuple(CARS) if kind == "car" else (kind,)


def size_m(kind: str) -> tuple[float, float, float]:
    """Length, width, height [m] that hold every body of a kind.

    Raises
    ------
    InputError
        If there is no such kind.
    """
    if kind not in KINDS:
        raise InputError(f"unknown vehicle '{kind}'{nearest(kind, KINDS)}")
    length, width, height = np.max([body_size_m(b) for b in bodies(kind)], axis=0).tolist()
    return length, width, height


def body_size_m(body: str) -> tuple[float, float, float]:
    """Length, width and height of one body [m], without mirrors."""
    if body == "truck":
        return _TRUCK
    shape = _shape(body)
    return shape.length_m, shape.width_m, shape.height_m


@cache
def vehicle(body: str) -> Template:
    """A vehicle of one body (a key of `CARS`, "van", "bus" or "truck"); slots are those of `slots`."""
    skin = Skin(Semantic.CAR if body in CARS else Semantic.LARGE_VEHICLE)
    if body == "truck":
        _truck(skin)
    else:
        shape = _shape(body)
        shell(skin, shape)
        wheels(skin, shape.axles, shape.wheel_m, shape.width_m / 2 - 0.005)
        _exhaust(
            skin, np.array([-shape.length_m / 2 + 0.05, -0.5 * shape.width_m + 0.4, shape.sill_m + 0.02])
        )
        if body in CARS or body == "van":
            _mirrors(skin, shape)
    return skin.finish()


def _shape(body: str) -> Shape:
    return CARS[body][0] if body in CARS else {"van": VAN, "bus": BUS}[body]


def _exhaust(skin: Skin, tip: np.ndarray, radius: float = 0.035) -> None:
    """The last hand's breadth of the pipe, pointing back."""
    skin.site(EXHAUST, tip - np.array([0.12, 0.0, 0.0]), np.array([-1.0, 0.0, 0.2]), 0.03)
    skin.tube(tip + np.array([0.15, 0.0, 0.0]), tip - np.array([0.1, 0.0, 0.0]), (radius, radius), EXHAUST, 5)


def _mirrors(skin: Skin, shape: Shape) -> None:
    """Wing mirrors at the feet of the front pillars."""
    x, y, z = shape.cabin[3] - 0.35, shape.width_m / 2 - 0.06, shape.belt_m + 0.06
    for side in (-1.0, 1.0):
        low, high = sorted((side * y, side * (y + 0.2)))
        skin.box((x, low, z), (x + 0.08, high, z + 0.13), PAINT, under=False)


def _truck(skin: Skin) -> None:
    """A rigid truck: cab, chassis, box body on three axles' worth of wheels."""
    length, width, height = _TRUCK
    shell(skin, TRUCK_CAB, length / 2 - TRUCK_CAB.length_m / 2)
    half, rear, front = width / 2, -length / 2, length / 2 - TRUCK_CAB.length_m - 0.15
    middle = 0.5 * (rear + front)
    for y in (-1.0, 1.0):
        skin.site(CARGO, np.array([middle, y * half, 2.2]), np.array([0.0, y, 0.0]))
    skin.site(CARGO, np.array([middle, 0.0, height]), np.array([0.0, 0.0, 1.0]))
    skin.site(CARGO, np.array([rear, 0.0, 2.2]), np.array([-1.0, 0.0, 0.0]))
    skin.site(CARGO, np.array([front, 0.0, 3.2]), np.array([1.0, 0.0, 0.0]))
    skin.box((rear, -half, 1.1), (front, half, height), CARGO)
    skin.box((rear + 0.1, -0.45, 0.75), (front - 2.2, 0.45, 1.1), PAINT)
    skin.box((front - 2.2, -0.45, 0.7), (front + 0.9, 0.45, 1.1), UNDERSIDE)
    for y in (-1.0, 1.0):
        low, high = sorted((y * 0.75, y * (half - 0.05)))
        skin.box((front - 1.7, low, 0.55), (front - 0.5, high, 1.05), PAINT)
    skin.box((rear + 0.05, -half + 0.1, 0.55), (rear + 0.15, half - 0.1, 0.68), PAINT)
    wheels(skin, (length / 2 - 0.9, rear + 1.7), 0.48, half - 0.03, 0.5)
    _exhaust(skin, np.array([front - 1.9, -half + 0.3, 0.62]), 0.06)
