"""Where a loader finds rows and clip facts: a finished dataset, or the receipts of one that still grows."""

from __future__ import annotations

import hashlib
import json
from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np

from scenegen.foundation.errors import DatasetError, InputError
from scenegen_datasets.description import read_description
from scenegen_datasets.index import ROW, Rows, open_index, rows_of
from scenegen_datasets.receipt import read_receipt, receipt_paths
from scenegen_datasets.seal import read_bounded
from scenegen_datasets.store import CLIPS, DATASET, INDEX, LOCK, finished

_MAX_CLIPS_BYTES = 1 << 30


@dataclass(frozen=True, eq=False)
class Source:
    """Rows of all frames in plan order, and the facts of every clip.

    Attributes
    ----------
    rows : structured array (frames,)
        `scenegen_datasets.index.ROW`.
    layers : tuple of str
        Layers that are stored.
    lines : list of bytes
        One JSON line per clip, in plan order.
    starts : int64 (clips,)
        First row of each clip.
    """

    rows: Rows
    layers: tuple[str, ...]
    lines: list[bytes]
    starts: np.ndarray

    def facts(self, clip: int) -> Mapping[str, Any]:
        """Facts of the clip at this position."""
        facts: dict[str, Any] = json.loads(self.lines[clip])
        return facts


def open_source(root: Path, allow_partial: bool) -> Source:
    """Open a dataset for reading.

    Raises
    ------
    InputError
        If there is no dataset, or it still grows and `allow_partial` is false.
    DatasetError
        If what describes it is damaged.
    """
    if (root / DATASET).is_file():
        return _finished(root)
    if not (root / LOCK).is_file():
        raise InputError(f"no dataset at {root} (it has neither {DATASET} nor {LOCK})")
    if not allow_partial:
        raise InputError(
            f"{root} is not finished; finish it with the same render command, or pass allow_partial=True"
        )
    return _growing(root)


def _finished(root: Path) -> Source:
    description = read_description(root / DATASET)
    counts = description["counts"]
    rows = open_index(root / INDEX, counts["frames"])
    clips = read_bounded(root / CLIPS, _MAX_CLIPS_BYTES)
    if hashlib.sha256(clips).hexdigest() != description["sums"][CLIPS]:
        raise DatasetError(f"{root / CLIPS}: damaged; run `scenegen verify`")
    layers = tuple(layer["name"] for layer in description["layers"])
    return _source(rows, layers, clips.splitlines(), str(root / INDEX))


def _growing(root: Path) -> Source:
    done = finished(root)
    receipts = [read_receipt(root, path) for path in receipt_paths(root)]
    receipts = sorted((r for r in receipts if r.clip.job.name in done), key=lambda r: r.clip.job)
    rows = np.concatenate([rows_of(r) for r in receipts]) if receipts else np.zeros(0, ROW)
    lines = [json.dumps(r.clip.to_dict()).encode() for r in receipts]
    return _source(rows, receipts[0].layers if receipts else (), lines, "receipts")


def _source(rows: Rows, layers: tuple[str, ...], lines: list[bytes], where: str) -> Source:
    """Find the clips by jumping from first row to first row: touches one page a clip, not the whole index."""
    starts = np.zeros(len(lines), np.int64)
    at = 0
    for k in range(len(lines)):
        starts[k] = at
        at += max(int(rows["frames"][at]), 1) if at < len(rows) else 1
    if at != len(rows):
        raise DatasetError(f"{where}: holds other frames than {CLIPS} says; run `scenegen verify`")
    return Source(rows, layers, lines, starts)
