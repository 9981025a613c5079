"""Intervals of pooled scores by drawing whole clips with replacement (Efron and Tibshirani, 1993).

Frames of one flight resemble each other; drawing frames would count them as independent and make intervals too narrow.
"""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np
from jaxtyping import Float64

from scenegen_trainers.evaluation.scores import NAMES, SMALLER_IS_BETTER
from scenegen_trainers.metrics import DepthScores

LEVEL = 0.95
DRAWS = 1000

Interval = tuple[float, float]
ClipSums = Mapping[str, Float64[np.ndarray, "6"]]
"""By clip: sums over its pixels of squared error, relative error and the three threshold hits, and their number."""


def sums_of(scores: DepthScores, pixels: int) -> Float64[np.ndarray, "6"]:
    """What an image adds to the sums of its clip."""
    return pixels * np.array([scores.rmse_m**2, scores.rel, *scores.delta, 1.0])


def intervals(clips: ClipSums, rng: np.random.Generator, draws: int = DRAWS) -> dict[str, Interval]:
    """Percentile intervals at 95 % of the pooled scores.

    Parameters
    ----------
    clips : ClipSums
        At least one.
    rng : numpy.random.Generator
    draws : int

    Returns
    -------
    dict of str to (float, float)
        By name of the score.
    """
    (drawn,) = _drawn([clips], rng, draws)
    return {name: _span(values) for name, values in drawn.items()}


def margins(
    clips: ClipSums, rival: ClipSums, rng: np.random.Generator, draws: int = DRAWS
) -> dict[str, Interval]:
    """Percentile intervals at 95 % of by how much the pooled scores are better than a rival's on the same pixels.

    Both are pooled over the same clips in every draw: what makes a clip hard makes it hard for both.

    Parameters
    ----------
    clips, rival : ClipSums
        Of the same clips.
    rng : numpy.random.Generator
    draws : int

    Returns
    -------
    dict of str to (float, float)
        By name of the score; above 0 it is better, whether a small or a large score is good.
    """
    ours, theirs = _drawn([clips, rival], rng, draws)
    signs = {name: -1.0 if SMALLER_IS_BETTER[name] else 1.0 for name in NAMES}
    return {name: _span(sign * (ours[name] - theirs[name])) for name, sign in signs.items()}


def _drawn(
    contenders: list[ClipSums], rng: np.random.Generator, draws: int
) -> list[dict[str, Float64[np.ndarray, "draws"]]]:
    """Pooled scores of every draw; all contenders are drawn the same clips."""
    clips = sorted(contenders[0])
    sums = np.stack([[contender[clip] for clip in clips] for contender in contenders], axis=1)
    picked = rng.integers(len(clips), size=(draws, len(clips)))
    pooled = np.stack([sums[some].sum(axis=0) for some in picked])
    means = pooled[..., :5] / pooled[..., 5:]
    means[..., 0] = np.sqrt(means[..., 0])
    return [dict(zip(NAMES, means[:, k].T, strict=True)) for k in range(len(contenders))]


def _span(values: Float64[np.ndarray, "draws"]) -> Interval:
    edge = 0.5 * (1.0 - LEVEL)
    low, high = np.quantile(values, (edge, 1.0 - edge))
    return float(low), float(high)
