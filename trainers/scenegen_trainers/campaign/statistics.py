"""What counts of flights say, and what they do not: intervals of rates, and tests between pilots on the same missions.

Both treat flights as independent trials. Flights of one world share its streets, so the intervals of a campaign with
few worlds are somewhat too narrow; a paired test is not touched by that, because both pilots flew the same worlds.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from scipy.special import bdtr, ndtri

CONFIDENCE = 0.95
"""Of all intervals, unless a caller says otherwise."""


@dataclass(frozen=True)
class Rate:
    """A share of trials with its interval.

    Attributes
    ----------
    count, of : int
        Successes and trials.
    low, high : float
        Wilson score interval; 0 and 1 without any trial.
    """

    count: int
    of: int
    low: float
    high: float

    @property
    def share(self) -> float:
        """``count / of``; NaN without any trial."""
        return self.count / self.of if self.of else float("nan")


def wilson(count: int, of: int, confidence: float = CONFIDENCE) -> Rate:
    """Rate with Wilson's score interval.

    Unlike ``p ± 1.96 sqrt(p q / n)`` it stays inside 0..1 and keeps its promise for rates near the ends, which is
    where good pilots are.

    Parameters
    ----------
    count, of : int
        ``0 <= count <= of``.
    confidence : float
        Coverage of the two-sided interval, between 0 and 1.

    Raises
    ------
    ValueError
        If the counts or the confidence are impossible.

    References
    ----------
    E. B. Wilson, JASA 22 (158), 1927, p. 209, doi 10.1080/01621459.1927.10502953; L. D. Brown, T. T. Cai and
    A. DasGupta, Statistical Science 16 (2), 2001, doi 10.1214/ss/1009213286, equation 4.
    """
    if not 0 <= count <= of:
        raise ValueError(f"{count} of {of} is no share")
    if not 0.0 < confidence < 1.0:
        raise ValueError(f"a confidence of {confidence} is not between 0 and 1")
    if of == 0:
        return Rate(0, 0, 0.0, 1.0)
    z2, p = float(ndtri(0.5 + confidence / 2)) ** 2, count / of
    middle = (p + z2 / (2 * of)) / (1 + z2 / of)
    half = (z2 * p * (1 - p) / of + z2**2 / (4 * of**2)) ** 0.5 / (1 + z2 / of)
    # At the ends one limit is the rate itself, exactly; rounding would leave 1e-17 of it.
    low = 0.0 if count == 0 else middle - half
    high = 1.0 if count == of else middle + half
    return Rate(count, of, low, high)


@dataclass(frozen=True)
class Paired:
    """Two pilots over the same missions.

    Attributes
    ----------
    both, first_only, second_only, neither : int
        Missions by who of the two collided.
    p : float
        Two-sided p-value of McNemar's exact test.
    """

    both: int
    first_only: int
    second_only: int
    neither: int
    p: float


def mcnemar(first_only: int, second_only: int) -> float:
    """Two-sided p-value of McNemar's exact test: are the discordant pairs a fair coin?

    Missions on which both pilots fared alike say nothing about the difference, and do not enter.

    Parameters
    ----------
    first_only, second_only : int
        Missions on which only the one or only the other collided.

    References
    ----------
    Q. McNemar, Psychometrika 12, 1947, doi 10.1007/BF02295996; the exact form is the sign test.
    """
    if first_only < 0 or second_only < 0:
        raise ValueError(f"{first_only} and {second_only} are no counts")
    less, all_ = min(first_only, second_only), first_only + second_only
    return min(1.0, 2.0 * float(bdtr(less, all_, 0.5)))


def compare(first: Sequence[bool], second: Sequence[bool]) -> Paired:
    """Compare collisions of two pilots, mission by mission.

    Parameters
    ----------
    first, second : sequence of bool
        Whether each pilot collided; in the same order of missions.

    Raises
    ------
    ValueError
        If they are not of one length.
    """
    a, b = np.asarray(first, bool), np.asarray(second, bool)
    if a.shape != b.shape:
        raise ValueError(f"{len(a)} and {len(b)} flights are no pairs")
    only_a, only_b = int((a & ~b).sum()), int((b & ~a).sum())
    return Paired(int((a & b).sum()), only_a, only_b, int((~a & ~b).sum()), mcnemar(only_a, only_b))
