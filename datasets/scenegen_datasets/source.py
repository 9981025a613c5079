"""Where a loader finds rows and clip facts: a finished dataset, or the receipts of one that still grows."""

from __future__ import annotations

import json
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from scenegen.foundation import canonical
from scenegen.foundation.errors import DatasetError, InputError
from scenegen_datasets.clip import ClipRecord
from scenegen_datasets.clip_lines import ClipLines
from scenegen_datasets.description import MAX_BYTES, description_of
from scenegen_datasets.documents import CLIP
from scenegen_datasets.index import ROW, Rows, first_rows, open_index, rows_of
from scenegen_datasets.receipt import read_receipt, receipt_paths
from scenegen_datasets.remote import Files, Root, files_at, plain_root
from scenegen_datasets.shape import misshapen
from scenegen_datasets.store import CLIPS, DATASET, INDEX, LOCK, finished


@dataclass(frozen=True, eq=False)
class Source:
    """Rows of all frames in plan order, and the facts of every clip.

    Attributes
    ----------
    rows : structured array (frames,)
        `scenegen_datasets.index.ROW`.
    layers : tuple of str
        Layers that are stored.
    lines : sequence of bytes
        One JSON line per clip, in plan order.
    starts : int64 (clips,)
        First row of each clip.
    heads : structured array (clips,)
        The rows at `starts`, in memory: what is common to a clip is found without touching the index.
    content_id : str
        Of a finished dataset; empty while it grows.
    """

    rows: Rows
    layers: tuple[str, ...]
    lines: Sequence[bytes]
    starts: NDArray[np.int64]
    heads: Rows
    content_id: str = ""

    def facts(self, clip: int) -> Mapping[str, Any]:
        """Facts of the clip at this position.

        Raises
        ------
        DatasetError
            If its line is not the record of a clip.
        """
        facts: dict[str, Any] = canonical.parse(self.lines[clip], CLIPS)
        wrong = misshapen(facts, CLIP)
        if wrong:
            raise DatasetError(f"{CLIPS}: line {clip + 1} is not a clip ({wrong}); run `scenegen verify`")
        return facts

    def record(self, clip: int) -> ClipRecord:
        """The same facts as what a clip was made with.

        Raises
        ------
        DatasetError
            As `facts`, or if no clip can have such a record.
        """
        known = ClipRecord.__dataclass_fields__.keys()
        try:
            return ClipRecord.from_dict({k: v for k, v in self.facts(clip).items() if k in known})
        except (KeyError, TypeError, ValueError) as error:
            raise DatasetError(
                f"{CLIPS}: line {clip + 1} is not a clip ({type(error).__name__}: {error}); run `scenegen verify`"
            ) from None


def open_source(root: Root, allow_partial: bool, files: Files | None = None) -> Source:
    """Open a dataset for reading.

    Parameters
    ----------
    root : Path or str
        A directory or a URL.
    allow_partial : bool
        Take what is there of a dataset in a directory that still grows.
    files : Files, optional
        Its files, if they were found already.

    Raises
    ------
    InputError
        If there is no dataset, or it still grows and `allow_partial` is false.
    DatasetError
        If what describes it is damaged.
    """
    place = plain_root(root)
    files = files or files_at(place)
    if files.holds(DATASET):
        return _finished(files)
    if not files.holds(LOCK):
        raise InputError(f"no dataset at {files.where} (it has neither {DATASET} nor {LOCK})")
    if not isinstance(place, Path):
        raise InputError(
            f"{place} is not whole yet (it has no {DATASET}); wait for `scenegen push` to finish"
        )
    if not allow_partial:
        raise InputError(
            f"{place} is not finished; finish it with the same render command, or pass allow_partial=True"
        )
    return _growing(place)


def _finished(files: Files) -> Source:
    description = description_of(files.read(DATASET, MAX_BYTES), f"{files.where}/{DATASET}")
    sums, frames = description["sums"], description["counts"]["frames"]
    index = files.kept(INDEX, sums[INDEX])
    rows = open_index(index, frames)
    lines = ClipLines.of(files.kept(CLIPS, sums[CLIPS]), sums[CLIPS], description["counts"]["clips"])
    starts, heads = first_rows(index, frames, len(lines))
    layers = tuple(layer["name"] for layer in description["layers"])
    return Source(rows, layers, lines, starts, heads, description["content_id"])


def _growing(root: Path) -> Source:
    done = finished(root)
    receipts = [read_receipt(root, path) for path in receipt_paths(root)]
    receipts = sorted((r for r in receipts if r.clip.job.name in done), key=lambda r: r.clip.job)
    parts = [rows_of(r) for r in receipts]
    rows = np.concatenate(parts) if parts else np.zeros(0, ROW)
    starts = np.cumsum([0, *map(len, parts)], dtype=np.int64)[:-1]
    lines = [json.dumps(r.clip.to_dict()).encode() for r in receipts]
    return Source(rows, receipts[0].layers if receipts else (), lines, starts, rows[starts])
