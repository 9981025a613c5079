"""The sea: its temperature over the year, and waves against the spectrum they are drawn from."""

from __future__ import annotations

import numpy as np
import pytest

from scenegen.climate.sea import FREEZING_K, SKIN_K, sea_surface_K
from scenegen.climate.season import Season
from scenegen.maps.coastline.waves import draw_waves, jonswap, peak_frequency


def test_the_sea_is_warm_in_the_tropics_cold_at_the_poles_and_late():
    tropics, pole = sea_surface_K(Season(5.0, 8, 25)), sea_surface_K(Season(85.0, 2, 20))
    assert 299.0 < tropics < 303.0
    assert pole == pytest.approx(FREEZING_K + SKIN_K, abs=0.01)
    year = [sea_surface_K(Season.from_day_of_year(45.0, d)) for d in range(1, 366)]
    assert abs(int(np.argmax(year)) + 1 - 237) <= 1
    assert max(year) - min(year) == pytest.approx(9.8, abs=0.5)
    assert sea_surface_K(Season(-45.0, 2, 24)) > sea_surface_K(Season(-45.0, 8, 25))


def test_jonswap_grows_with_fetch_and_becomes_a_full_sea():
    omega = np.linspace(0.2, 12.0, 60_000)
    step = omega[1] - omega[0]
    height = [4.0 * np.sqrt(jonswap(omega, 10.0, f).sum() * step) for f in (5e3, 20e3, 80e3)]
    # Hasselmann et al.: Hs = 0.0016 U sqrt(x / g) while the sea grows; their fits of alpha and of the peak, which
    # make the spectrum, give a third more at long fetches.
    expected = [0.0016 * 10.0 * np.sqrt(f / 9.81) for f in (5e3, 20e3, 80e3)]
    assert height == pytest.approx(expected, rel=0.33)
    assert omega[np.argmax(jonswap(omega, 10.0, 20e3))] == pytest.approx(peak_frequency(10.0, 20e3), rel=0.01)
    assert peak_frequency(3.0, 500e3) == pytest.approx(0.855 * 9.81 / 3.0)


def test_drawn_waves_carry_the_energy_of_their_spectrum():
    waves = draw_waves(8.0, 50e3, 0.0, 0.3, np.random.default_rng(0))
    omega = np.linspace(0.2, 12.0, 60_000)
    wanted = 4.0 * np.sqrt(jonswap(omega, 8.0, 50e3).sum() * (omega[1] - omega[0]))
    assert waves.significant_m == pytest.approx(wanted, rel=0.06)
    xy = np.random.default_rng(1).uniform(-2000.0, 2000.0, (20_000, 2))
    assert 4.0 * waves.elevation(xy, np.full(len(xy), 0.01)).std() == pytest.approx(
        waves.significant_m, rel=0.05
    )
    smooth = waves.elevation(xy, np.full(len(xy), 200.0))
    assert np.abs(smooth).max() == 0.0
