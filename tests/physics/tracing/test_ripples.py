"""What a mirror of rough water shows, against quadrature over Gaussian slopes and against Cox and Munk."""

from __future__ import annotations

import math

import numpy as np
import pytest
from scipy.integrate import quad
from scipy.stats import norm

from scenegen_render import backend
from scenegen_render.trace.ripples import normal, slope_per_axis, visible_slope


def _mean_visible_slope(sigma: float, elevation: float) -> float:
    """Mean slope towards the eye, facets weighted by the area they show it."""

    def seen(slope: float) -> float:
        return max(math.sin(elevation) + slope * math.cos(elevation), 0.0) * float(
            norm.pdf(slope, scale=sigma)
        )

    reach = 8.0 * sigma
    part, _ = quad(lambda s: s * seen(s), -reach, reach, limit=200)
    whole, _ = quad(seen, -reach, reach, limit=200)
    return part / whole


@pytest.mark.parametrize("wind_mps", [1.0, 5.0, 12.0])
@pytest.mark.parametrize("elevation_deg", [1.0, 5.0, 15.0, 40.0, 80.0])
def test_mean_visible_slope(wind_mps: float, elevation_deg: float) -> None:
    mi, _ = backend.modules()
    sigma = slope_per_axis(wind_mps)
    found = float(visible_slope(mi.Float(sigma), mi.Float(math.sin(math.radians(elevation_deg))))[0])
    assert found == pytest.approx(_mean_visible_slope(sigma, math.radians(elevation_deg)), abs=0.13 * sigma)


def test_total_slope_of_cox_and_munk() -> None:
    assert 2.0 * slope_per_axis(10.0) ** 2 == pytest.approx(0.0542)


def test_glass_keeps_its_normal_and_far_water_its_mean() -> None:
    mi, dr = backend.modules()
    up, unit = mi.Vector3f(0.0, 0.0, 1.0), dr.normalize(mi.Vector3f(0.8, 0.0, -0.2))
    place, seed = mi.Vector3f(3.0, 4.0, 0.0), dr.opaque(mi.UInt, 5)
    smooth = normal(mi.Float(0.0), up, unit, place, mi.Float(0.01), seed)
    np.testing.assert_allclose(np.asarray(smooth).ravel(), [0.0, 0.0, 1.0], atol=1e-6)
    far = np.asarray(normal(mi.Float(0.16), up, unit, place, mi.Float(50.0), seed)).ravel()
    assert far[0] < 0.0  # leans towards the eye, which looks along +x
    assert far[1] == pytest.approx(0.0, abs=1e-6)


def test_near_slopes_have_the_measured_spread() -> None:
    mi, _ = backend.modules()
    rng = np.random.default_rng(3)
    at = rng.uniform(-200.0, 200.0, (40_000, 3)).astype(np.float32)
    place = mi.Vector3f(*(backend.upload(np.ascontiguousarray(at[:, k])) for k in range(3)))
    sigma = slope_per_axis(6.0)
    facet = normal(
        mi.Float(sigma), mi.Vector3f(0, 0, 1), mi.Vector3f(0, 0, -1), place, mi.Float(0.05), mi.UInt(9)
    )
    n = np.asarray(facet).reshape(3, -1)
    slopes = -n[:2] / n[2]
    np.testing.assert_allclose(slopes.std(axis=1), sigma, rtol=0.05)
    np.testing.assert_allclose(slopes.mean(axis=1), 0.0, atol=0.03 * sigma)
