"""Fresnel reflectance with one effective index against the spectral average over 8-14 um."""

from __future__ import annotations

import numpy as np
import pytest

from scenegen.materials.material import ComplexIndex
from scenegen.radiometry.fresnel import fresnel_reflectance


@pytest.mark.parametrize(
    ("index", "angles", "emissivity", "error"),
    [
        (ComplexIndex(1.2388, 0.1419), (0, 30, 50, 60, 70, 80, 85),
         (0.9852, 0.9842, 0.9725, 0.9471, 0.8739, 0.6591, 0.4215), 0.001),
        (ComplexIndex(1.3064, 0.8157), (0, 60, 80), (0.8773, 0.7820, 0.4789), 0.012),
    ],
    ids=["water", "glass"],
)  # fmt: skip
def test_effective_indices_reproduce_the_spectral_average(index, angles, emissivity, error):
    ours = 1.0 - fresnel_reflectance(np.cos(np.radians(angles)), index)
    np.testing.assert_allclose(ours, emissivity, atol=error)


def test_water_hemispheric_emissivity():
    mu = np.sqrt((np.arange(20_000) + 0.5) / 20_000)
    eps = 1.0 - fresnel_reflectance(mu, ComplexIndex(1.2388, 0.1419)).mean()
    assert eps == pytest.approx(0.9398, abs=1e-3)


def test_limits_of_fresnel():
    index = ComplexIndex(1.5, 0.0)
    assert fresnel_reflectance(np.array([1.0]), index)[0] == pytest.approx((0.5 / 2.5) ** 2)
    assert fresnel_reflectance(np.array([0.0]), index)[0] == pytest.approx(1.0)
    brewster = np.cos(np.arctan(1.5))
    perpendicular = ((1.5**2 - 1) / (1.5**2 + 1)) ** 2
    assert fresnel_reflectance(np.array([brewster]), index)[0] == pytest.approx(0.5 * perpendicular)
