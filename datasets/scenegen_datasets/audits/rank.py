"""Rank correlation: whether two quantities rise together, whatever the curve."""

from __future__ import annotations

import numpy as np
from jaxtyping import Float64, Real


def spearman(a: Real[np.ndarray, "values"], b: Real[np.ndarray, "values"]) -> float | None:
    """Spearman's coefficient, ties by their mean rank; None where one of the two does not vary."""
    if len(a) < 3:
        return None
    x, y = _ranks(a), _ranks(b)
    x, y = x - x.mean(), y - y.mean()
    scale = float(np.sqrt((x @ x) * (y @ y)))
    return float(x @ y) / scale if scale > 0.0 else None


def _ranks(values: Real[np.ndarray, "values"]) -> Float64[np.ndarray, "values"]:
    _, inverse, counts = np.unique(values, return_inverse=True, return_counts=True)
    last = np.cumsum(counts)
    return np.asarray((last - 0.5 * (counts - 1))[inverse], np.float64)
