"""Movers' temperatures: closed form of the sun over all headings, and what driving does."""

from __future__ import annotations

import numpy as np
import pytest

from scenegen.heat.moving import mean_over_headings


@pytest.mark.parametrize("elevation_deg", [2.0, 25.0, 60.0, 89.0])
def test_the_mean_over_headings_is_the_integral(elevation_deg: float) -> None:
    heading = 2.0 * np.pi * (np.arange(20_000) + 0.5) / 20_000
    h = np.radians(elevation_deg)
    sun = np.array([np.cos(h), 0.0, np.sin(h)])
    for tilt in np.radians([0.0, 10.0, 45.0, 90.0, 120.0, 180.0]):
        flat = np.sin(tilt) * np.cos(heading), np.sin(tilt) * np.sin(heading)
        normal = np.stack([*flat, np.full_like(heading, np.cos(tilt))])
        expected = np.maximum(sun @ normal, 0.0).mean()
        got = mean_over_headings(np.array([np.cos(tilt)]), np.array([np.sin(h)]))
        np.testing.assert_allclose(got, expected, atol=2e-6)


def test_there_is_no_sun_below_the_horizon() -> None:
    assert (mean_over_headings(np.array([0.0, 1.0]), np.array([-0.1, 0.0])) == 0.0).all()
