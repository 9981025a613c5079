"""Rest poses of whatever moves, taken from the shared parts: one body at the origin, facing +x."""

from __future__ import annotations

import numpy as np

from scenegen.geometry.cars import BODIES, car
from scenegen.geometry.part import Part
from scenegen.geometry.template import place
from scenegen.parts.workshop import Workshop

_PAINTS = ("car_paint_black", "car_paint_white", "car_paint_silver", "car_paint_silver")


def vehicle(kind: str, shop: Workshop, rng: np.random.Generator) -> Part:
    """A driven vehicle: warm bonnet, tyres, exhaust."""
    paint = shop.palette.pick(_PAINTS[int(rng.integers(4))], rng)
    skins = np.array([[paint, shop.palette.pick("window_glass", rng), shop.palette.only("tyre_rubber")]])
    body = "van" if kind == "van" else BODIES[int(rng.integers(3))]
    zero = np.zeros((1, 3))
    owner = np.array([shop.builder.new_objects()])
    return place(car(body), zero, zero[:, 0], np.full((1, 3), rng.uniform(0.95, 1.05)), skins, owner)
