"""Statistics are extremes, counts and values that really occur: the same on every machine."""

from __future__ import annotations

from types import ModuleType

import numpy as np

from scenegen_datasets.statistics import FRAME_STATISTICS, clip_statistics, frame_statistics, sample


def test_a_frame_by_hand() -> None:
    counts = np.array([[7, 9], [300, 12]], np.uint16)
    depth = np.array([[np.inf, 4.0], [2.5, 10.0]], np.float32)
    temperature = np.array([[0.0, 290.0], [301.25, 280.0]], np.float32)
    assert frame_statistics(counts, depth, temperature, saturated=3) == {
        "counts_min": 7,
        "counts_max": 300,
        "saturated": 3,
        "sky_pixels": 1,
        "depth_min_m": 2.5,
        "depth_median_m": 4.0,
        "temperature_min_K": 280.0,
        "temperature_max_K": 301.25,
    }
    assert tuple(frame_statistics(counts, depth, temperature, 0)) == FRAME_STATISTICS


def test_nothing_but_sky_has_no_distances() -> None:
    sky = np.full((3, 3), np.inf, np.float32)
    told = frame_statistics(np.zeros((3, 3), np.uint16), sky, np.zeros((3, 3), np.float32), 0)
    assert told["sky_pixels"] == 9
    assert [told[k] for k in FRAME_STATISTICS[4:]] == [None] * 4
    empty = np.zeros(0, np.float32)
    clip = clip_statistics([told], empty, empty)
    assert set(clip["depth_m"].values()) == set(clip["temperature_K"].values()) == {None}


def test_quantiles_are_values_that_occur() -> None:
    values = np.float32([1.0, 2.0, 4.0, 8.0])
    row = frame_statistics(np.ones((2, 2), np.uint16), values.reshape(2, 2), values.reshape(2, 2), 1)
    told = clip_statistics([row, row], values, values)
    assert set(told["depth_m"].values()) <= {1.0, 2.0, 4.0, 8.0}
    assert (told["depth_m"]["p01"], told["depth_m"]["p99"]) == (1.0, 8.0)
    assert (told["saturated"], told["sky_pixels"], told["counts_max"]) == (2, 0, 1)


def test_the_sample_is_regular_and_without_sky(fakes: ModuleType) -> None:
    layer = np.arange(1, 200 * 300 + 1, dtype=np.float32).reshape(200, 300)
    np.testing.assert_array_equal(sample(layer), layer[::3, ::3].ravel())
    layer[:100] = np.inf
    assert np.isfinite(sample(layer)).all() and sample(layer).size == layer[102::3, ::3].size
    small = np.ones((12, 16), np.float32)
    assert sample(small).size == small.size
