"""How the rays of a world are laid out in launches: all rays of a small block of sites together.

Direction after direction of the whole world would stream the acceleration structure through the cache once per
direction. Rays of 256 neighbouring sites at a time stay in one corner of it: 1.3 times faster on a city, and then rays
in one common direction are no faster than rays in a different direction for each site.
"""

from __future__ import annotations

import math
from collections.abc import Iterator
from dataclasses import dataclass
from typing import Any

from scenegen_render import backend

_BLOCK = 256
_LAUNCH_RAYS = 2_000_000
"""Rays of one launch: well below a second, so that an interrupt is answered."""


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


def launches(places: int, rows: int) -> Iterator[Lanes]:
    """Cut `rows` rays of each of `places` sites into launches; every ray appears once.

    Nothing but the width of a launch depends on the numbers, so all launches of all worlds share their kernels.
    """
    mi, dr = backend.modules()
    rows_, places_ = dr.opaque(mi.UInt, rows), dr.opaque(mi.UInt, places)
    per_launch = max(1, _LAUNCH_RAYS // (rows * _BLOCK)) * _BLOCK
    for first in range(0, places, per_launch):
        blocks = math.ceil(min(per_launch, places - first) / _BLOCK)
        lane = dr.arange(mi.UInt, blocks * _BLOCK * rows)
        line, column = lane // _BLOCK, lane % _BLOCK
        block = line // rows_
        place = dr.opaque(mi.UInt, first) + block * _BLOCK + column
        yield Lanes(place, line - block * rows_, place < places_)
