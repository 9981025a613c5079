"""A place and a day of the year, drawn once per world because sun visibility depends on both."""

from __future__ import annotations

from dataclasses import dataclass


@dataclass(frozen=True)
class Season:
    """Latitude and date. Longitude is 0: hours are local mean solar time.

    Attributes
    ----------
    latitude_deg : float
        North positive.
    month, day : int
        Of the reference year 2021 (no leap day).
    """

    latitude_deg: float
    month: int
    day: int
