"""Foliage through the year: leaves in summer, none in winter, the south half a year later, the tropics always green."""

from __future__ import annotations

import numpy as np
import pytest

from scenegen.climate.season import Season
from scenegen.parts.vegetation.foliage import leaf_fraction


def year(latitude_deg: float, shift_d: float = 0.0) -> np.ndarray:
    return np.array([leaf_fraction(Season.from_day_of_year(latitude_deg, d), shift_d) for d in range(1, 366)])


@pytest.mark.parametrize("latitude_deg", [36.0, 45.0, 50.0, 60.0, 69.0])
def test_leaves_in_july_and_none_in_january_and_the_south_mirrors_it(latitude_deg):
    assert leaf_fraction(Season(latitude_deg, 1, 15)) == 0.0
    assert leaf_fraction(Season(latitude_deg, 7, 20)) == 1.0
    assert leaf_fraction(Season(-latitude_deg, 1, 18)) == 1.0
    assert leaf_fraction(Season(-latitude_deg, 7, 16)) == 0.0


def test_a_year_has_one_spring_and_one_autumn():
    for latitude_deg in np.linspace(32.0, 70.0, 20):
        step = np.diff(np.concatenate([year(latitude_deg), year(latitude_deg)[:1]]))
        rising = np.flatnonzero(step > 0)
        assert (np.diff(rising) == 1).all()
        assert step.sum() == pytest.approx(0.0)
        assert np.abs(step).max() < 0.07


def test_dates_at_fifty_degrees_are_those_of_the_phenological_gardens():
    fraction = year(50.0)
    assert abs(int(np.argmax(fraction > 0.02)) + 1 - 113) <= 4
    falling = 180 + int(np.argmax(fraction[180:] < 0.5)) + 1
    assert abs(falling - 301) <= 2


def test_spring_is_later_and_autumn_earlier_polewards():
    days = [(fraction > 0.5).nonzero()[0][[0, -1]] for fraction in map(year, (40.0, 50.0, 60.0, 68.0))]
    starts, ends = zip(*days, strict=True)
    assert list(starts) == sorted(starts) and list(ends) == sorted(ends, reverse=True)


def test_the_tropics_never_shed_and_early_species_lead():
    assert year(12.0).min() == 1.0 and year(-20.0).min() == 1.0
    birch, oak = year(50.0, -8.0), year(50.0, 7.0)
    assert (birch[90:180] >= oak[90:180]).all() and (birch - oak).max() > 0.5
