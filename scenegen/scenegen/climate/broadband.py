"""The broadband long-wave sky of the heat balance. Never use it in an image: see `scenegen.radiometry.sky`."""

from __future__ import annotations

import numpy as np
from jaxtyping import Float, Float64

from scenegen.radiometry.planck import STEFAN_BOLTZMANN


def sky_emissivity(dew_point_K: float, cloud_fraction: float) -> float:
    """Hemispherical emissivity of the sky relative to air temperature.

    Clear sky after Berdahl and Martin 1984 (doi:10.1016/0038-092X(84)90144-0), the formula with the least error
    (bias -2, rms 9 W/m^2) against 86 radiative transfer profiles; clouds by Walton's polynomial in tenths
    (NBSIR 83-2655), at most one.
    """
    dew = (dew_point_K - 273.15) / 100.0
    clear = 0.711 + 0.56 * dew + 0.73 * dew**2
    n = 10.0 * cloud_fraction
    return min(clear * (1.0 + 0.0224 * n - 0.0035 * n**2 + 0.00028 * n**3), 1.0)


def sky_irradiance(
    air_K: Float[np.ndarray, "*shape"], dew_point_K: float, cloud_fraction: float
) -> Float64[np.ndarray, "*shape"]:
    """Downwelling long-wave flux on an open horizontal surface [W/m^2]."""
    return np.asarray(sky_emissivity(dew_point_K, cloud_fraction) * STEFAN_BOLTZMANN * np.asarray(air_K) ** 4)
