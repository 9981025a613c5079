"""Several datasets become one: shards linked or copied, receipts with new places, one index over all."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import yaml

from scenegen.foundation import canonical
from scenegen.foundation.atomic import write_atomic
from scenegen.foundation.errors import DatasetError, InputError
from scenegen.foundation.lock import DirectoryLock
from scenegen_datasets.finish import finish
from scenegen_datasets.info import DatasetInfo, info
from scenegen_datasets.pictures.preview import write_preview
from scenegen_datasets.place import check_room, make_directory
from scenegen_datasets.receipt import read_receipt
from scenegen_datasets.render_job import dataset_name
from scenegen_datasets.store import DATASET, LOCK, RECIPE, check_output, clean, read_lock
from scenegen_datasets.versions.fitting import check_parts
from scenegen_datasets.versions.numbers import offset_of, seed_of
from scenegen_datasets.versions.parts import Part, Piece, merged_lock, pieces_of
from scenegen_datasets.versions.placing import place_clip

Told = Callable[[int, int], None]


@dataclass(frozen=True)
class Merged:
    """What a merge came to.

    Attributes
    ----------
    info : DatasetInfo
    linked, copied : int
        Shards, of this run; both 0 if it was all there.
    offsets : mapping of int to int
        Seeds whose worlds have other numbers than in their own datasets, and what was added to them.
    """

    info: DatasetInfo
    linked: int
    copied: int
    offsets: Mapping[int, int]

    @property
    def new(self) -> bool:
        """Whether this run made it."""
        return self.linked + self.copied > 0


def merge(out: Path, roots: Sequence[Path], *, copy: bool = False, progress: Told | None = None) -> Merged:
    """Make one dataset of several; it has the same content whatever their order, and keeps their splits.

    Where two seeds have worlds of one name, their worlds are numbered anew (`scenegen_datasets.versions.numbers`).

    May be killed at any moment: ``dataset.json`` is written last, and the same call goes on where it stopped.

    Parameters
    ----------
    out : Path
        Directory of the whole; new, empty, or begun by a merge of the same datasets.
    roots : sequence of Path
        At least two finished datasets.
    copy : bool
        Copy shards even where a hard link would do. A linked shard is one file in both datasets: neither takes more
        space, and damage to one is damage to both. Shards of worlds with new numbers are always written anew.
    progress : callable, optional
        Hears of (clips done, clips in all).

    Raises
    ------
    InputError
        If the parts cannot become one (see `check_parts`), or `out` cannot be used.
    DatasetError
        If a part is damaged.
    NoSpaceError
        If the device is full, or shards that have to be copied would not fit.
    """
    parts = [Part.read(root) for root in roots]
    check_parts(parts)
    _refuse_nesting(out, roots)
    lock = merged_lock(parts, dataset_name(out))
    offsets = {seed_of(entry): offset_of(entry) for entry in lock["parts"] if offset_of(entry)}
    _prepare(out)
    if not (out / LOCK).exists():
        check_room(out, out, _copied_bytes(out, parts, offsets, copy), "merge onto the device of the parts")
    with DirectoryLock(out):
        _begin(out, lock)
        clean(out)
        if (out / DATASET).exists():
            return Merged(info(out), 0, 0, offsets)
        pieces = pieces_of(parts)
        linked = 0
        for done, piece in enumerate(pieces, 1):
            linked += _add(out, piece, copy)
            if progress:
                progress(done, len(pieces))
        write_preview(out)
        found = finish(out, [piece.job for piece in pieces])
    return Merged(found, linked, len(pieces) - linked, offsets)


def _refuse_nesting(out: Path, roots: Sequence[Path]) -> None:
    whole = out.resolve()
    for root in roots:
        part = root.resolve()
        if whole == part:
            raise InputError(f"{out} is one of the parts; merge into a directory of its own")
        if part in whole.parents or whole in part.parents:
            raise InputError(f"{out} and {root} lie in one another; merge into a directory of its own")


def _prepare(out: Path) -> None:
    if not (out / LOCK).exists() and out.is_dir():
        check_output(out)
    make_directory(out, "OUT")


def _copied_bytes(out: Path, parts: Sequence[Part], offsets: Mapping[int, int], copy: bool) -> int:
    """Size of the shards that cannot be links."""
    device = out.stat().st_dev
    return sum(
        part.description["counts"]["shard_bytes"]
        for part in parts
        if copy or part.root.stat().st_dev != device or any(origin.seed in offsets for origin in part.origins)
    )


def _begin(out: Path, lock: Mapping[str, Any]) -> None:
    """Write down what is merged, or see that the same was begun here before."""
    check_output(out)
    if (out / LOCK).exists():
        there = read_lock(out)
        if canonical.canonical(there) != canonical.canonical(lock):
            kind = "another merge" if there.get("parts") else "a dataset"
            raise InputError(f"{out} holds {kind} already; choose another directory")
        return
    write_atomic(out / RECIPE, merged_yaml(lock))
    write_atomic(out / LOCK, canonical.pretty(lock))


def merged_yaml(lock: Mapping[str, Any]) -> bytes:
    """``recipe.yaml`` of a merged dataset, which follows from its lock."""
    keys = ("name", "version", "recipe_id", "content_id")
    asked = [{key: part[key] for key in keys} for part in lock["parts"]]
    head = "# What was merged; the recipe of each part is in recipe.lock.json.\n"
    return (head + yaml.safe_dump({"merged": asked}, sort_keys=True)).encode()


def _add(out: Path, piece: Piece, copy: bool) -> bool:
    """Put one clip into the whole; returns whether its shard is a link."""
    receipt = read_receipt(piece.part.root, piece.clip.job.receipt)
    if receipt.clip != piece.clip:
        raise DatasetError(
            f"{piece.part.root}: receipt and clips.jsonl disagree on {piece.clip.job.name}; verify it"
        )
    return place_clip(piece.part.root, receipt, out, piece.job, copy=copy)
