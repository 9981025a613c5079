"""How the rays of a world are laid out in launches, so that a packet of them stays in one corner of the world.

Rays are traced sixteen at a time. The fastest packets found on a city (ns per ray, one core):

* hemisphere: all directions of one site, neighbours in angle next to each other - 196, against 250 for one direction of
  256 neighbouring sites, whose sets are turned against each other, and 340 for whatever comes first;
* sun: one sun position for 256 neighbouring sites - 92, against 104 for all sun positions of one site.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from enum import Enum
from typing import Any

from scenegen_render import backend

_BLOCK = 256
_LAUNCH_RAYS = 2_000_000
"""Rays of one launch: well below a second, so that an interrupt is answered."""


class Together(Enum):
    """Which rays stand next to each other."""

    ROWS_OF_A_PLACE = 1
    PLACES_OF_A_ROW = 2


@dataclass(frozen=True, eq=False)
class Lanes:
    """One launch.

    Attributes
    ----------
    place : mitsuba.UInt
        Place of the ray's site in the spatial order.
    row : mitsuba.UInt
        Which of the rays of that site it is.
    active : mitsuba.Bool
        False for lanes that fill up the last block.
    """

    place: Any
    row: Any
    active: Any


def launches(places: int, rows: int, together: Together) -> Iterator[Lanes]:
    """Cut `rows` rays of each of `places` sites into launches; every ray appears once.

    Nothing but the width of a launch depends on the numbers, so all launches of all worlds share their kernels.
    """
    mi, dr = backend.modules()
    rows_, places_ = dr.opaque(mi.UInt, rows), dr.opaque(mi.UInt, places)
    per_launch = max(1, _LAUNCH_RAYS // (rows * _BLOCK)) * _BLOCK
    for first in range(0, places, per_launch):
        count = -(-min(per_launch, places - first) // _BLOCK) * _BLOCK
        lane = dr.arange(mi.UInt, count * rows)
        if together is Together.ROWS_OF_A_PLACE:
            step = lane // rows_
            row = lane - step * rows_
        else:
            line, column = lane // _BLOCK, lane % _BLOCK
            block = line // rows_
            step, row = block * _BLOCK + column, line - block * rows_
        place = dr.opaque(mi.UInt, first) + step
        yield Lanes(place, row, place < places_)
