"""Which strata an image, or some of its pixels, belong to: map, day or night, class."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from typing import Any

import numpy as np
from jaxtyping import Float32, Integer

from scenegen.classes import CLASSES

DAY_FROM_DEG = 0.0
"""Sun elevation from which on it is day; below, there is no direct sun on anything."""


def strata_of(sample: Mapping[str, Any]) -> tuple[str, ...]:
    """Strata of a whole image."""
    day = sample["facts"]["sun_elevation_deg"] > DAY_FROM_DEG
    return f"map {sample['map']}", "day" if day else "night"


def by_class(
    truth_m: Float32[np.ndarray, "rows columns"], ids: Integer[np.ndarray, "rows columns"]
) -> Iterator[tuple[str, Float32[np.ndarray, "rows columns"]]]:
    """Truth of one class at a time: the other pixels are moved out of every valid range."""
    for number in np.unique(ids).tolist():
        name = CLASSES[number].name if number < len(CLASSES) else f"class {number}"
        yield f"class {name}", np.where(ids == number, truth_m, np.float32(np.inf))
