"""What sun, sky and surroundings offer every surface over one day that begins at the wanted hour."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from jaxtyping import Float64, Int64

from scenegen.climate.broadband import sky_irradiance
from scenegen.climate.season import Season
from scenegen.climate.sun import sunshine
from scenegen.climate.weather import Weather
from scenegen.heat.balance import SAMPLES, Air
from scenegen.radiometry.planck import STEFAN_BOLTZMANN

GROUND_ALBEDO = 0.2
"""Of ground that no ray of the exposure hit."""


@dataclass(frozen=True, eq=False)
class Day:
    """Fluxes of one periodic day; sample 0 is the wanted hour.

    Attributes
    ----------
    hour : float64 (samples,)
        Local mean solar time [h], 0..24.
    sun : float64 (samples, 3)
        Direction of the sun, ENU.
    direct_Wm2, diffuse_Wm2 : float64 (samples,)
        Direct normal and diffuse horizontal sunshine.
    sky_Wm2 : float64 (samples,)
        Long-wave irradiance of the open sky.
    ground_short_Wm2, ground_long_Wm2 : float64 (samples,)
        Reflected sunshine and long-wave radiation of ground at air temperature.
    air : Air
    """

    hour: Float64[np.ndarray, "samples"]
    sun: Float64[np.ndarray, "samples 3"]
    direct_Wm2: Float64[np.ndarray, "samples"]
    diffuse_Wm2: Float64[np.ndarray, "samples"]
    sky_Wm2: Float64[np.ndarray, "samples"]
    ground_short_Wm2: Float64[np.ndarray, "samples"]
    ground_long_Wm2: Float64[np.ndarray, "samples"]
    air: Air

    @staticmethod
    def of(season: Season, weather: Weather, hour: float, samples: int = SAMPLES) -> Day:
        """Day of a season and a weather, sampled evenly from `hour` on."""
        hours = (hour + 24.0 * np.arange(samples) / samples) % 24.0
        sun = sunshine(season, weather, hours)
        air_K = weather.air_K(hours)
        return Day(
            hour=hours,
            sun=sun.direction,
            direct_Wm2=sun.direct_Wm2,
            diffuse_Wm2=sun.diffuse_Wm2,
            sky_Wm2=sky_irradiance(air_K, weather.dew_point_K, weather.cloud_fraction),
            ground_short_Wm2=GROUND_ALBEDO * sun.global_Wm2,
            ground_long_Wm2=STEFAN_BOLTZMANN * air_K**4,
            air=Air(air_K, weather.wind_mps, weather.vapour_pressure_hPa),
        )

    def nearest(self, hour: Float64[np.ndarray, "times"]) -> Int64[np.ndarray, "samples"]:
        """For each sample the index of the nearest of some hours, around the clock."""
        apart = np.abs(self.hour[:, None] - hour[None, :])
        return np.asarray(np.argmin(np.minimum(apart, 24.0 - apart), axis=1))
