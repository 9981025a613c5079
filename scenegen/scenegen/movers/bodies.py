"""Vehicles and boats in their rest pose, taken from the shared parts: one body at the origin, facing +x."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from scenegen.geometry.part import Part, concatenate
from scenegen.parts.boats.moor import moor
from scenegen.parts.vehicles.park import park
from scenegen.parts.workshop import Workshop

_ORIGIN = np.zeros((1, 3))
_AHEAD = np.zeros(1)


def vehicles(kinds: Sequence[str], shop: Workshop, rng: np.random.Generator) -> list[Part]:
    """Driven vehicles of given kinds, in order: warm bonnets, tyres, exhausts."""
    level = np.zeros((1, 2))
    return [concatenate(park(kind, _ORIGIN, _AHEAD, level, shop, rng, driven=True)) for kind in kinds]


def boat(kind: str, running: bool, shop: Workshop, rng: np.random.Generator) -> Part:
    """A boat, its engine running or not; the origin lies on the water."""
    return concatenate(moor(kind, _ORIGIN, _AHEAD, shop, rng, running))
