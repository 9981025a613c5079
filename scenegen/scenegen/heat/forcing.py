"""What sun, sky and surroundings offer every surface over one day that begins at the wanted hour."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from jaxtyping import Float64

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

    def spread(self, sun_hour: Float64[np.ndarray, "times"]) -> Float64[np.ndarray, "samples times"]:
        """Share of each sample's interval that lies nearest to each of the exposure's sun times.

        Sun visibility is constant half a step around each sun time, and these steps do not match ours. Counting the
        overlap instead of picking the nearest keeps a moving shadow's edge to a fraction of a step. Rows sum to one
        by day and to zero by night.
        """
        if sun_hour.size == 0:
            return np.zeros((self.hour.size, 0))
        edges = _edges(sun_hour)
        half = 12.0 / self.hour.size
        overlap = np.zeros((self.hour.size, sun_hour.size))
        for turn in (-24.0, 0.0, 24.0):
            first = np.maximum(edges[None, :-1] + turn, self.hour[:, None] - half)
            last = np.minimum(edges[None, 1:] + turn, self.hour[:, None] + half)
            overlap += np.maximum(last - first, 0.0)
        return overlap / (2.0 * half)


def _edges(sun_hour: Float64[np.ndarray, "times"]) -> Float64[np.ndarray, "edges"]:
    """Limits [h] of the steps around sun times, midway between neighbours; a single time stands for the whole day."""
    if sun_hour.size == 1:
        return np.array([sun_hour[0] - 12.0, sun_hour[0] + 12.0])
    middle = 0.5 * (sun_hour[1:] + sun_hour[:-1])
    return np.concatenate([[2 * sun_hour[0] - middle[0]], middle, [2 * sun_hour[-1] - middle[-1]]])
