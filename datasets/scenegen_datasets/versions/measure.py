"""What the pictures of a dataset hold on the whole: shares of classes, quantiles of depth and temperature."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from scenegen_datasets.loader import PairDataset
from scenegen_datasets.source import open_source
from scenegen_datasets.statistics import sample

QUANTILES = (0.01, 0.25, 0.5, 0.75, 0.99)
"""Of what is measured in pixels."""


@dataclass(frozen=True)
class Measures:
    """Statistics over pixels of some pairs, evenly spread over the whole dataset.

    Attributes
    ----------
    pairs : int
        Looked at.
    classes : mapping of int to float
        Share of all pixels by class id; empty if the dataset has no classes.
    depth_m, temperature_K : tuple of float
        `QUANTILES` over pixels that are not sky; empty if there are none.
    """

    pairs: int
    classes: Mapping[int, float]
    depth_m: tuple[float, ...]
    temperature_K: tuple[float, ...]


def measure(root: Path, pairs: int) -> Measures:
    """Look at up to `pairs` pairs of a finished dataset; the same pairs every time.

    Raises
    ------
    CorruptFrameError
        If one of them is damaged.
    """
    stored = open_source(root, allow_partial=False).layers
    layers = [name for name in ("depth", "temperature", "semantic") if name in stored]
    dataset = PairDataset(root, layers=layers)
    which = np.unique(np.linspace(0, len(dataset) - 1, min(pairs, len(dataset))).round().astype(np.int64))
    counts: NDArray[np.int64] = np.zeros(256, np.int64)
    pools: dict[str, list[NDArray[np.float32]]] = {"depth": [], "temperature": []}
    for k in which:
        seen = dataset[int(k)]
        if "semantic" in seen:
            counts += np.bincount(seen["semantic"].ravel(), minlength=256)
        for name in pools.keys() & seen.keys():
            pools[name].append(sample(seen[name]))
    total = max(int(counts.sum()), 1)
    return Measures(
        pairs=len(which),
        classes={int(k): float(counts[k]) / total for k in np.flatnonzero(counts)},
        depth_m=_quantiles(pools["depth"]),
        temperature_K=_quantiles(pools["temperature"]),
    )


def _quantiles(pool: list[NDArray[np.float32]]) -> tuple[float, ...]:
    values = np.concatenate(pool) if pool else np.zeros(0, np.float32)
    if not values.size:
        return ()
    found = np.quantile(values.astype(np.float64), QUANTILES, method="nearest")
    return tuple(round(float(value), 4) for value in found)
