"""What a contender answers to pixels of one true depth: the middle of its answers and their spread, along depth."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from jaxtyping import Float32, Float64

from scenegen_trainers.metrics import ValidDepth

_BINS, _STEPS = 24, 480
_LEAST_SHARE = 1e-4
"""Of all pixels: bins with fewer say nothing."""


@dataclass(frozen=True)
class Trend:
    """Answers by true depth.

    Attributes
    ----------
    truth_m : tuple of float
        Middle of each bin [m].
    low_m, median_m, high_m : tuple of float
        10, 50 and 90 % of the answers there [m].
    """

    truth_m: tuple[float, ...]
    low_m: tuple[float, ...]
    median_m: tuple[float, ...]
    high_m: tuple[float, ...]


class TrendMeter:
    """Counts pixels by true and estimated depth, both on logarithmic scales.

    Parameters
    ----------
    valid : ValidDepth
        Range of both; answers beyond it count at its ends.
    """

    def __init__(self, valid: ValidDepth) -> None:
        ends = valid.nearest_m, valid.furthest_m
        self._truth = np.geomspace(*ends, _BINS + 1)
        self._estimate = np.geomspace(*ends, _STEPS + 1)
        self._counts = np.zeros((_BINS, _STEPS), np.int64)

    def add(
        self, estimate_m: Float32[np.ndarray, "rows columns"], truth_m: Float32[np.ndarray, "rows columns"]
    ) -> None:
        """Count one image; pixels without an answer are left out."""
        low, high = self._truth[0], self._truth[-1]
        known = np.isfinite(estimate_m) & (truth_m >= low) & (truth_m < high)
        row = np.searchsorted(self._truth, truth_m[known], side="right") - 1
        column = np.searchsorted(self._estimate, estimate_m[known], side="right") - 1
        flat = row.clip(0, _BINS - 1) * _STEPS + column.clip(0, _STEPS - 1)
        self._counts += np.bincount(flat, minlength=self._counts.size).reshape(self._counts.shape)

    def trend(self) -> Trend:
        """Of every bin with pixels enough."""
        total = self._counts.sum()
        some = [k for k in range(_BINS) if self._counts[k].sum() > _LEAST_SHARE * total]
        middles = np.sqrt(self._truth[:-1] * self._truth[1:])
        low, median, high = (tuple(self._quantile(k, share) for k in some) for share in (0.1, 0.5, 0.9))
        return Trend(tuple(float(middles[k]) for k in some), low, median, high)

    def _quantile(self, row: int, share: float) -> float:
        """Depth [m] below which that share of a bin's answers lies, evenly spread within its step."""
        below: Float64[np.ndarray, "steps"] = np.concatenate([[0.0], self._counts[row].cumsum()])
        return float(np.exp(np.interp(share * below[-1], below, np.log(self._estimate))))
