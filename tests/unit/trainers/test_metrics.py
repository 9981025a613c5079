"""Depth scores against numbers worked out by hand."""

from __future__ import annotations

import math

import numpy as np
import pytest

from scenegen.foundation.errors import InputError
from scenegen_trainers.metrics import DepthMeter, DepthScores, ValidDepth


def image(*values: float) -> np.ndarray:
    return np.array([values], np.float64)


def scores_of(estimate: np.ndarray, truth: np.ndarray, valid: ValidDepth | None = None):
    meter = DepthMeter(valid)
    meter.add(estimate, truth)
    return meter.report()


def test_perfect_estimate() -> None:
    truth = np.random.default_rng(0).uniform(1, 99, (8, 9)).astype(np.float32)
    report = scores_of(truth, truth)
    assert report.pooled == report.per_image == DepthScores(0.0, 0.0, (1.0, 1.0, 1.0))
    assert (report.images, report.pixels, report.missing, report.skipped) == (1, 72, 0, 0)


def test_four_pixels_by_hand() -> None:
    truth = image(10.0, 20.0, 40.0, 80.0)
    estimate = image(12.0, 14.0, 76.0, 80.0)
    pooled = scores_of(estimate, truth).pooled
    assert pooled.rmse_m == pytest.approx(math.sqrt((4 + 36 + 36**2 + 0) / 4), rel=1e-14)
    assert pooled.rel == pytest.approx((0.2 + 0.3 + 0.9 + 0.0) / 4, rel=1e-14)
    # ratios 1.2, 1.4286, 1.9, 1 against 1.25, 1.5625, 1.953125
    assert pooled.delta == (0.5, 0.75, 1.0)


def test_thresholds_are_strict_and_symmetric() -> None:
    report = scores_of(image(12.5, 8.0, 12.499, 8.001), image(10.0, 10.0, 10.0, 10.0))
    assert report.pooled.delta[0] == 0.5  # 1.25 itself fails, in both directions


def test_constant_factor_is_forgiven_only_when_aligned() -> None:
    truth = np.random.default_rng(1).uniform(1, 99, (20, 20))
    report = scores_of(truth * 3.0, truth)
    assert report.pooled.rel == pytest.approx(2.0, rel=1e-12)
    assert report.pooled.delta == (0.0, 0.0, 0.0)
    assert report.pooled_aligned.rmse_m == pytest.approx(0.0, abs=1e-12)
    assert report.pooled_aligned.delta == (1.0, 1.0, 1.0)


def test_pooled_and_per_image_differ_by_their_weights() -> None:
    meter = DepthMeter()
    first = meter.add(np.full((1, 3), 11.0), np.full((1, 3), 10.0))
    second = meter.add(np.full((1, 1), 14.0), np.full((1, 1), 10.0))
    report = meter.report()
    assert first is not None
    assert second is not None
    assert (first.rmse_m, first.rel, first.delta) == (1.0, pytest.approx(0.1), (1.0, 1.0, 1.0))
    assert (second.rmse_m, second.rel, second.delta) == (4.0, pytest.approx(0.4), (0.0, 1.0, 1.0))
    assert report.pooled.rmse_m == pytest.approx(math.sqrt((3 * 1 + 16) / 4))
    assert report.per_image.rmse_m == pytest.approx(2.5)
    assert report.pooled.rel == pytest.approx((3 * 0.1 + 0.4) / 4)
    assert report.per_image.rel == pytest.approx(0.25)
    assert (report.pooled.delta[0], report.per_image.delta[0]) == (0.75, 0.5)
    assert (report.images, report.pixels) == (2, 4)


def test_only_valid_depth_is_judged() -> None:
    truth = image(0.49, 0.5, 99.99, 100.0, math.inf)
    report = scores_of(image(50.0, 1.5, 99.99, 3.0, 7.0), truth)
    assert report.pixels == 2
    assert report.pooled.rmse_m == pytest.approx(math.sqrt(0.5))
    assert report.pooled.rel == pytest.approx(1.0)


def test_sky_can_be_judged_at_the_cap() -> None:
    truth = image(math.inf, 150.0, 50.0, 0.1)
    valid = ValidDepth(beyond_as_furthest=True)
    report = scores_of(image(4000.0, 90.0, 50.0, 9.0), truth, valid)
    assert report.pixels == 3
    assert report.pooled.rmse_m == pytest.approx(math.sqrt(100.0 / 3))
    assert scores_of(image(math.inf, 100.0), image(math.inf, 200.0), valid).missing == 1


@pytest.mark.parametrize("hole", [math.nan, math.inf, -math.inf])
def test_a_hole_is_scored_as_the_worst_answer(hole: float) -> None:
    report = scores_of(image(hole, hole, 30.0), image(10.0, 90.0, 30.0))
    assert report.missing == 2
    assert report.pooled.rmse_m == pytest.approx(math.sqrt((90.0**2 + 89.5**2) / 3))
    assert report.pooled.rel == pytest.approx((9.0 + 89.5 / 90.0) / 3)
    assert report.pooled.delta == (1 / 3, 1 / 3, 1 / 3)
    assert math.isfinite(report.pooled_aligned.rmse_m)


def test_an_image_of_holes_is_still_counted() -> None:
    report = scores_of(np.full((2, 2), math.nan), np.full((2, 2), 10.0))
    assert (report.images, report.missing) == (1, 4)
    assert report.pooled_aligned == report.pooled


def test_negative_and_zero_estimates_fail_every_threshold() -> None:
    report = scores_of(image(-10.0, 0.0), image(10.0, 10.0))
    assert report.pooled.delta == (0.0, 0.0, 0.0)
    assert report.pooled.rmse_m == pytest.approx(math.sqrt((400 + 100) / 2))
    assert report.missing == 0


def test_ranges() -> None:
    report = scores_of(image(11.0, 19.0, 25.0), image(10.0, 20.0, 25.0))
    assert [(low, high) for low, high, _ in report.by_range] == [(0.5, 20.0), (20.0, 50.0), (50.0, 100.0)]
    near, middle, far = (scores for _, _, scores in report.by_range)
    assert near is not None
    assert near.rmse_m == pytest.approx(1.0)
    assert middle is not None
    assert middle.rmse_m == pytest.approx(math.sqrt(0.5))
    assert far is None


def test_ranges_hold_every_valid_pixel() -> None:
    truth = np.random.default_rng(2).uniform(0.1, 130.0, (30, 30))
    for valid in (ValidDepth(), ValidDepth(beyond_as_furthest=True), ValidDepth(1.0, 15.0)):
        meter = DepthMeter(valid)
        meter.add(truth, truth)
        assert sum(s.count for s in meter._ranges) == meter.report().pixels


def test_streaming_equals_one_big_image() -> None:
    rng = np.random.default_rng(3)
    truth, estimate = rng.uniform(1, 120, (2, 40, 30)), rng.uniform(1, 120, (2, 40, 30))
    meter = DepthMeter()
    for pair in zip(estimate, truth, strict=True):
        meter.add(*pair)
    whole = scores_of(estimate.reshape(80, 30), truth.reshape(80, 30)).pooled
    parts = meter.report().pooled
    assert parts.rmse_m == pytest.approx(whole.rmse_m, rel=1e-13)
    assert parts.rel == pytest.approx(whole.rel, rel=1e-13)
    assert parts.delta == pytest.approx(whole.delta, rel=1e-13)


def test_float32_and_float64_truth_agree() -> None:
    truth = np.array([[1.5, 99.5, 50.25]], np.float32)
    estimate = np.array([[2.0, 90.0, 49.0]], np.float32)
    assert scores_of(estimate, truth) == scores_of(estimate.astype(np.float64), truth.astype(np.float64))


def test_bad_input_is_named() -> None:
    meter = DepthMeter()
    with pytest.raises(InputError, match=r"\(2, 3\) pixels, the truth \(3, 2\)"):
        meter.add(np.ones((2, 3)), np.ones((3, 2)))
    with pytest.raises(InputError, match="true depth is NaN"):
        meter.add(np.ones((1, 1)), np.full((1, 1), math.nan))
    assert meter.add(np.ones((1, 2)), np.full((1, 2), math.inf)) is None
    with pytest.raises(InputError, match=r"no pixel with a true depth of 0\.5 to 100 m in 1 images"):
        meter.report()


@pytest.mark.parametrize(
    "bounds", [(0.0, 10.0), (-1.0, 10.0), (10.0, 10.0), (5.0, math.inf), (math.nan, 5.0)]
)
def test_a_range_that_is_none_is_refused(bounds: tuple[float, float]) -> None:
    with pytest.raises(InputError, match="no range"):
        ValidDepth(*bounds)
