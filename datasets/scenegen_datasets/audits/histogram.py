"""Distributions as they enter results and charts: counts between edges, and the quantiles people ask for."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from jaxtyping import Real

Values = Real[np.ndarray, "values"]


@dataclass(frozen=True)
class Histogram:
    """A distribution.

    Attributes
    ----------
    edges : tuple of float
        One more than `counts`, rising.
    counts : tuple of int
        Values between two edges; the last bin is closed at both ends.
    """

    edges: tuple[float, ...]
    counts: tuple[int, ...]

    @classmethod
    def of(cls, values: Values, edges: Sequence[float]) -> Histogram:
        """Count values between edges; what lies outside falls into the outer bins."""
        inside = np.clip(np.asarray(values, np.float64), edges[0], edges[-1])
        counts, _ = np.histogram(inside, np.asarray(edges, np.float64))
        return cls(tuple(map(float, edges)), tuple(map(int, counts)))


@dataclass(frozen=True)
class Spread:
    """Quantiles of a quantity; None where there is no value.

    Attributes
    ----------
    low, median, high, top : float or None
        5 %, 50 %, 95 % and 99 %.
    count : int
    """

    low: float | None
    median: float | None
    high: float | None
    top: float | None
    count: int

    @classmethod
    def of(cls, values: Values) -> Spread:
        """Describe values."""
        if not len(values):
            return cls(None, None, None, None, 0)
        low, median, high, top = np.quantile(np.asarray(values, np.float64), (0.05, 0.5, 0.95, 0.99))
        return cls(float(low), float(median), float(high), float(top), len(values))


def even_edges(low: float, high: float, bins: int) -> tuple[float, ...]:
    """Edges of bins of one width; around a single value a width of its own."""
    if not high > low:
        half = max(abs(low) * 0.05, 0.5)
        low, high = low - half, high + half
    return tuple(map(float, np.linspace(low, high, bins + 1)))


def log_edges(low: float, high: float, bins: int) -> tuple[float, ...]:
    """Edges whose ratio is constant; both ends above 0."""
    if not high > low:
        low, high = low / 1.5, high * 1.5
    return tuple(map(float, np.geomspace(low, high, bins + 1)))
