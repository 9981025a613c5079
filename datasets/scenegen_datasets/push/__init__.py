"""Copy a finished dataset to a URL so that no reader ever takes a half of it for the whole.

Everything goes first, ``MANIFEST.sha256`` and ``dataset.json`` go last; where an older state lies, its ``dataset.json``
is taken away before anything else changes. What is there already, with the right size and content, is not sent again,
so the same command resumes a push that was interrupted.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from scenegen.foundation import canonical
from scenegen.foundation.errors import DatasetError, InputError
from scenegen_datasets.description import read_description
from scenegen_datasets.index import ROW
from scenegen_datasets.inside import sha256_inside, size_inside
from scenegen_datasets.manifest import file_sha256, read_manifest
from scenegen_datasets.push.target import Item, Target, There, side_by_side, target_at
from scenegen_datasets.store import DATASET, FOLDERS, LOCK, MANIFEST, read_lock

__all__ = ["Pushed", "push"]

_LAST = (MANIFEST, DATASET)
_BATCH_FILES, _BATCH_BYTES = 64, 1 << 30
_MAX_LOCK_BYTES = 64 << 20
_MOST_BYTES = 1 << 30
"""No file but the index and the shards is larger, whose sizes are told: a sparse one may claim any."""

Told = Callable[[int, int], None]


@dataclass(frozen=True)
class Pushed:
    """What a push did.

    Attributes
    ----------
    url : str
    files, bytes : int
        Of the dataset.
    sent, sent_bytes : int
        Of them, sent by this run.
    removed : int
        Files of an older state that do not belong any more.
    """

    url: str
    files: int
    bytes: int
    sent: int
    sent_bytes: int
    removed: int


def push(
    root: Path,
    url: str,
    *,
    options: Mapping[str, Any] | None = None,
    private: bool = False,
    quick: bool = False,
    told: Told | None = None,
    target: Target | None = None,
) -> Pushed:
    """Copy a dataset, and check what arrived.

    Parameters
    ----------
    root : Path
        A finished dataset; every file is checked against the manifest before it is sent.
    url : str
        ``hf://datasets/USER/NAME``, or anything fsspec can write: ``s3://bucket/name``, ``file:///mnt/name``, ...
    options : mapping, optional
        What fsspec's file system wants to know.
    private : bool
        Of a repository on the Hub that is made by this.
    quick : bool
        Compare sizes only, where the place keeps no hashes and files would have to be read back.
    told : callable, optional
        Called with (bytes done, bytes in all).
    target : Target, optional
        Where to, if it is not to be found by the URL.

    Raises
    ------
    InputError
        If there is no finished dataset, the place holds another one, or cannot be written.
    DatasetError
        If a file is damaged, here or after it was sent.
    """
    items = _items(root)
    there = target or target_at(url, options or {}, private)
    _refuse_another(root, there)
    found = there.listing()
    size = sum(item.size for item in items)
    missing = _missing(there, items, found, quick)
    alien = _alien(items, found)
    if missing or alien:
        there.remove([name for name in (DATASET, *alien) if name in found])
        missing = [item for item in missing if item.path != DATASET] + [items[-1]]
        done = size - sum(item.size for item in missing)
        for batch in _batches(missing):
            for item in batch:
                if sha256_inside(root, item.path, item.size) != item.sha256:
                    raise DatasetError(f"{root / item.path}: damaged; run `scenegen repair`, then push again")
            there.send(root, batch)
            done += sum(item.size for item in batch)
            if told:
                told(done, size)
        wrong = _missing(there, missing, there.listing(), quick)
        if wrong:
            there.remove([DATASET])
            raise DatasetError(f"{url}: {wrong[0].path} did not arrive as it was sent; push again")
    return Pushed(url, len(items), size, len(missing), sum(item.size for item in missing), len(alien))


def _missing(there: Target, items: Sequence[Item], found: Mapping[str, There], quick: bool) -> list[Item]:
    """Those that are not there, or not as they should be."""
    same = side_by_side(there.lanes, lambda item: there.same(item, found.get(item.path), quick), items)
    return [item for item, is_there in zip(items, same, strict=True) if not is_there]


def _items(root: Path) -> list[Item]:
    """All files of a dataset: first what says whose the place is, at the end what makes it whole."""
    read_lock(root)
    if not (root / DATASET).is_file():
        raise InputError(f"{root} is not finished; finish it with the same render command, then push it")
    counts = read_description(root / DATASET)["counts"]
    sums = read_manifest(root / MANIFEST)
    if sums.get(DATASET) != file_sha256(root / DATASET):
        raise DatasetError(f"{root / MANIFEST}: does not belong to {DATASET}; run `scenegen verify`")
    sums[MANIFEST] = file_sha256(root / MANIFEST)
    names = [LOCK, *sorted(set(sums) - {LOCK, *_LAST}), *_LAST]
    try:
        items = [Item(name, size_inside(root, name), sums[name], root / name) for name in names]
    except DatasetError as error:
        raise DatasetError(f"{root}/{error}; run `scenegen repair`") from None
    held = sum(item.size for item in items if item.path.startswith("shards/"))
    largest = max((item.size for item in items if not item.path.startswith("shards/")), default=0)
    if held != counts["shard_bytes"] or largest > max(_MOST_BYTES, counts["frames"] * ROW.itemsize + 4096):
        raise DatasetError(f"{root}: its files have other sizes than {DATASET} says; run `scenegen verify`")
    return items


def _refuse_another(root: Path, there: Target) -> None:
    told = there.read(LOCK, _MAX_LOCK_BYTES)
    if told is None:
        strangers = sorted(set(there.listing()) - {".gitattributes", "README.md"})
        if strangers:
            raise InputError(
                f"{there.where} holds something else ({strangers[0]}); push to a place that is empty"
            )
        return
    other = canonical.parse(told, f"{there.where}/{LOCK}")
    ours = read_lock(root)
    if not isinstance(other, dict) or other.get("recipe_id") != ours["recipe_id"]:
        raise InputError(f"{there.where} holds another dataset; push to a place of its own")


def _alien(items: Iterable[Item], found: Iterable[str]) -> list[str]:
    """Files below our folders that do not belong: a reader that takes all shards would take them too."""
    ours = {item.path for item in items}
    return sorted(path for path in found if path not in ours and path.partition("/")[0] in FOLDERS)


def _batches(items: Sequence[Item]) -> Iterable[list[Item]]:
    """Pieces of work of bounded size; whose the place is comes first, what makes the dataset whole last, each alone."""
    batch: list[Item] = []
    for item in items:
        alone = item.path in (LOCK, *_LAST)
        if batch and (alone or len(batch) >= _BATCH_FILES or sum(i.size for i in batch) >= _BATCH_BYTES):
            yield batch
            batch = []
        if alone:
            yield [item]
        else:
            batch.append(item)
    if batch:
        yield batch
