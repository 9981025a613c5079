"""The lens against its transfer function, and its default against diffraction."""

from __future__ import annotations

import math

import numpy as np
import pytest

from scenegen.foundation.rng import stream
from scenegen_render.sensor.lens import blurred


def _stripes(cycles_per_px: float, size: int = 64) -> np.ndarray:
    return np.cos(2.0 * np.pi * cycles_per_px * np.arange(size)).astype(np.float32)


def _diffraction(share_of_cutoff: float) -> float:
    """Modulation transfer of a circular aperture, incoherent light (Goodman, Introduction to Fourier Optics, 6.4)."""
    x = share_of_cutoff
    return 2.0 / math.pi * (math.acos(x) - x * math.sqrt(1.0 - x * x))


@pytest.mark.parametrize("turned", [False, True])
@pytest.mark.parametrize("cycles_per_px", [0.5, 0.25, 0.125])
@pytest.mark.parametrize("mtf", [1.0, 0.485, 0.36, 0.05])
def test_stripes_lose_what_the_transfer_function_says(mtf: float, cycles_per_px: float, turned: bool) -> None:
    stripes = np.tile(50.0 + _stripes(cycles_per_px), (64, 1)).astype(np.float32)
    image = np.ascontiguousarray(stripes.T) if turned else stripes
    found = blurred(image, mtf)
    left = (found - 50.0)[2:-2, 2:-2] / (image - 50.0)[2:-2, 2:-2].max()
    expected = 1.0 - (1.0 - mtf) / 2.0 * (1.0 - math.cos(2.0 * math.pi * cycles_per_px))
    assert np.abs(left).max() == pytest.approx(expected, abs=1e-5)


def test_a_diffraction_limited_lens_is_right_at_half_nyquist_too() -> None:
    """f/1.0, 10 um, 12 um pixels: cut-off 100 cycles/mm, Nyquist 41.67."""
    at_nyquist, at_half = _diffraction(0.4167), _diffraction(0.2083)
    assert at_nyquist == pytest.approx(0.4853, abs=1e-3)
    kernel_at_half = 1.0 - (1.0 - at_nyquist) / 2.0
    assert kernel_at_half == pytest.approx(at_half, abs=0.01)


def test_flat_scenes_and_sums_are_kept() -> None:
    flat = np.full((5, 7), 47.25, np.float32)
    np.testing.assert_array_equal(blurred(flat, 0.36), flat)
    image = stream(3, "lens").uniform(20.0, 80.0, (40, 50)).astype(np.float32)
    inner = np.pad(image[3:-3, 3:-3], 3)
    assert float(blurred(inner, 0.36).sum()) == pytest.approx(float(inner.sum()), rel=1e-6)


def test_a_perfect_lens_changes_nothing() -> None:
    image = stream(4, "lens").uniform(20.0, 80.0, (8, 9)).astype(np.float32)
    np.testing.assert_array_equal(blurred(image, 1.0), image)
