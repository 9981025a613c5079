"""Intervals of pooled scores by drawing whole clips with replacement.

Frames of one flight resemble each other; drawing frames would count them as independent and make intervals too narrow.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from jaxtyping import Float64

from scenegen_trainers.metrics import DepthScores

LEVEL = 0.95


@dataclass(frozen=True)
class Judged:
    """One image's scores and how much it weighs.

    Attributes
    ----------
    index : int
        Of the sample in its split.
    group : str
        Images of one group are drawn together: a clip.
    pixels : int
        Valid ones.
    scores : DepthScores
    """

    index: int
    group: str
    pixels: int
    scores: DepthScores


def intervals(
    images: Sequence[Judged], rng: np.random.Generator, draws: int = 1000
) -> dict[str, tuple[float, float]]:
    """Percentile intervals at 95 % of the pooled scores (Efron and Tibshirani, 1993).

    Parameters
    ----------
    images : sequence of Judged
        At least one.
    rng : numpy.random.Generator
    draws : int

    Returns
    -------
    dict of str to (float, float)
        Of ``rmse_m``, ``rel``, ``delta1``, ``delta2``, ``delta3``.
    """
    groups = sorted({image.group for image in images})
    sums = np.zeros((len(groups), 6))
    for image in images:
        s = image.scores
        means = np.array([s.rmse_m**2, s.rel, *s.delta, 1.0])
        sums[groups.index(image.group)] += image.pixels * means
    picked = rng.integers(len(groups), size=(draws, len(groups)))
    pooled = sums[picked].sum(axis=1)
    means = pooled[:, :5] / pooled[:, 5:]
    means[:, 0] = np.sqrt(means[:, 0])
    return dict(zip(NAMES, map(_span, means.T), strict=True))


NAMES = ("rmse_m", "rel", "delta1", "delta2", "delta3")
"""Names of the five scores in reports."""


def named(scores: DepthScores) -> dict[str, float]:
    """Scores by name."""
    return dict(zip(NAMES, (scores.rmse_m, scores.rel, *scores.delta), strict=True))


def _span(values: Float64[np.ndarray, "draws"]) -> tuple[float, float]:
    edge = 0.5 * (1.0 - LEVEL)
    low, high = np.quantile(values, (edge, 1.0 - edge))
    return float(low), float(high)
