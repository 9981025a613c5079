"""Sun position and clear sky against published numbers."""

from __future__ import annotations

import datetime

import numpy as np
import pytest

from scenegen.climate.season import Season
from scenegen.climate.sun import (
    clear_sky_Wm2,
    daylight,
    extraterrestrial_Wm2,
    solar_zenith_azimuth_deg,
    sun_direction,
    sun_samples,
    sunshine,
)
from scenegen.climate.weather import Weather

CLEAR = Weather(297.65, 6.5, 15.0, 286.15, 3.0, 0.0, 3.0)


def test_nrel_reference_position():
    when = datetime.datetime(2003, 10, 17, 19, 30, 30, tzinfo=datetime.UTC).timestamp()
    zenith, azimuth = solar_zenith_azimuth_deg(
        np.array([when]), 39.742476, -105.1786, 1830.14, 820.0, 11.0, delta_t_s=67.0
    )
    assert zenith[0] == pytest.approx(50.11162, abs=1e-4)
    assert azimuth[0] == pytest.approx(194.34024, abs=1e-4)


def test_ineichen_reference_values():
    sine = np.cos(np.radians([0.0, 30.0, 60.0, 75.0, 85.0]))
    direct, diffuse = clear_sky_Wm2(sine, 3.0, 1364.0)
    np.testing.assert_allclose(direct, [942.26, 916.45, 787.81, 567.88, 176.48], atol=0.01)
    np.testing.assert_allclose(diffuse, [111.95, 103.10, 75.72, 49.85, 15.81], atol=0.01)
    np.testing.assert_allclose(direct * sine + diffuse, [1054.21, 896.76, 469.62, 196.82, 31.19], atol=0.01)


def test_fao56_extraterrestrial_radiation():
    """Example 18: 50 deg 48 min N, 6 July: 41.09 MJ/m^2 a day (FAO's rounder formulae differ by half a per cent)."""
    season = Season(50.8, 7, 6)
    hour = (np.arange(1440) + 0.5) / 60.0
    sine = np.maximum(sun_direction(season, hour)[:, 2], 0.0)
    daily = extraterrestrial_Wm2(season) * sine.sum() * 60.0 / 1e6
    assert daily == pytest.approx(41.09, rel=0.006)


def test_directions_are_unit_east_north_up():
    morning, noon, evening = sun_direction(Season(40.0, 3, 21), np.array([7.0, 12.12, 17.5]))
    np.testing.assert_allclose([np.linalg.norm(d) for d in (morning, noon, evening)], 1.0)
    assert morning[0] > 0.9  # east
    assert abs(noon[0]) < 0.01
    assert noon[1] < -0.6  # south
    assert evening[0] < -0.9


def test_the_sun_stands_in_the_north_below_the_equator():
    assert sun_direction(Season(-35.0, 6, 21), np.array([12.0]))[0, 1] > 0.8


def test_hours_wrap_around_midnight():
    season = Season(40.0, 7, 15)
    np.testing.assert_array_equal(
        sun_direction(season, np.array([25.5])), sun_direction(season, np.array([1.5]))
    )


def test_daylight_and_samples():
    first, last = daylight(Season(40.0, 7, 15))
    assert last - first == pytest.approx(14.68, abs=0.15)
    hour, direction = sun_samples(Season(40.0, 7, 15), 64)
    assert hour.shape == (64,)
    assert (direction[:, 2] > 0.0).all()
    assert daylight(Season(80.0, 12, 21)) is None
    assert daylight(Season(80.0, 6, 21)) == (0.0, 24.0)
    assert sun_samples(Season(80.0, 12, 21), 64)[1].shape == (0, 3)


@pytest.mark.parametrize("latitude", [-66.0, 66.5, 69.0, 89.0])
@pytest.mark.parametrize("date", [(1, 1), (3, 20), (6, 21), (12, 21)])
def test_polar_days_and_nights_are_finite(latitude, date):
    sun = sunshine(Season(latitude, *date), CLEAR, np.arange(144) / 6.0)
    for flux in (sun.direct_Wm2, sun.diffuse_Wm2, sun.global_Wm2):
        assert np.isfinite(flux).all()
        assert (flux >= -1e-9).all()


def test_clouds_turn_direct_light_into_diffuse():
    season, noon = Season(40.0, 7, 15), np.array([12.0])
    clear = sunshine(season, CLEAR, noon)
    overcast = sunshine(season, Weather(297.65, 3.0, 15.0, 286.15, 3.0, 1.0, 3.0), noon)
    broken = sunshine(season, Weather(297.65, 5.0, 15.0, 286.15, 3.0, 0.5, 3.0), noon)
    assert overcast.global_Wm2[0] == pytest.approx(0.25 * clear.global_Wm2[0])
    assert overcast.direct_Wm2[0] == pytest.approx(0.0, abs=1e-9)
    assert broken.diffuse_Wm2[0] > clear.diffuse_Wm2[0]
    assert broken.direct_Wm2[0] < clear.direct_Wm2[0]
