"""Broadband sky, humidity, and the difference between the two skies that must never be confused."""

from __future__ import annotations

import numpy as np
import pytest

from scenegen.climate.broadband import sky_emissivity, sky_irradiance
from scenegen.climate.humidity import saturation_pressure_hPa, saturation_slope_hPaK
from scenegen.climate.weather import Weather, cloud_base_K
from scenegen.radiometry.planck import brightness_temperature
from scenegen.radiometry.sky import sky_radiance


def test_berdahl_martin_and_walton():
    assert sky_emissivity(283.15, 0.0) == pytest.approx(0.7743, abs=5e-5)
    assert sky_emissivity(283.15, 1.0) == pytest.approx(0.8935, abs=5e-5)
    assert sky_emissivity(300.0, 1.0) == 1.0


def test_sky_flux_of_a_summer_day():
    """Radiative transfer: 341.7 W/m^2 for mid-latitude summer, dew point 16.8 C; the formula scatters by 9 rms."""
    assert sky_irradiance(np.array([294.2]), 289.95, 0.0)[0] == pytest.approx(341.7, abs=12.0)


def test_saturation_pressure():
    np.testing.assert_allclose(
        saturation_pressure_hPa(np.array([273.15, 283.15, 293.15, 303.15])),
        [6.11, 12.28, 23.38, 42.43],
        rtol=1e-3,
    )
    T = np.linspace(250.0, 320.0, 15)
    numeric = (saturation_pressure_hPa(T + 1e-3) - saturation_pressure_hPa(T - 1e-3)) / 2e-3
    np.testing.assert_allclose(saturation_slope_hPaK(T), numeric, rtol=1e-4)


def test_air_temperature_of_a_day():
    weather = Weather(297.65, 6.5, 15.0, 286.15, 3.0, 0.0, 3.0)
    hour = np.arange(24.0)
    air = weather.air_K(hour)
    assert hour[air.argmax()] == 15.0
    assert air.max() == pytest.approx(304.15)
    assert air.min() == pytest.approx(291.15)


def test_the_image_sees_a_far_colder_zenith_than_the_heat_balance():
    """Mid-latitude summer: +7 C broadband equivalent against -26 C in the band."""
    weather = Weather(294.2, 0.0, 15.0, 289.95, 3.0, 0.0, 3.0)
    in_band = brightness_temperature(
        sky_radiance(np.array([1.0]), weather.atmosphere(12.0), (8.0, 14.0)), (8.0, 14.0)
    )[0]
    broadband = 294.2 * sky_emissivity(289.95, 0.0) ** 0.25
    assert broadband - in_band == pytest.approx(33.0, abs=4.0)


def test_cloud_base_is_a_few_kelvin_below_air():
    assert cloud_base_K(290.0, 284.0) == pytest.approx(285.125)
    assert cloud_base_K(290.0, 291.0) == 290.0
