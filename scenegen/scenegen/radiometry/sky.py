"""The sky as a long-wave camera sees it: cold at the zenith, at air temperature on the horizon, warm under clouds.

This is the *in-band* sky, for images. The heat balance needs the broadband sky (`scenegen.climate.broadband`), which
is far warmer: feeding one into the other's place makes mirror-like roofs and cars 27-44 K wrong.
"""

from __future__ import annotations

import math

import numpy as np
from jaxtyping import Float, Float64

from scenegen.radiometry.atmosphere import Atmosphere
from scenegen.radiometry.band import band
from scenegen.radiometry.planck import band_radiance


def air_mass(sin_elevation: Float[np.ndarray, "*shape"]) -> Float64[np.ndarray, "*shape"]:
    """Relative optical air mass (Kasten, Young 1989, doi:10.1364/AO.28.004735), at its largest below the horizon."""
    s = np.clip(np.asarray(sin_elevation, dtype=np.float64), 0.0, 1.0)
    elevation_deg = np.degrees(np.arcsin(s))
    return np.asarray(1.0 / (s + 0.50572 * (elevation_deg + 6.07995) ** -1.6364))


def clear_sky_emissivity(
    sin_elevation: Float[np.ndarray, "*shape"], atmosphere: Atmosphere, band_um: tuple[float, float]
) -> Float64[np.ndarray, "*shape"]:
    """Radiance of the cloudless sky relative to a blackbody at air temperature, over the band.

    See `scenegen.radiometry.band.SkyFit` for the fit and its errors.
    """
    f = band(band_um).sky
    e = atmosphere.vapour_pressure_hPa
    depth = (f.c0 + f.c1 * e + f.c2 * e**2) * atmosphere.sky_optical_depth_factor
    return np.asarray(1.0 - (1.0 - f.f0) * np.exp(-depth * air_mass(sin_elevation) ** f.b))


def sky_radiance(
    sin_elevation: Float[np.ndarray, "*shape"], atmosphere: Atmosphere, band_um: tuple[float, float]
) -> Float64[np.ndarray, "*shape"]:
    """Downwelling band radiance [W m^-2 sr^-1] from a direction of the sky.

    Clouds cover the share `cloud_fraction` and shine as blackbodies at their base temperature through the clear air
    below. Directions below the horizon meet ground at air temperature. A finite `uniform_sky_K` replaces everything.

    Parameters
    ----------
    sin_elevation : float array
        Sine of the elevation, -1..1.
    atmosphere : Atmosphere
    band_um : (float, float)
    """
    s = np.asarray(sin_elevation, dtype=np.float64)
    if math.isfinite(atmosphere.uniform_sky_K):
        return np.full(s.shape, band_radiance(np.array(atmosphere.uniform_sky_K), band_um))
    air = band_radiance(np.array(atmosphere.air_K), band_um)
    cloud = band_radiance(np.array(atmosphere.cloud_K), band_um)
    clear = clear_sky_emissivity(s, atmosphere, band_um)
    above = clear * air + atmosphere.cloud_fraction * (1.0 - clear) * cloud
    return np.asarray(np.where(s < 0.0, air, above))
