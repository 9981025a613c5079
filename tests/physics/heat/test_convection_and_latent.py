"""Convection and evaporation against the published checks."""

from __future__ import annotations

import numpy as np
import pytest
from scipy.optimize import brentq

from scenegen.climate.humidity import saturation_slope_hPaK
from scenegen.heat.convection import convection_coefficient, natural_convection
from scenegen.heat.latent import AIR_HEAT_CAPACITY_Jm3K, latent_flux


@pytest.mark.parametrize(
    ("wind", "glass", "rough"), [(3.0, 9.257, 13.280), (1.0, 4.604, 5.511), (5.0, 14.037, 21.263)]
)
def test_doe2_reference_values(wind, glass, rough):
    ten, up = np.array([10.0]), np.array([1.0])
    assert convection_coefficient(ten, up, wind, np.array([1.0]))[0] == pytest.approx(glass, abs=1.5e-3)
    assert convection_coefficient(ten, up, wind, np.array([1.67]))[0] == pytest.approx(rough, abs=1.5e-3)


def test_natural_convection_branches():
    """Warm roofs stir the air, cold ones do not; a ceiling is the mirror image; a wall does not care."""
    excess = np.array([10.0, -10.0])
    up, down, wall = (natural_convection(excess, np.full(2, c)) for c in (1.0, -1.0, 0.0))
    np.testing.assert_allclose(up, [9.482 / 6.283 * 10 ** (1 / 3), 1.81 / 2.382 * 10 ** (1 / 3)], rtol=1e-3)
    np.testing.assert_allclose(down, up[::-1], rtol=1e-12)
    np.testing.assert_allclose(wall, 1.31 * 10 ** (1 / 3), rtol=8e-3)


def test_convection_is_smooth_through_zero():
    excess = np.linspace(-3.0, 3.0, 601)
    h = convection_coefficient(excess, np.ones(601), 0.0, np.ones(601))
    assert (h > 0.5).all()
    assert np.abs(np.diff(h)).max() < 0.03


def test_big_leaf_against_penman_monteith():
    """T_a 25 C, e_a 15 hPa, r_a 50, r_s 70 s/m, R_n 400 W/m^2: LE 334.9, T_s - T_a 2.70 K; Penman-Monteith 332.3."""
    h = np.array([AIR_HEAT_CAPACITY_Jm3K / 50.0])
    one, rs = np.array([1.0]), np.array([70.0])

    def surplus(excess: float) -> float:
        LE, _ = latent_flux(np.array([298.15 + excess]), 15.0, h, one, rs)
        return 400.0 - float(h[0] * excess + LE[0])

    excess = brentq(surplus, -20.0, 40.0)
    LE, _ = latent_flux(np.array([298.15 + excess]), 15.0, h, one, rs)
    assert excess == pytest.approx(2.70, abs=0.02)
    assert LE[0] == pytest.approx(334.9, abs=0.5)
    slope = 100.0 * saturation_slope_hPaK(np.array([298.15]))[0]
    penman = (slope * 400.0 + AIR_HEAT_CAPACITY_Jm3K * (3168.0 - 1500.0) / 50.0) / (
        slope + 66.5 * 120.0 / 50.0
    )
    assert LE[0] == pytest.approx(penman, rel=0.01)


def test_latent_slope_is_the_derivative():
    T = np.linspace(275.0, 315.0, 9)
    arguments = (12.0, np.full(9, 15.0), np.full(9, 0.6), np.full(9, 100.0))
    above, below = latent_flux(T + 1e-3, *arguments)[0], latent_flux(T - 1e-3, *arguments)[0]
    np.testing.assert_allclose(latent_flux(T, *arguments)[1], (above - below) / 2e-3, rtol=1e-4)


def test_dry_surfaces_do_not_evaporate():
    LE, slope = latent_flux(np.array([300.0]), 10.0, np.array([15.0]), np.array([0.0]), np.array([0.0]))
    assert LE[0] == 0.0
    assert slope[0] == 0.0
