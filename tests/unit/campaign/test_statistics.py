"""Intervals and tests against scipy's own, published values and their meaning."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from scipy.stats import binom, binomtest

from scenegen_trainers.campaign.statistics import compare, mcnemar, wilson

COUNTS = st.integers(1, 2000).flatmap(lambda n: st.tuples(st.integers(0, n), st.just(n)))


@given(COUNTS, st.sampled_from([0.8, 0.95, 0.99]))
def test_wilson_is_scipys(counts: tuple[int, int], confidence: float) -> None:
    count, of = counts
    theirs = binomtest(count, of).proportion_ci(confidence, method="wilson")
    ours = wilson(count, of, confidence)
    assert (ours.low, ours.high) == pytest.approx((theirs.low, theirs.high), abs=1e-12)
    assert 0.0 <= ours.low <= ours.share <= ours.high <= 1.0


@pytest.mark.parametrize(
    ("count", "of", "low", "high"),
    [(205, 400, 0.464, 0.561), (127, 400, 0.274, 0.365), (4, 400, 0.004, 0.025), (2, 400, 0.001, 0.018)],
)
def test_intervals_of_the_flights_the_paper_reports(count: int, of: int, low: float, high: float) -> None:
    rate = wilson(count, of)
    assert (rate.low, rate.high) == pytest.approx((low, high), abs=5e-4)


def test_wilson_covers_what_it_promises() -> None:
    """Exact coverage, summed over all outcomes, averages 95 % over rates; p +- 1.96 s does not."""
    of = 50
    limits = [wilson(k, of) for k in range(of + 1)]
    rates = np.linspace(0.01, 0.99, 99)
    covered = [
        sum(binom.pmf(k, of, p) for k, limit in enumerate(limits) if limit.low <= p <= limit.high)
        for p in rates
    ]
    assert np.mean(covered) == pytest.approx(0.95, abs=0.006)
    assert min(covered) > 0.83


def test_nothing_flown_says_nothing() -> None:
    rate = wilson(0, 0)
    assert (rate.low, rate.high) == (0.0, 1.0)
    assert np.isnan(rate.share)


@pytest.mark.parametrize(("count", "of", "confidence"), [(-1, 3, 0.95), (4, 3, 0.95), (1, 3, 1.0)])
def test_impossible_counts_are_refused(count: int, of: int, confidence: float) -> None:
    with pytest.raises(ValueError):
        wilson(count, of, confidence)


@given(st.integers(0, 300), st.integers(0, 300))
def test_mcnemar_is_the_sign_test(first_only: int, second_only: int) -> None:
    theirs = binomtest(first_only, first_only + second_only).pvalue if first_only + second_only else 1.0
    assert mcnemar(first_only, second_only) == pytest.approx(theirs, rel=1e-9)


def test_mcnemar_by_hand() -> None:
    assert mcnemar(0, 5) == pytest.approx(2 / 32)  # five heads, or five tails
    assert mcnemar(1, 5) == pytest.approx(2 * (1 + 6) / 64)
    assert mcnemar(7, 7) == 1.0
    with pytest.raises(ValueError):
        mcnemar(-1, 2)


def test_pairs_are_counted_mission_by_mission() -> None:
    first = [True, True, True, False, False, False, False]
    second = [True, False, False, True, False, False, False]
    paired = compare(first, second)
    assert (paired.both, paired.first_only, paired.second_only, paired.neither) == (1, 2, 1, 3)
    assert paired.p == 1.0
    swapped = compare(second, first)
    assert (swapped.first_only, swapped.second_only, swapped.p) == (1, 2, paired.p)
    with pytest.raises(ValueError):
        compare(first, second[:3])
