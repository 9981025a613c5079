"""Mutual information of two quantities from samples [bit]."""

from __future__ import annotations

import math

import numpy as np
from jaxtyping import Float64, Int64

from scenegen_datasets.audits.regressors import quantile_edges

BINS = 32
"""Of equal population, for each quantity: 5 bit are the most one of them can tell."""

TURNS = 4
"""How often pictures are exchanged to see what unrelated ones would tell."""

Values = Float64[np.ndarray, "samples"]


def mutual_information(a: Values, b: Values, given: Values | None = None, bands: int = 8) -> float:
    """Information one quantity holds about another, with the bias of finite samples taken off.

    Parameters
    ----------
    a, b : float64 (samples,)
    given : float64 (samples,), optional
        Known anyway: the information is averaged over `bands` bands of it of equal population.
    bands : int

    Notes
    -----
    Plug-in estimate over quantile bins, less the Miller-Madow bias (Miller, 1955): the occupied cells less the occupied
    rows and columns, over ``2 N ln 2``. Neighbouring pixels are not independent, so a little of the bias stays.
    """
    if given is None:
        return _information(_binned(a, BINS), _binned(b, BINS))
    band = _binned(given, bands)
    parts = [np.flatnonzero(band == k) for k in range(bands)]
    told = [len(part) * mutual_information(a[part], b[part]) for part in parts if len(part) > BINS]
    return float(sum(told) / len(a))


def unrelated_information(
    a: Values, b: Values, picture: Int64[np.ndarray, "samples"], given: Values | None = None
) -> float:
    """What `a` seems to tell of `b` if it is taken from other pictures: the floor below which nothing is said.

    Parameters
    ----------
    a, b, given : float64 (samples,)
        As in `mutual_information`.
    picture : int64 (samples,)
        Number of the picture of each sample, rising from 0 without a gap.

    Notes
    -----
    Shuffling single samples would find next to nothing, since the bias of independent ones is taken off. Pixels of one
    picture are not independent: two pictures as a whole agree or differ by chance, and few pictures do so the more.
    Exchanging whole pictures keeps that, and nothing else. The mean over `TURNS` exchanges.
    """
    first = np.flatnonzero(np.diff(picture, prepend=-1))
    size = np.diff(first, append=len(picture))
    place = np.arange(len(picture)) - first[picture]
    told = []
    for turn in range(TURNS):
        by = 1 + int((len(first) - 1) * (turn + 0.5) / TURNS)
        other = (picture + by) % len(first)
        told.append(mutual_information(a[first[other] + place % size[other]], b, given))
    return float(np.mean(told))


def _information(a: Int64[np.ndarray, "samples"], b: Int64[np.ndarray, "samples"]) -> float:
    joint = np.bincount(a * BINS + b, minlength=BINS * BINS).reshape(BINS, BINS)
    total = joint.sum()
    rows, columns = joint.sum(axis=1), joint.sum(axis=0)
    expected = rows[:, None] * (columns / total)
    some = joint > 0
    found = float(np.sum(joint[some] * np.log2(joint[some] / expected[some])) / total)
    excess = np.count_nonzero(some) - np.count_nonzero(rows) - np.count_nonzero(columns) + 1
    return max(found - float(excess) / (2.0 * float(total) * math.log(2.0)), 0.0)


def _binned(values: Values, bins: int) -> Int64[np.ndarray, "samples"]:
    return np.searchsorted(quantile_edges(values, bins), values, side="right").astype(np.int64)
