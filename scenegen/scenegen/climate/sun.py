"""Where the sun stands and how strong it shines, by pvlib's numpy-level functions (imported on first use)."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from jaxtyping import Float64

from scenegen.climate.season import Season
from scenegen.climate.weather import Weather

_DELTA_T_S = 69.4
"""Terrestrial minus universal time in the reference year [s]."""
_REFRACTION_DEG = 0.5667
"""Refraction at sunrise and sunset [deg]."""
_LAST_ELEVATION_SIN = 1e-3
"""Below this the clear-sky model divides by zero, and nothing is lost."""


@dataclass(frozen=True, eq=False)
class Sunshine:
    """The sun over one day of weather.

    Attributes
    ----------
    direction : float64 (hours, 3)
        Unit vectors towards the (refracted) sun, ENU.
    direct_Wm2 : float64 (hours,)
        Direct normal irradiance behind clouds, mean over sun and cloud shadow.
    diffuse_Wm2 : float64 (hours,)
        Diffuse irradiance on an open horizontal surface.
    global_Wm2 : float64 (hours,)
        Both together on an open horizontal surface.
    """

    direction: Float64[np.ndarray, "hours 3"]
    direct_Wm2: Float64[np.ndarray, "hours"]
    diffuse_Wm2: Float64[np.ndarray, "hours"]
    global_Wm2: Float64[np.ndarray, "hours"]


def solar_zenith_azimuth_deg(
    unix_s: Float64[np.ndarray, "times"],
    latitude_deg: float,
    longitude_deg: float = 0.0,
    altitude_m: float = 0.0,
    pressure_hPa: float = 1013.25,
    air_C: float = 12.0,
    delta_t_s: float = _DELTA_T_S,
) -> tuple[Float64[np.ndarray, "times"], Float64[np.ndarray, "times"]]:
    """Apparent zenith angle and azimuth (clockwise from north) [deg], NREL's solar position algorithm.

    Reda and Andreas 2004, doi:10.1016/j.solener.2003.12.003; +-0.0003 deg.
    """
    from pvlib import spa

    result = spa.solar_position_numpy(
        unix_s, latitude_deg, longitude_deg, altitude_m, pressure_hPa, air_C, delta_t_s, _REFRACTION_DEG, 1
    )
    return np.asarray(result[0]), np.asarray(result[4])


def sun_direction(season: Season, hour: Float64[np.ndarray, "hours"]) -> Float64[np.ndarray, "hours 3"]:
    """Unit vectors towards the sun, ENU, at hours of the season's date (local mean solar time, longitude 0)."""
    time = season.midnight_unix_s + 3600.0 * (np.asarray(hour, dtype=np.float64) % 24.0)
    zenith, azimuth = (np.radians(a) for a in solar_zenith_azimuth_deg(time, season.latitude_deg))
    return np.stack(
        [np.sin(zenith) * np.sin(azimuth), np.sin(zenith) * np.cos(azimuth), np.cos(zenith)], axis=-1
    )


def daylight(season: Season) -> tuple[float, float] | None:
    """First and last hour [h] of the sun above the horizon, to 10 s; None in the polar night.

    A midnight sun returns the whole day, (0, 24).
    """
    hour = np.arange(0.0, 24.0, 10.0 / 3600.0)
    up = sun_direction(season, hour)[:, 2] > 0.0
    if not up.any():
        return None
    if up.all():
        return 0.0, 24.0
    risen = hour[up]
    return float(risen[0]), float(risen[-1])


def sun_samples(
    season: Season, count: int
) -> tuple[Float64[np.ndarray, "times"], Float64[np.ndarray, "times 3"]]:
    """Hours in the middles of `count` equal parts of the daylight, and the sun's directions then.

    Empty arrays in the polar night. These are the moments at which an `Exposure` asks who sees the sun.
    """
    light = daylight(season)
    if light is None:
        return np.zeros(0), np.zeros((0, 3))
    hour = light[0] + (light[1] - light[0]) * (np.arange(count) + 0.5) / count
    direction = sun_direction(season, hour)
    keep = direction[:, 2] > 0.0
    return hour[keep], direction[keep]


def extraterrestrial_Wm2(season: Season) -> float:
    """Solar irradiance outside the atmosphere on this day (Spencer 1971, 1366.1 W/m^2 at one astronomical unit)."""
    from pvlib import irradiance

    return float(irradiance.get_extra_radiation(season.day_of_year, method="spencer"))


def clear_sky_Wm2(
    sin_elevation: Float64[np.ndarray, "hours"],
    linke_turbidity: float,
    extra_Wm2: float,
    altitude_m: float = 0.0,
) -> tuple[Float64[np.ndarray, "hours"], Float64[np.ndarray, "hours"]]:
    """Direct normal and diffuse horizontal irradiance of a cloudless sky [W/m^2].

    Ineichen and Perez 2002, doi:10.1016/S0038-092X(02)00045-2, with Kasten and Young's air mass.
    """
    from pvlib import atmosphere, clearsky

    direct, diffuse = np.zeros_like(sin_elevation), np.zeros_like(sin_elevation)
    up = sin_elevation > _LAST_ELEVATION_SIN
    zenith = np.degrees(np.arccos(np.clip(sin_elevation[up], -1.0, 1.0)))
    mass = np.asarray(atmosphere.get_relative_airmass(zenith)) * np.exp(-altitude_m / 8434.5)
    sky = clearsky.ineichen(zenith, mass, linke_turbidity, altitude_m, extra_Wm2)
    direct[up], diffuse[up] = sky["dni"], sky["dhi"]
    return direct, diffuse


def sunshine(season: Season, weather: Weather, hour: Float64[np.ndarray, "hours"]) -> Sunshine:
    """Sun direction and irradiance at hours of a day of this weather.

    Clouds weaken the global irradiance by 1 - 0.75 n^3.4 and turn direct into diffuse light: the diffuse share goes
    from its clear-sky value to one as n^2 (Kasten and Czeplak 1980, doi:10.1016/0038-092X(80)90391-6).
    """
    direction = sun_direction(season, hour)
    sine = np.maximum(direction[:, 2], 0.0)
    direct, diffuse = clear_sky_Wm2(sine, weather.linke_turbidity, extraterrestrial_Wm2(season))
    n = weather.cloud_fraction
    clear_global = direct * sine + diffuse
    cloudy_global = clear_global * (1.0 - 0.75 * n**3.4)
    cloudy_direct = direct * (1.0 - 0.75 * n**3.4) * (1.0 - n**2)
    return Sunshine(direction, cloudy_direct, cloudy_global - cloudy_direct * sine, cloudy_global)
