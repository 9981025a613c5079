"""People as parts: drawn heights, phases of the step and outfits, one instance id each."""

from __future__ import annotations

import numpy as np
from jaxtyping import Float64

from scenegen.foundation.errors import InputError, nearest
from scenegen.geometry.part import Part
from scenegen.geometry.template import place
from scenegen.parts.people.body import body
from scenegen.parts.people.outfit import outfits
from scenegen.parts.people.posture import HEIGHT_M, POSTURES
from scenegen.parts.workshop import Workshop

_PHASES = 5


def stand(
    position: Float64[np.ndarray, "people 3"],
    heading_rad: Float64[np.ndarray, "people"],
    posture: str,
    shop: Workshop,
    rng: np.random.Generator,
    children: float = 0.12,
) -> list[Part]:
    """People in one posture.

    Parameters
    ----------
    position : float64 (people, 3)
        On the ground [m]; of sitting people the ground under the seat, which is 0.45 m high.
    heading_rad : float64 (people,)
        Where they look, counter-clockwise from east.
    posture : str
        "standing", "walking", "sitting" or "running".
    shop : Workshop
    rng : numpy.random.Generator
    children : float
        Share of children; none among the sitting, whose feet would not reach the ground.
    """
    if posture not in POSTURES:
        raise InputError(f"unknown posture '{posture}'{nearest(posture, POSTURES)}")
    count = len(position)
    if not count:
        return []
    owner = shop.builder.new_objects(count) + np.arange(count)
    child = rng.uniform(size=count) < (0.0 if posture == "sitting" else children)
    adult_m = np.clip(rng.normal(1.72, 0.08, count), 1.5, 1.95)
    height = np.where(child, rng.uniform(1.0, 1.45, count), adult_m)
    width = height / HEIGHT_M * rng.uniform(0.93, 1.12, count)
    if posture == "sitting":
        height = np.full(count, HEIGHT_M)  # everyone fits the seat
    scale = np.column_stack([width, width, height / HEIGHT_M])
    skins = outfits(count, shop, rng)
    phase = rng.integers(_PHASES, size=count)
    parts = []
    for k in range(_PHASES):
        for young in (False, True):
            mine = np.flatnonzero((phase == k) & (child == young))
            if len(mine):
                template = body(posture, k / _PHASES, young)
                parts.append(
                    place(template, position[mine], heading_rad[mine], scale[mine], skins[mine], owner[mine])
                )
    return parts
