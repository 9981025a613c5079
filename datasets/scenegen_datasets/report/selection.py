"""Which moments and flights a report shows: every map, from night to day, the same for the same dataset."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np

from scenegen.foundation.rng import stream
from scenegen_datasets.audits.steps import SEED
from scenegen_datasets.layers import check_layers
from scenegen_datasets.loader import PairDataset
from scenegen_datasets.pictures.shot import Shot, shot_of
from scenegen_datasets.scale import scale_of
from scenegen_datasets.source import Source

MOST_ROWS, MOST_FLIGHTS, MOST_FRAMES = 12, 8, 32
"""Moments, animated flights and frames of each."""

_SHOWN = ("thermal", "depth", "flow", "semantic", "instance")
_MOST_FACTS = 4000


@dataclass(frozen=True, eq=False)
class Selection:
    """What is shown.

    Attributes
    ----------
    moments : tuple of Shot
        One of each chosen clip.
    flights : tuple of (Shot, ...)
        Consecutive frames.
    """

    moments: tuple[Shot, ...]
    flights: tuple[tuple[Shot, ...], ...]


def select(root: Path, source: Source) -> Selection:
    """Choose and read what a report shows."""
    pairs = PairDataset(root, layers=_layers(source), allow_partial=True)
    first = source.rows[source.starts]
    counts = first["frames"].astype(np.int64) - 1
    before = np.cumsum(counts) - counts
    facts = _facts(source, counts)
    rng = stream(SEED, "report", "moments")
    moments = [
        shot_of(pairs[int(before[k] + rng.integers(counts[k]))], scale_of(facts[k]))
        for k in spread_out(facts, MOST_ROWS)
    ]
    flights = [
        tuple(
            shot_of(pairs[int(before[k]) + i], scale_of(facts[k]))
            for i in range(min(int(counts[k]), MOST_FRAMES))
        )
        for k in spread_out(facts, MOST_FLIGHTS)
    ]
    return Selection(tuple(moments), tuple(flights))


def spread_out(facts: Mapping[int, Mapping[str, Any]], most: int) -> list[int]:
    """Choose clips: of every map the same number, evenly from the lowest sun to the highest; map by map.

    Parameters
    ----------
    facts : mapping of int to mapping
        Lines of ``clips.jsonl`` by position.
    most : int
        How many at most, unless there are more maps.
    """
    by_map: dict[str, list[int]] = {}
    for k, clip in facts.items():
        by_map.setdefault(str(clip["job"]["map"]), []).append(k)
    each = max(1, most // max(len(by_map), 1))
    chosen = []
    for _, clips in sorted(by_map.items()):
        ordered = sorted(clips, key=lambda k: (float(facts[k]["sun_elevation_deg"]), k))
        chosen += _evenly(ordered, each)
    return chosen


def _evenly(items: Sequence[int], count: int) -> list[int]:
    if len(items) <= count:
        return list(items)
    return [items[int((k + 0.5) * len(items) / count)] for k in range(count)]


def _facts(source: Source, counts: np.ndarray) -> dict[int, Mapping[str, Any]]:
    """Of the clips that hold a pair; of very many, a lot of them."""
    usable = np.flatnonzero(counts > 0)
    if len(usable) > _MOST_FACTS:
        usable = np.sort(stream(SEED, "report", "clips").permutation(usable)[:_MOST_FACTS])
    return {int(k): source.facts(int(k)) for k in usable}


def _layers(source: Source) -> tuple[str, ...]:
    return check_layers(name for name in _SHOWN if name in source.layers)
