"""Automatic gain control: 14-bit counts or radiance to 8-bit grey, for pictures only. Never part of the data."""

from __future__ import annotations

import numpy as np
from jaxtyping import Real, UInt8, UInt16


def percentile_agc(
    values: Real[np.ndarray, "rows columns"], low_percent: float = 0.5, high_percent: float = 99.5
) -> UInt8[np.ndarray, "rows columns"]:
    """Stretch linearly between two percentiles.

    Parameters
    ----------
    values : (rows, columns)
        Counts, radiance or temperature.
    low_percent, high_percent : float
        Percentiles that become black and white.
    """
    low, high = np.percentile(values, (low_percent, high_percent))
    span = max(float(high - low), 1e-9)
    grey = (values.astype(np.float32) - np.float32(low)) * np.float32(255.0 / span)
    return np.asarray(np.rint(np.clip(grey, 0.0, 255.0)), np.uint8)


def plateau_agc(
    counts: UInt16[np.ndarray, "rows columns"],
    plateau_share: float = 0.02,
    linear_share: float = 0.2,
    max_gain: float = 1.0,
) -> UInt8[np.ndarray, "rows columns"]:
    """Histogram equalisation with clipped bins, as thermal cameras show their video.

    Bins are clipped at a plateau, so that a large flat area (sky, road) does not take all the grey levels; part of a
    linear stretch is mixed in, so that order and rough contrast survive; a slope limit keeps flat scenes from turning
    into noise.

    Parameters
    ----------
    counts : uint16 (rows, columns)
    plateau_share : float
        Largest share of the pixels one bin may count for.
    linear_share : float
        Share of the linear stretch in the mix, 0..1.
    max_gain : float
        Largest number of grey levels per count.
    """
    low, high = int(counts.min()), int(counts.max())
    histogram = np.bincount((counts - low).ravel(), minlength=high - low + 1).astype(np.float64)
    clipped = np.minimum(histogram, max(1.0, plateau_share * counts.size))
    equalised = (np.cumsum(clipped) - 0.5 * clipped) / clipped.sum()
    linear = (np.arange(histogram.size) + 0.5) / histogram.size
    curve = (1.0 - linear_share) * equalised + linear_share * linear
    return np.asarray(_limited(curve, max_gain)[counts - low])


def _limited(curve: Real[np.ndarray, "levels"], max_gain: float) -> UInt8[np.ndarray, "levels"]:
    """Cap the slope of a 0..1 curve at `max_gain` grey levels per count and centre what is left."""
    steps = np.minimum(np.diff(curve * 255.0, prepend=0.0), max_gain)
    grey = np.cumsum(steps)
    return np.asarray(np.rint(np.clip(grey + 0.5 * (255.0 - grey[-1]), 0.0, 255.0)), np.uint8)
