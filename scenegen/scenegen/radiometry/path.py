"""The air between surface and camera: transmission by range, and the radiance the air adds (isothermal path)."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from jaxtyping import Float, Float64

from scenegen.radiometry.atmosphere import Atmosphere
from scenegen.radiometry.band import band
from scenegen.radiometry.planck import band_radiance


@dataclass(frozen=True)
class PathTerms:
    """``tau(R) = sum_i weight_i exp(-attenuation_i R)``, aerosol included; what a kernel needs to know of the air.

    Attributes
    ----------
    weight : (float, float, float)
        Sums to one.
    attenuation_per_m : (float, float, float)
    air_radiance : float
        B(T_air) [W m^-2 sr^-1], what an infinitely long path looks like.
    """

    weight: tuple[float, float, float]
    attenuation_per_m: tuple[float, float, float]
    air_radiance: float

    def transmission(self, range_m: Float[np.ndarray, "*shape"]) -> Float64[np.ndarray, "*shape"]:
        """Transmission over a range [m], 1 at zero."""
        R = np.asarray(range_m, dtype=np.float64)
        total = np.zeros_like(R)
        for a, k in zip(self.weight, self.attenuation_per_m, strict=True):
            total += a * np.exp(-k * R)
        return total

    def through(
        self, radiance: Float[np.ndarray, "*shape"], range_m: Float[np.ndarray, "*shape"]
    ) -> Float64[np.ndarray, "*shape"]:
        """Radiance after the path: ``tau L + (1 - tau) B(T_air)``."""
        tau = self.transmission(range_m)
        return np.asarray(tau * radiance + (1.0 - tau) * self.air_radiance)


def absolute_humidity_gm3(atmosphere: Atmosphere) -> float:
    """Water vapour density [g/m^3], ideal gas."""
    return 216.68 * atmosphere.vapour_pressure_hPa / atmosphere.air_K


def aerosol_per_km(visibility_km: float) -> float:
    """Aerosol extinction in the long-wave band [1/km] from the meteorological range.

    Koschmieder's 3.912 / V at 0.55 um times LOWTRAN 7's ratio at 10 um: 0.09 for rural and urban haze, 0.27 for
    radiation fog at V = 0.5 km, 1.2 for dense advection fog at V = 0.2 km, log-log between them.
    """
    ratio = np.exp(np.interp(np.log(visibility_km), np.log([0.2, 0.5, 2.0]), np.log([1.2, 0.27, 0.09])))
    return 3.912 / visibility_km * float(ratio)


def path_terms(atmosphere: Atmosphere, band_um: tuple[float, float]) -> PathTerms:
    """Coefficients of the path for an atmosphere and a band; a vacuum where `atmosphere.path` is off."""
    air = float(band_radiance(np.array(atmosphere.air_K), band_um))
    if not atmosphere.path:
        return PathTerms((1.0, 0.0, 0.0), (0.0, 0.0, 0.0), air)
    f = band(band_um).path
    rho = absolute_humidity_gm3(atmosphere)
    aerosol = aerosol_per_km(atmosphere.visibility_km)
    k = [(k0 + k1 * rho + k2 * rho**2 + aerosol) * 1e-3 for k0, k1, k2 in zip(f.k0, f.k1, f.k2, strict=True)]
    return PathTerms(f.a, (k[0], k[1], k[2]), air)
