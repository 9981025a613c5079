"""How much of their foliage deciduous plants carry, by latitude and day of the year.

Reference: Chmielewski, Roetzer 2001, "Response of tree phenology to climate change across Europe", Agricultural and
Forest Meteorology 108: averaged over the International Phenological Gardens (their middle lies near 50 N), leaves
unfold around 23 April and fall around 28 October. Northwards spring comes later and autumn earlier; the slopes here
are chosen so that green-up starts in late March at 38 N and leaves are gone from 70 N by early October, as satellites
see it (Zhang et al. 2002, IGARSS, doi:10.1109/IGARSS.2002.1025804). Hopkins's "law" (4 days a degree) is steeper: it
holds for the continental climate of North America.
"""

from __future__ import annotations

import numpy as np

from scenegen.climate.season import Season

UNFOLDING_DAY, FALL_DAY = 113.0, 301.0
"""Days of the year at 50 N on which buds open, and on which half of the leaves have fallen."""
REFERENCE_LATITUDE_DEG = 50.0
SPRING_DAYS_PER_DEG, AUTUMN_DAYS_PER_DEG = 2.5, 2.0
"""Days by which spring is later, and autumn earlier, a degree of latitude polewards."""
UNFOLDING_DAYS, FALL_DAYS = 24.0, 36.0
"""From the first open bud to full leaf, and from the first to the last fallen leaf [d]."""
TROPIC_DEG, FROST_DEG = 23.4, 31.0
"""Nothing sheds its leaves for winter below the first latitude; everything deciduous does above the second."""
_YEAR_DAYS = 365.0


def leaf_fraction(season: Season, shift_d: float = 0.0) -> float:
    """Share of its full foliage that a deciduous plant carries, 0..1.

    Parameters
    ----------
    season : Season
        South of the equator the year is turned by half.
    shift_d : float
        Days by which the species is early (negative) in spring and late in autumn; oaks come out late, birches early.
    """
    latitude = abs(season.latitude_deg)
    polewards = latitude - REFERENCE_LATITUDE_DEG
    day = season.day_of_year + (0.5 * _YEAR_DAYS if season.latitude_deg < 0.0 else 0.0)
    unfolding = UNFOLDING_DAY + shift_d + SPRING_DAYS_PER_DEG * polewards
    fall = FALL_DAY - AUTUMN_DAYS_PER_DEG * polewards - 0.5 * FALL_DAYS
    season_length = max(fall - unfolding, 0.0)
    since = (day - unfolding) % _YEAR_DAYS
    grown = _smooth(since / UNFOLDING_DAYS)
    shed = _smooth((since - season_length) / FALL_DAYS)
    mild = float(np.clip((FROST_DEG - latitude) / (FROST_DEG - TROPIC_DEG), 0.0, 1.0))
    return max(grown * (1.0 - shed), mild)


def _smooth(t: float) -> float:
    """Cubic step from 0 to 1 over 0..1."""
    t = float(np.clip(t, 0.0, 1.0))
    return t * t * (3.0 - 2.0 * t)
