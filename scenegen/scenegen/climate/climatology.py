"""What weather to expect at a latitude and a time of the year: smooth normals and their day-to-day spread.

Sea-level, continental-to-maritime average over longitudes, after the zonal means of Peixoto and Oort 1992 (Physics
of Climate, chapter 7) and the shape of daily extremes in station records. Plausible variety, not a forecast: there is
no rain and no snow cover in this project.
"""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np

from scenegen.climate.season import Season

_LATITUDES = (0.0, 15.0, 30.0, 40.0, 50.0, 60.0, 70.0, 80.0, 90.0)
_YEAR_MEAN_C = (26.5, 26.0, 20.5, 14.5, 8.5, 1.5, -8.5, -16.0, -20.0)
_HALF_SEASON_K = (0.8, 2.8, 7.5, 11.0, 13.0, 15.0, 16.0, 15.0, 14.0)
_DAILY_HALF_RANGE_K = (4.5, 6.0, 7.0, 6.0, 5.5, 5.0, 4.0, 3.0, 2.5)
_SOUTH_SEASON_SHARE = 0.6
"""Seasons are milder in the southern, oceanic hemisphere."""
_WARMEST_DAY = 201
"""About a month after the solstice, in the north."""
_CLOUD_DAMPING = 0.65
"""Share of the daily range that an overcast sky takes away."""


@dataclass(frozen=True)
class UsualDay:
    """One drawn day: what the weather is where a recipe leaves it open.

    Attributes
    ----------
    air_mean_C, air_amplitude_K, dew_point_depression_K : float
        The depression is below the day's lowest air temperature.
    wind_mps, cloud_fraction, linke_turbidity, visibility_km : float
    """

    air_mean_C: float
    air_amplitude_K: float
    dew_point_depression_K: float
    wind_mps: float
    cloud_fraction: float
    linke_turbidity: float
    visibility_km: float


@dataclass(frozen=True)
class Normals:
    """Expected weather of a season.

    Attributes
    ----------
    expected_C : float
        Daily mean air temperature.
    spread_K : float
        Its standard deviation from day to day.
    half_range_K : float
        Half the daily range under a clear sky.
    """

    expected_C: float
    spread_K: float
    half_range_K: float

    def draw(self, rng: np.random.Generator) -> UsualDay:
        """Draw a day. Cloudy days have a small range and moist air, warm air and hazy days a short view."""
        for_cloud, for_mean, for_amplitude, for_dew, for_wind, for_turbidity, for_view = rng.spawn(7)
        cloud = _cloud_fraction(for_cloud)
        amplitude = self.half_range_K * for_amplitude.uniform(0.7, 1.35) * (1.0 - _CLOUD_DAMPING * cloud)
        dryness_K = 4.0 * (1.0 - 0.7 * cloud)
        haze = (2.3 + 0.05 * max(self.expected_C + 5.0, 0.0)) * for_turbidity.uniform(0.8, 1.4)
        turbidity = float(np.clip(haze, 1.8, 6.5))
        return UsualDay(
            air_mean_C=self.expected_C
            + self.spread_K * float(np.clip(for_mean.standard_normal(), -2.2, 2.2)),
            air_amplitude_K=float(amplitude),
            dew_point_depression_K=float(np.clip(dryness_K * for_dew.standard_exponential(), 0.0, 20.0)),
            wind_mps=float(np.clip(3.95 * for_wind.weibull(2.0), 1.0, 12.0)),  # mean 3.5 m/s
            cloud_fraction=cloud,
            linke_turbidity=turbidity,
            visibility_km=float(np.clip(280.0 / turbidity**2 * for_view.uniform(0.7, 1.5), 5.0, 80.0)),
        )


def _cloud_fraction(rng: np.random.Generator) -> float:
    """U-shaped, as skies are: a third of the days clear, a fifth overcast."""
    kind, share = float(rng.random()), float(rng.random())
    if kind < 0.35:
        return 0.0
    return share if kind < 0.8 else 1.0


def normals(season: Season) -> Normals:
    """Expected weather at a latitude and date."""
    latitude = abs(season.latitude_deg)
    north = season.latitude_deg >= 0.0
    swing = float(np.interp(latitude, _LATITUDES, _HALF_SEASON_K)) * (1.0 if north else _SOUTH_SEASON_SHARE)
    phase = 2.0 * math.pi * (season.day_of_year - _WARMEST_DAY) / 365.0
    summer = math.cos(phase) if north else -math.cos(phase)
    expected = float(np.interp(latitude, _LATITUDES, _YEAR_MEAN_C)) + swing * summer
    return Normals(
        expected_C=expected,
        spread_K=(1.7 + 0.055 * latitude) * (1.0 - 0.25 * summer),  # winters are more changeable
        half_range_K=float(np.interp(latitude, _LATITUDES, _DAILY_HALF_RANGE_K)) * (1.0 + 0.2 * summer),
    )
