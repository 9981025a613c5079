"""How warm the sea is at its surface: a smooth climatology over latitude and the day of the year."""

from __future__ import annotations

import math

import numpy as np

from scenegen.climate.season import Season

FREEZING_K = 271.35
"""Freezing point of sea water of salinity 33 [K]: -1.8 degrees Celsius."""

SKIN_K = -0.2
"""The radiating skin against the water below [K], by night (Donlon et al. 2002: -0.17 K in wind above 6 m/s)."""

_LATITUDES = (0.0, 10.0, 20.0, 30.0, 40.0, 50.0, 60.0, 70.0, 80.0, 90.0)
_YEAR_MEAN_C = (27.3, 27.5, 25.5, 21.5, 16.0, 10.0, 6.0, 1.5, -1.2, -1.6)
_HALF_SEASON_K = (0.6, 0.9, 2.2, 4.0, 5.2, 4.6, 3.2, 2.2, 0.6, 0.2)
_SOUTH_SEASON_SHARE = 0.65
_WARMEST_DAY = 237
"""25 August: the sea lags the solstice by about nine weeks."""


def sea_surface_K(season: Season) -> float:
    """Expected temperature [K] of the sea's skin at a coast.

    Zonal means and seasons of coastal water read off the World Ocean Atlas (Locarnini et al. 2018, NOAA Atlas NESDIS
    81) to about a kelvin; oceans, currents and upwelling differ from it by several. Never below freezing.
    """
    latitude, north = abs(season.latitude_deg), season.latitude_deg >= 0.0
    swing = float(np.interp(latitude, _LATITUDES, _HALF_SEASON_K)) * (1.0 if north else _SOUTH_SEASON_SHARE)
    phase = 2.0 * math.pi * (season.day_of_year - _WARMEST_DAY) / 365.0
    summer = math.cos(phase) if north else -math.cos(phase)
    mean_K = 273.15 + float(np.interp(latitude, _LATITUDES, _YEAR_MEAN_C))
    return max(mean_K + swing * summer, FREEZING_K) + SKIN_K
