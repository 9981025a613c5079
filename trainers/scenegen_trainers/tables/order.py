"""Whether an order relation holds in runs that differ in their seeds."""

from __future__ import annotations

import itertools
import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from statistics import fmean, stdev
from typing import Literal

from scipy.stats import t as student

from scenegen_trainers.evaluation.scores import SMALLER_IS_BETTER
from scenegen_trainers.tables.paper import Relation

Verdict = Literal["held", "open", "not held"]

LEVEL = 0.95


@dataclass(frozen=True)
class Found:
    """What runs say about one relation and one score.

    Attributes
    ----------
    claim, score : str
    verdict : "held", "open" or "not held"
        Of the pair of rows it is worst off with: held if the better row's mean is better by more than the spread of
        seeds explains (paired t interval, 95 %), not held if it is worse by more than that, open otherwise.
    margin : float
        Mean by which it is better, in that pair; negative if it is worse.
    half_width : float
        Of the interval of `margin`; infinite for a single seed.
    against : str
        The pair.
    """

    claim: str
    score: str
    verdict: Verdict
    margin: float
    half_width: float
    against: str


def judge(relation: Relation, score: str, runs: Mapping[str, Sequence[float]]) -> Found:
    """Judge one relation.

    Parameters
    ----------
    relation : Relation
    score : str
    runs : mapping of str to sequence of float
        The score of each seed, by row; seeds in the same order in all rows.
    """
    sign = 1.0 if SMALLER_IS_BETTER[score] else -1.0
    found = []
    for better, worse in itertools.product(relation.better, relation.worse):
        margins = [sign * (b - a) for a, b in zip(runs[better], runs[worse], strict=True)]
        margin, half = fmean(margins), half_width(margins)
        verdict: Verdict = "held" if margin > half else "not held" if margin < -half else "open"
        found.append(Found(relation.claim, score, verdict, margin, half, f"{better} against {worse}"))
    return min(found, key=lambda f: (_RANK[f.verdict], f.margin))


def half_width(values: Sequence[float]) -> float:
    """Half of Student's 95 % interval of a mean; infinite for one value."""
    if len(values) < 2:
        return math.inf
    quantile = float(student.ppf(0.5 + 0.5 * LEVEL, len(values) - 1))
    return quantile * stdev(values) / math.sqrt(len(values))


_RANK: Mapping[Verdict, int] = {"not held": 0, "open": 1, "held": 2}
