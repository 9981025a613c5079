"""Which strata an image, or some of its pixels, belong to: distance, light, map, class."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Mapping
from typing import Any

import numpy as np
from jaxtyping import Float32, Integer

from scenegen.classes import CLASSES
from scenegen_trainers.metrics import ValidDepth

DAY_FROM_DEG = 0.0
"""Sun elevation from which on it is day; below, there is no direct sun on anything."""

Depth = Float32[np.ndarray, "rows columns"]


def strata_of(truth_m: Depth, sample: Mapping[str, Any], valid: ValidDepth) -> Iterator[tuple[str, Depth]]:
    """Every stratum that an image has a part of, and the truth of that part.

    Parameters
    ----------
    truth_m : float32 (rows, columns)
        Planar depth [m].
    sample : mapping
        Of the dataset; with ``semantic`` where classes are stored.
    valid : ValidDepth
        Its range is cut into distances.

    Yields
    ------
    str
        Family and name, such as ``light night``.
    float32 (rows, columns)
        Truth, with the pixels of other strata moved out of every valid range.
    """
    for low, high in valid.ranges:
        inside = (truth_m >= low) & (truth_m < high)
        yield f"distance {low:g} to {high:g} m", _only(inside, truth_m)
    day = sample["facts"]["sun_elevation_deg"] > DAY_FROM_DEG
    yield f"light {'day' if day else 'night'}", truth_m
    yield f"map {sample['map']}", truth_m
    if "semantic" in sample:
        yield from _by_class(truth_m, sample["semantic"])


def of_family(names: Iterable[str], first: str) -> dict[str, str]:
    """Strata of a family: whole names and their own words."""
    return {name: name.removeprefix(f"{first} ") for name in names if name.startswith(f"{first} ")}


def _by_class(truth_m: Depth, ids: Integer[np.ndarray, "rows columns"]) -> Iterator[tuple[str, Depth]]:
    for number in np.unique(ids).tolist():
        name = CLASSES[number].name if number < len(CLASSES) else f"{number}"
        yield f"class {name}", _only(ids == number, truth_m)


def _only(pixels: Any, truth_m: Depth) -> Depth:
    return np.where(pixels, truth_m, np.float32(np.inf))
