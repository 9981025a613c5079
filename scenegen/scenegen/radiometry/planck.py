"""Planck's law integrated over a camera's band, its slope, its inverse, and a compact fit for the tracer."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cache

import numpy as np
from jaxtyping import Float
from numpy.polynomial import chebyshev, polynomial

FIRST_RADIATION = 2 * 6.62607015e-34 * 299792458.0**2
"""2 h c^2 [W m^2 sr^-1], CODATA 2018."""
SECOND_RADIATION = 6.62607015e-34 * 299792458.0 / 1.380649e-23
"""h c / k = 1.438776877e-2 m K, CODATA 2018."""
STEFAN_BOLTZMANN = 5.670374419e-8
"""[W m^-2 K^-4], CODATA 2018."""

_NODES = 24
_LOW_K, _HIGH_K = 150.0, 1000.0
"""Range the fits are made for: colder than any sky, hotter than any exhaust."""

Temperatures = Float[np.ndarray, "*shape"]
Radiances = Float[np.ndarray, "*shape"]


@cache
def _quadrature(band_um: tuple[float, float]) -> tuple[np.ndarray, np.ndarray]:
    """``c2 / wavelength`` [K] and ``weight * c1 / wavelength^5`` at the Gauss-Legendre nodes of a band."""
    x, w = np.polynomial.legendre.leggauss(_NODES)
    low, high = band_um[0] * 1e-6, band_um[1] * 1e-6
    wavelength = 0.5 * (high + low) + 0.5 * (high - low) * x
    return SECOND_RADIATION / wavelength, 0.5 * (high - low) * w * FIRST_RADIATION / wavelength**5


def band_radiance(temperature_K: Temperatures, band_um: tuple[float, float]) -> Radiances:
    """Radiance of a blackbody integrated over a band, B(T) [W m^-2 sr^-1].

    24-node Gauss-Legendre quadrature; agrees with the exact series to 1e-14 relative between 150 and 1000 K.
    """
    scale, weight = _quadrature(band_um)
    T = np.asarray(temperature_K, dtype=np.float64)
    total = np.zeros_like(T)
    for u, w in zip(scale, weight, strict=True):  # one node at a time: memory stays that of the image
        total += w / np.expm1(u / T)
    return total


def band_radiance_slope(temperature_K: Temperatures, band_um: tuple[float, float]) -> Radiances:
    """Derivative of the band radiance, dB/dT [W m^-2 sr^-1 K^-1]."""
    scale, weight = _quadrature(band_um)
    T = np.asarray(temperature_K, dtype=np.float64)
    total = np.zeros_like(T)
    for u, w in zip(scale, weight, strict=True):
        x = u / T
        total += w / np.expm1(x) * x / T / -np.expm1(-x)
    return total


def brightness_temperature(radiance: Radiances, band_um: tuple[float, float]) -> Temperatures:
    """Temperature [K] of the blackbody with this band radiance: the fitted inverse, then two Newton steps.

    Exact to rounding between 150 and 1000 K; NaN where the radiance is not positive.
    """
    L = np.asarray(radiance, dtype=np.float64)
    positive = L > 0
    safe = np.where(positive, L, 1.0)
    T = PlanckFit.of(band_um).temperature(safe)
    for _ in range(2):
        B = band_radiance(T, band_um)
        # Newton on ln B(1/T) is nearly linear and cannot leave the positive half line
        slope = band_radiance_slope(T, band_um) / B
        T = T / (1.0 - np.log(safe / B) / (slope * T))
    return np.where(positive, T, np.nan)


@dataclass(frozen=True)
class PlanckFit:
    """Band radiance as ``exp(polynomial(300/T - 1))``: a handful of multiply-adds for the tracer's kernel.

    Attributes
    ----------
    band_um : (float, float)
    radiance_coefficients : tuple of float
        Of ``ln B`` in powers of ``300/T - 1``, constant first.
    temperature_coefficients : tuple of float
        Of ``300/T - 1`` in powers of ``(ln L - temperature_offset) / temperature_scale``, constant first.
    temperature_offset, temperature_scale : float
    """

    band_um: tuple[float, float]
    radiance_coefficients: tuple[float, ...]
    temperature_coefficients: tuple[float, ...]
    temperature_offset: float
    temperature_scale: float

    @staticmethod
    def of(band_um: tuple[float, float]) -> PlanckFit:
        """Fit of a band; computed once per process (a millisecond)."""
        return _fit((float(band_um[0]), float(band_um[1])))

    def radiance(self, temperature_K: Temperatures) -> Radiances:
        """B(T) in the precision of the argument; relative error below 1e-5 at 180-420 K."""
        T = np.asarray(temperature_K)
        y = T.dtype.type(300.0) / T - T.dtype.type(1.0)
        return np.asarray(np.exp(_horner(self.radiance_coefficients, y)))

    def temperature(self, radiance: Radiances) -> Temperatures:
        """Inverse [K] in the precision of the argument; error below 1 mK at 180-420 K."""
        L = np.asarray(radiance)
        z = (np.log(L) - L.dtype.type(self.temperature_offset)) / L.dtype.type(self.temperature_scale)
        return np.asarray(
            L.dtype.type(300.0) / (L.dtype.type(1.0) + _horner(self.temperature_coefficients, z))
        )


def _horner(coefficients: tuple[float, ...], x: Temperatures) -> Temperatures:
    total = np.full_like(x, coefficients[-1])
    for c in reversed(coefficients[:-1]):
        total = total * x + x.dtype.type(c)
    return total


@cache
def _fit(band_um: tuple[float, float]) -> PlanckFit:
    y = _interval_nodes(300.0 / _HIGH_K - 1.0, 300.0 / _LOW_K - 1.0)
    T = 300.0 / (1.0 + y)
    log_radiance = np.log(band_radiance(T, band_um))
    # Earthly temperatures weigh most; the ends only keep the fit sane for a frozen sky and an exhaust pipe.
    weight = np.where((T > 170.0) & (T < 450.0), 1.0, 0.05)
    forward = polynomial.polyfit(y, log_radiance, 10, w=weight)
    offset, scale = float(log_radiance.mean()), float(np.ptp(log_radiance)) / 2
    z = (log_radiance - offset) / scale
    backward = chebyshev.cheb2poly(chebyshev.chebfit(z, y, 10, w=weight))
    # Twelve decimals: far below the fit's error, and the same whatever order a linear algebra library summed in.
    return PlanckFit(band_um, _rounded(forward), _rounded(backward), round(offset, 12), round(scale, 12))


def _rounded(coefficients: np.ndarray) -> tuple[float, ...]:
    return tuple(round(float(c), 12) for c in coefficients)


def _interval_nodes(low: float, high: float) -> np.ndarray:
    return 0.5 * (low + high) + 0.5 * (high - low) * chebyshev.chebpts1(400)
