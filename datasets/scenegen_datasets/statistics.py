"""Numbers that describe a frame and a clip. Only extremes, counts and quantiles: no sum whose order could matter."""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from typing import Any

import numpy as np
from numpy.typing import NDArray

FRAME_STATISTICS = (
    "counts_min",
    "counts_max",
    "saturated",
    "sky_pixels",
    "depth_min_m",
    "depth_median_m",
    "temperature_min_K",
    "temperature_max_K",
)
"""Names of the statistics of a frame; None where there is nothing but sky."""

_QUANTILES = {"p01": 0.01, "p25": 0.25, "p50": 0.5, "p75": 0.75, "p99": 0.99}
_SAMPLES_A_SIDE = 64

Numbers = dict[str, float | int | None]


def frame_statistics(
    counts: NDArray[np.uint16], depth: NDArray[np.float32], temperature: NDArray[np.float32], saturated: int
) -> Numbers:
    """Describe one frame; extremes over all pixels, the median over a regular sample of them."""
    solid = np.isfinite(depth)
    distances, temperatures = depth[solid], temperature[solid]
    return {
        "counts_min": int(counts.min()),
        "counts_max": int(counts.max()),
        "saturated": saturated,
        "sky_pixels": int(solid.size - distances.size),
        "depth_min_m": _number(distances.min()) if distances.size else None,
        "depth_median_m": _quantile(sample(depth), 0.5),
        "temperature_min_K": _number(temperatures.min()) if temperatures.size else None,
        "temperature_max_K": _number(temperatures.max()) if temperatures.size else None,
    }


def sample(layer: NDArray[np.float32]) -> NDArray[np.float32]:
    """Positive finite values on a regular grid of at least 64x64 pixels (all of them in a smaller image)."""
    step = max(1, min(layer.shape) // _SAMPLES_A_SIDE)
    values = layer[::step, ::step].ravel()
    return values[np.isfinite(values) & (values > 0)]


def clip_statistics(
    frames: Iterable[Mapping[str, Any]], depth: NDArray[np.float32], temperature: NDArray[np.float32]
) -> dict[str, Any]:
    """Describe a clip from its frames' statistics and the joined samples of depth and temperature."""
    rows = list(frames)
    return {
        "counts_min": min(r["counts_min"] for r in rows),
        "counts_max": max(r["counts_max"] for r in rows),
        "saturated": sum(r["saturated"] for r in rows),
        "sky_pixels": sum(r["sky_pixels"] for r in rows),
        "depth_m": {name: _quantile(depth, q) for name, q in _QUANTILES.items()},
        "temperature_K": {name: _quantile(temperature, q) for name, q in _QUANTILES.items()},
    }


def _quantile(values: NDArray[np.float32], q: float) -> float | None:
    return _number(np.quantile(values.astype(np.float64), q, method="nearest")) if values.size else None


def _number(value: Any) -> float:
    """Four decimals: enough for people, and no tail of float32 digits."""
    return round(float(value), 4)
