"""Planck's law in a band: published values, the exact series, and the limits Stefan-Boltzmann sets."""

from __future__ import annotations

import itertools

import numpy as np
import pytest
from scipy import constants

from scenegen.radiometry.planck import (
    STEFAN_BOLTZMANN,
    PlanckFit,
    band_radiance,
    band_radiance_slope,
    brightness_temperature,
)

BANDS = [(8.0, 14.0), (7.5, 13.5)]

TABLE = [
    # T [K], L 8-14, dL/dT 8-14, L 7.5-13.5, dL/dT 7.5-13.5
    (250.00, 22.292290, 0.475950, 21.689185, 0.481809),
    (273.15, 35.151962, 0.637354, 34.846488, 0.658128),
    (288.15, 45.538287, 0.748116, 45.635689, 0.781418),
    (300.00, 54.933461, 0.837821, 55.491611, 0.882489),
    (310.15, 63.831652, 0.915628, 64.896666, 0.970974),
    (330.00, 83.526826, 1.068859, 85.915214, 1.147308),
    (400.00, 176.935022, 1.592457, 188.108883, 1.768005),
]


@pytest.mark.parametrize("row", TABLE, ids=lambda row: f"{row[0]:g}K")
def test_radiance_and_slope_match_the_table(row):
    T = np.array([row[0]])
    for band, radiance, slope in ((BANDS[0], row[1], row[2]), (BANDS[1], row[3], row[4])):
        assert band_radiance(T, band)[0] == pytest.approx(radiance, rel=1e-6)
        assert band_radiance_slope(T, band)[0] == pytest.approx(slope, rel=2e-6)


def _below(wavelength_m: float, T: float) -> float:
    """Radiance of a blackbody below a wavelength, by the exponential series."""
    x = constants.h * constants.c / (constants.k * wavelength_m * T)
    n = np.arange(1, 400)
    series = np.exp(-n * x) * (x**3 / n + 3 * x**2 / n**2 + 6 * x / n**3 + 6 / n**4)
    return 2 * constants.k**4 * T**4 / (constants.h**3 * constants.c**2) * float(series.sum())


@pytest.mark.parametrize("band", BANDS)
@pytest.mark.parametrize("T", [150.0, 233.0, 300.0, 423.0, 1000.0])
def test_quadrature_agrees_with_the_series(band, T):
    series = _below(band[1] * 1e-6, T) - _below(band[0] * 1e-6, T)
    assert band_radiance(np.array([T]), band)[0] == pytest.approx(series, rel=1e-12)


def test_all_wavelengths_together_give_stefan_boltzmann():
    edges = [0.5, 2.0, 4.0, 8.0, 14.0, 30.0, 80.0, 300.0, 2000.0, 20000.0]
    T = np.array([300.0])
    total = sum(band_radiance(T, (a, b))[0] for a, b in itertools.pairwise(edges))
    assert total == pytest.approx(STEFAN_BOLTZMANN * 300.0**4 / np.pi, rel=1e-5)


@pytest.mark.parametrize("band", BANDS)
def test_slope_is_the_derivative(band):
    T = np.linspace(180.0, 420.0, 25)
    numeric = (band_radiance(T + 1e-3, band) - band_radiance(T - 1e-3, band)) / 2e-3
    np.testing.assert_allclose(band_radiance_slope(T, band), numeric, rtol=1e-8)


@pytest.mark.parametrize("band", BANDS)
def test_brightness_temperature_inverts_exactly(band):
    T = np.linspace(150.0, 1000.0, 2000)
    np.testing.assert_allclose(brightness_temperature(band_radiance(T, band), band), T, rtol=1e-12)
    assert np.isnan(brightness_temperature(np.array([0.0, -1.0]), band)).all()


@pytest.mark.parametrize("band", BANDS)
@pytest.mark.parametrize("dtype", [np.float32, np.float64])
def test_the_kernel_fit_is_accurate_and_monotone(band, dtype):
    fit = PlanckFit.of(band)
    T = np.linspace(150.0, 1000.0, 50_000)
    error = fit.radiance(T.astype(dtype)).astype(np.float64) / band_radiance(T, band) - 1.0
    earthly = (T >= 180.0) & (T <= 420.0)
    assert np.abs(error[earthly]).max() < 1e-5
    assert np.abs(error).max() < 5e-4
    assert (np.diff(fit.radiance(T)) > 0.0).all()
    back = fit.temperature(band_radiance(T[earthly], band).astype(dtype))
    assert np.abs(back - T[earthly]).max() < 1e-3
