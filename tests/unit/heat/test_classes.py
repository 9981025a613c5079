"""Thermal classes: orientation bins and the sorting of sites."""

from __future__ import annotations

import numpy as np
import pytest

from scenegen.heat.classes import DOWN, FIRST_SLOPE, FIRST_WALL, ORIENTATIONS, UP, orientation_bin
from scenegen.heat.outlook import single


def _normal(tilt_deg: float, azimuth_deg: float) -> np.ndarray:
    tilt, azimuth = np.radians(tilt_deg), np.radians(azimuth_deg)
    return np.array(
        [[np.sin(tilt) * np.sin(azimuth), np.sin(tilt) * np.cos(azimuth), np.cos(tilt)]], dtype=np.float32
    )


@pytest.mark.parametrize(
    ("tilt", "azimuth", "expected"),
    [
        (0, 0, UP),
        (10, 123, UP),
        (20, 0, FIRST_SLOPE),
        (30, 90, FIRST_SLOPE + 2),
        (45, 90, FIRST_SLOPE + 10),
        (90, 0, FIRST_WALL),
        (90, 359, FIRST_WALL),
        (90, 90, FIRST_WALL + 2),
        (90, 180, FIRST_WALL + 4),
        (100, 270, FIRST_WALL + 6),
        (180, 0, DOWN),
        (150, 45, DOWN),
    ],
)
def test_orientation_bins(tilt, azimuth, expected):
    assert orientation_bin(_normal(tilt, azimuth))[0] == expected


def test_every_direction_has_a_bin():
    rng = np.random.default_rng(0)
    n = rng.standard_normal((20_000, 3))
    bins = orientation_bin((n / np.linalg.norm(n, axis=1, keepdims=True)).astype(np.float32))
    assert set(bins.tolist()) == set(range(ORIENTATIONS))


def test_fast_halves_are_exact():
    halves = np.arange(0x7C00, dtype=np.uint16).view(np.float16)
    np.testing.assert_array_equal(single(halves), halves.astype(np.float32))
