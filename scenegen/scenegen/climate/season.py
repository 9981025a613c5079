"""A place and a day of the year, drawn once per world because sun visibility depends on both."""

from __future__ import annotations

import datetime
from dataclasses import dataclass

REFERENCE_YEAR = 2021
"""All dates belong to this year: an ordinary one, without a leap day."""


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

    @property
    def day_of_year(self) -> int:
        """1 on 1 January .. 365."""
        return self._date.timetuple().tm_yday

    @property
    def midnight_unix_s(self) -> float:
        """Start of the day [s since 1970 UTC]; longitude 0, so local mean solar time is UTC."""
        moment = datetime.datetime.combine(self._date, datetime.time(), tzinfo=datetime.UTC)
        return moment.timestamp()

    @property
    def _date(self) -> datetime.date:
        return datetime.date(REFERENCE_YEAR, self.month, self.day)

    @staticmethod
    def from_day_of_year(latitude_deg: float, day_of_year: int) -> Season:
        """Season of the n-th day (1..365) of the reference year."""
        date = datetime.date(REFERENCE_YEAR, 1, 1) + datetime.timedelta(days=day_of_year - 1)
        return Season(latitude_deg, date.month, date.day)
