"""Vehicles as parts: drawn bodies and paints, one instance id each, tilted with the ground."""

from __future__ import annotations

import numpy as np
from jaxtyping import Float64

from scenegen.geometry.part import Part
from scenegen.geometry.template import place
from scenegen.parts.vehicles.shapes import CARS
from scenegen.parts.vehicles.skins import skins
from scenegen.parts.vehicles.vehicle import bodies, size_m, vehicle
from scenegen.parts.workshop import Workshop

__all__ = ["park", "size_m"]


def park(
    kind: str,
    position: Float64[np.ndarray, "vehicles 3"],
    heading_rad: Float64[np.ndarray, "vehicles"],
    slope: Float64[np.ndarray, "vehicles 2"],
    shop: Workshop,
    rng: np.random.Generator,
    driven: bool = False,
) -> list[Part]:
    """Vehicles of one kind.

    Parameters
    ----------
    kind : str
        "car", "van", "bus" or "truck".
    position : float64 (vehicles, 3)
        Ground under the middle [m].
    heading_rad : float64 (vehicles,)
        Where they point, counter-clockwise from east.
    slope : float64 (vehicles, 2)
        Rise of the ground per metre east and north.
    shop : Workshop
    rng : numpy.random.Generator
    driven : bool
        Whether bonnet, tyres, rims, exhaust and underside are warm from driving.
    """
    names, count = bodies(kind), len(position)
    size_m(kind)  # refuses an unknown kind, also where there is nothing to park
    if not count:
        return []
    owner = shop.builder.new_objects(count) + np.arange(count)
    shares = [CARS[n][1] for n in names] if kind == "car" else [1.0]
    body = rng.choice(len(names), count, p=shares)
    scale = np.repeat(rng.uniform(0.96, 1.03, count)[:, None], 3, axis=1)
    rows = skins(kind, count, driven, shop, rng)
    parts = []
    for k, name in enumerate(names):
        mine = np.flatnonzero(body == k)
        if len(mine):
            parts.append(
                place(
                    vehicle(name),
                    position[mine],
                    heading_rad[mine],
                    scale[mine],
                    rows[mine],
                    owner[mine],
                    slope[mine],
                )
            )
    return parts
