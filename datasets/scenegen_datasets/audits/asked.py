"""Which recipe key asks for which fact of a clip."""

from __future__ import annotations

import datetime
from collections.abc import Callable, Mapping
from dataclasses import dataclass
from typing import Any, Literal

Facts = Mapping[str, Any]
Range = tuple[float, float]

_YEAR = 2021  # of all dates, see scenegen.climate.season
_ZERO_C = 273.15


@dataclass(frozen=True)
class Quantity:
    """Something the recipe decides and every clip records.

    Attributes
    ----------
    name, words, unit : str
    per : {"world", "clip"}
        How often it is drawn.
    key : str
        Of the recipe; dotted.
    fact : callable
        From the clip's line to the value.
    usual : (float, float) or None
        Where values lie if the recipe leaves it open; None: a climatology decides.
    even : bool
        Whether it is drawn evenly from its range.
    slack : (float, float)
        How far below and above the range values may lie.
    """

    name: str
    words: str
    unit: str
    per: Literal["world", "clip"]
    key: str
    fact: Callable[[Facts], float]
    usual: Range | None = None
    even: bool = True
    slack: Range = (0.0, 0.0)

    def known(self, clip: Facts) -> bool:
        """Whether a clip records it; datasets made elsewhere need not know every kind of weather."""
        try:
            self.fact(clip)
        except KeyError:
            return False
        return True


def _weather(name: str) -> Callable[[Facts], float]:
    return lambda clip: float(clip["weather"][name])


def _day_of_year(clip: Facts) -> float:
    return float(datetime.date(_YEAR, int(clip["month"]), int(clip["day"])).timetuple().tm_yday)


def _depression(clip: Facts) -> float:
    day = clip["weather"]
    return float(day["air_mean_K"]) - float(day["air_amplitude_K"]) - float(day["dew_point_K"])


QUANTITIES: tuple[Quantity, ...] = (
    Quantity("hour", "hour", "h", "clip", "climate.hour", lambda c: float(c["hour"]), (0.0, 24.0)),
    Quantity(
        "latitude_deg", "latitude", "deg", "world", "climate.latitude_deg", lambda c: float(c["latitude_deg"])
    ),
    Quantity("day_of_year", "day of the year", "d", "world", "climate.date", _day_of_year, (1.0, 365.0)),
    Quantity(
        "sun_elevation_deg",
        "elevation of the sun",
        "deg",
        "clip",
        "",
        lambda c: float(c["sun_elevation_deg"]),
        (-90.0, 90.0),
        even=False,
    ),
    Quantity(
        "air_mean_C",
        "mean air",
        "°C",
        "clip",
        "climate.air_mean_C",
        lambda c: float(c["weather"]["air_mean_K"]) - _ZERO_C,
    ),
    Quantity(
        "air_amplitude_K",
        "half the daily range",
        "K",
        "clip",
        "climate.air_amplitude_K",
        _weather("air_amplitude_K"),
    ),
    Quantity(
        "dew_point_depression_K",
        "dew point below the lowest air",
        "K",
        "clip",
        "climate.dew_point_depression_K",
        _depression,
    ),
    Quantity("wind_mps", "wind", "m/s", "clip", "climate.wind_mps", _weather("wind_mps")),
    Quantity("cloud_fraction", "cloud", "", "clip", "climate.cloud_fraction", _weather("cloud_fraction")),
    Quantity("visibility_km", "visibility", "km", "clip", "climate.visibility_km", _weather("visibility_km")),
    Quantity(
        "speed_mps",
        "mean speed",
        "m/s",
        "clip",
        "flight.speed_mps",
        lambda c: float(c["speed_mps"]),
        even=False,
        slack=(
            float("inf"),
            0.6,
        ),  # bends are flown more slowly than the cruise, slopes and gusts add a little
    ),
    Quantity(
        "clearance_m",
        "closest approach to anything",
        "m",
        "clip",
        "flight.clearance_m",
        lambda c: float(c["clearance_m"]),
        even=False,
        slack=(0.0, float("inf")),
    ),
)
"""In the order they are shown."""


def evenly_drawn(quantity: Quantity, recipe: Mapping[str, Any]) -> bool:
    """Whether a recipe promises even draws: what the test split keeps for itself is missing from the others."""
    held = recipe.get("splits") or {}
    uneven = {"hour"} if held.get("test_hours") else set()
    uneven |= {"wind_mps", "cloud_fraction"} if held.get("test_weather") else set()
    return quantity.even and quantity.name not in uneven


def asked_range(quantity: Quantity, recipe: Mapping[str, Any]) -> tuple[Range | None, bool]:
    """What the recipe asks for, and whether it says so itself; None where a climatology decides.

    Parameters
    ----------
    quantity : Quantity
    recipe : mapping
        The resolved recipe of ``recipe.lock.json``.
    """
    value: Any = recipe
    for part in quantity.key.split("."):
        value = value.get(part) if isinstance(value, Mapping) else None
    if value is None:
        return quantity.usual, False
    if isinstance(value, str):  # a date
        month, day = value.split("-")
        number = _day_of_year({"month": month, "day": day})
        return (number, number), True
    if isinstance(value, int | float):
        return (float(value), float(value)), True
    low, high = value
    return (float(low), float(high)), True
