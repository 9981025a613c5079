"""Vehicles as parts: drawn bodies and paints, one instance id each, tilted with the ground."""

from __future__ import annotations

import numpy as np
from jaxtyping import Float64

from scenegen.geometry.part import Part
from scenegen.geometry.template import place
from scenegen.parts.vehicles.fleet import Fleet
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
    fleet: Fleet | None = None,
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
    fleet : Fleet, optional
        Bodies drawn beforehand; drawn here otherwise.
    """
    count = len(position)
    fleet = Fleet.draw(kind, count, rng) if fleet is None else fleet
    assert fleet.kind == kind and len(fleet.body) == count
    if not count:
        return []
    owner = shop.builder.new_objects(count) + np.arange(count)
    rows = skins(kind, count, driven, shop, rng)
    scale = np.repeat(fleet.scale[:, None], 3, axis=1)
    parts = []
    for k, name in enumerate(bodies(kind)):
        of = np.flatnonzero(fleet.body == k)
        if len(of):
            turned = position[of], heading_rad[of], scale[of], rows[of], owner[of], slope[of]
            parts.append(place(vehicle(name), *turned))
    return parts
