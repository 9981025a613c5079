"""The climate's section of a recipe, and how season, weather and hour are drawn from it.

Every quantity draws from its own child generator, whether or not it is fixed by the recipe: fixing one never shifts
another.
"""

from __future__ import annotations

import calendar
import re
from typing import Annotated

import numpy as np
from pydantic import AfterValidator

from scenegen.climate.climatology import normals
from scenegen.climate.season import REFERENCE_YEAR, Season
from scenegen.climate.weather import Weather
from scenegen.foundation.section import Section, Span

_DATE = re.compile(r"(\d{1,2})-(\d{1,2})")


def _bounded(name: str, low: float, high: float, unit: str, *, open_end: bool = False) -> AfterValidator:
    """Check that a span lies inside physical bounds (`Span` has seen to its order)."""

    def check(value: tuple[float, float]) -> tuple[float, float]:
        if value[0] < low or value[1] > high or (open_end and value[1] >= high):
            upper = f"below {high:g}" if open_end else f"at most {high:g}"
            wrong = next(v for v in value if v < low or v > high or (open_end and v >= high))
            raise ValueError(f"{name} must be at least {low:g} and {upper}{unit}, got {wrong:g}")
        return value

    return AfterValidator(check)


def _check_date(value: str | None) -> str | None:
    if value is None:
        return None
    match = _DATE.fullmatch(value.strip())
    if match:
        month, day = int(match[1]), int(match[2])
        if 1 <= month <= 12 and 1 <= day <= calendar.monthrange(REFERENCE_YEAR, month)[1]:
            return f"{month:02d}-{day:02d}"
    raise ValueError(f"date must be MM-DD in an ordinary year, such as 07-15, got '{value}'")


Latitude = Annotated[Span, _bounded("latitude_deg", -90.0, 90.0, " deg")]
Hour = Annotated[Span, _bounded("hour", 0.0, 24.0, " h", open_end=True)]
Celsius = Annotated[Span, _bounded("air_mean_C", -60.0, 50.0, " C")]
Amplitude = Annotated[Span, _bounded("air_amplitude_K", 0.0, 20.0, " K")]
Depression = Annotated[Span, _bounded("dew_point_depression_K", 0.0, 40.0, " K")]
Wind = Annotated[Span, _bounded("wind_mps", 0.0, 30.0, " m/s")]
Cloud = Annotated[Span, _bounded("cloud_fraction", 0.0, 1.0, "")]
Turbidity = Annotated[Span, _bounded("linke_turbidity", 1.5, 10.0, "")]
Visibility = Annotated[Span, _bounded("visibility_km", 0.1, 300.0, " km")]
Date = Annotated[str, AfterValidator(_check_date)]


class ClimateKnobs(Section):
    """Where on Earth, when in the year, what weather. A single number fixes a quantity, a range draws from it.

    What is left open is drawn from a climatology of latitude and season: over all latitudes people live at, the whole
    year, the whole day.
    """

    latitude_deg: Latitude = (-60.0, 65.0)
    """Range of latitudes [deg], drawn per world (equal chance per degree)."""
    date: Date | None = None
    """Day of the year, MM-DD; drawn per world over the whole year if left open."""
    hour: Hour | None = None
    """Local mean solar time [h], 0 <= h < 24; drawn per clip over the whole day if left open."""
    air_mean_C: Celsius | None = None
    """Daily mean air temperature [C]."""
    air_amplitude_K: Amplitude | None = None
    """Half the daily range of the air temperature [K]."""
    air_peak_hour: Annotated[Span, _bounded("air_peak_hour", 12.0, 18.0, " h")] = (14.0, 16.0)
    """Hour of the highest air temperature [h]."""
    dew_point_depression_K: Depression | None = None
    """How far the dew point lies below the day's lowest air temperature [K]."""
    wind_mps: Wind | None = None
    """Wind at 10 m [m/s]."""
    cloud_fraction: Cloud | None = None
    """0 clear .. 1 overcast."""
    linke_turbidity: Turbidity | None = None
    """2 very clear, 3 clear, 5 hazy."""
    visibility_km: Visibility | None = None
    """Meteorological range [km]; follows the turbidity if left open."""
    sky_optical_depth_factor: Annotated[Span, _bounded("sky_optical_depth_factor", 0.5, 2.0, "")] = (
        0.85,
        1.15,
    )
    """Scatter of the in-band sky between days of equal humidity, a factor on its optical depth."""


def draw_season(knobs: ClimateKnobs, rng: np.random.Generator) -> Season:
    """Draw latitude and date of a world."""
    for_latitude, for_date = rng.spawn(2)
    latitude = _uniform(knobs.latitude_deg, for_latitude)
    drawn = int(for_date.integers(1, 366))
    if knobs.date is None:
        return Season.from_day_of_year(latitude, drawn)
    month, day = knobs.date.split("-")
    return Season(latitude, int(month), int(day))


def draw_weather_and_hour(
    knobs: ClimateKnobs, season: Season, rng: np.random.Generator
) -> tuple[Weather, float]:
    """Draw weather and hour of a clip.

    A whole day is drawn from the climatology first; what the recipe fixes then takes its place, and nothing else
    moves.
    """
    for_day, *own = rng.spawn(11)
    usual = normals(season).draw(for_day)
    drawn_hour = 24.0 * float(own[0].random())
    hour = _pick(knobs.hour, drawn_hour, own[1])
    mean_K = 273.15 + _pick(knobs.air_mean_C, usual.air_mean_C, own[2])
    amplitude = _pick(knobs.air_amplitude_K, usual.air_amplitude_K, own[3])
    depression = _pick(knobs.dew_point_depression_K, usual.dew_point_depression_K, own[4])
    weather = Weather(
        air_mean_K=mean_K,
        air_amplitude_K=amplitude,
        air_peak_hour=_uniform(knobs.air_peak_hour, own[5]),
        dew_point_K=mean_K - amplitude - depression,
        wind_mps=_pick(knobs.wind_mps, usual.wind_mps, own[6]),
        cloud_fraction=_pick(knobs.cloud_fraction, usual.cloud_fraction, own[7]),
        linke_turbidity=_pick(knobs.linke_turbidity, usual.linke_turbidity, own[8]),
        visibility_km=_pick(knobs.visibility_km, usual.visibility_km, own[9]),
        sky_optical_depth_factor=_uniform(knobs.sky_optical_depth_factor, for_day),
    )
    return weather, hour


def _pick(span: tuple[float, float] | None, usual: float, rng: np.random.Generator) -> float:
    return usual if span is None else _uniform(span, rng)


def _uniform(span: tuple[float, float], rng: np.random.Generator) -> float:
    """Draw from a closed range; always takes exactly one number from the generator."""
    return min(span[0] + (span[1] - span[0]) * float(rng.random()), span[1])
