"""Everything that makes a pitch a ground: stands, goals, flags, benches, floodlights, fences."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from scenegen.geometry.part import Part
from scenegen.maps.field.country import Country
from scenegen.maps.field.fences import build_fences
from scenegen.maps.field.furniture import build_furniture
from scenegen.maps.field.goals import build_benches, build_corner_flags, build_goals
from scenegen.maps.field.grounds import Grounds
from scenegen.maps.field.masts import build_flags, build_masts, build_power_line
from scenegen.maps.field.pylons import build_pylons
from scenegen.maps.field.stands import Seats, build_stand
from scenegen.maps.field.workshop import FieldWorkshop


@dataclass(frozen=True, eq=False)
class Equipment:
    """What was put up.

    Attributes
    ----------
    parts : tuple of Part
    seats : tuple of Seats
        Per stand.
    feet : float64 (posts, 2)
        Of masts and poles in the plan [m].
    """

    parts: tuple[Part, ...]
    seats: tuple[Seats, ...]
    feet: np.ndarray


def build_equipment(
    grounds: Grounds, country: Country, half_m: float, shop: FieldWorkshop, rng: np.random.Generator
) -> Equipment:
    """Put up the equipment of the grounds, the power lines and the fences."""
    sport, posts, fences, small = rng.spawn(4)
    parts: list[Part] = []
    seats = []
    for stand in grounds.stands:
        pieces, places = build_stand(stand, shop, sport)
        parts += pieces
        seats.append(places)
    for pitch in grounds.pitches:
        parts += [*build_goals(pitch, shop, sport), build_corner_flags(pitch, shop, sport)]
        parts += build_benches(pitch, pitch.main and grounds.track, shop, sport)
    masts, mast_feet = build_masts(grounds, shop, posts)
    line, pole_feet = build_power_line(country, half_m, shop, posts)
    parts += [*masts, *line, *build_flags(grounds, shop, posts)]
    if country.pylons is not None:
        parts += build_pylons(country.pylons, shop, posts)
    parts += build_fences(grounds, country, shop, fences)
    furniture, feet = build_furniture(grounds, shop, small)
    parts += furniture
    return Equipment(tuple(parts), tuple(seats), np.concatenate([mast_feet, pole_feet, feet]))
