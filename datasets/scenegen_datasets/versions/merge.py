"""Several datasets become one: shards linked or copied, receipts with new places, one index over all."""

from __future__ import annotations

import errno
import hashlib
import os
from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from pathlib import Path

import yaml

from scenegen.foundation import canonical
from scenegen.foundation.atomic import AtomicFile, make_directories, sync_directory, write_atomic
from scenegen.foundation.errors import DatasetError, InputError
from scenegen.foundation.lock import DirectoryLock
from scenegen_datasets.finish import finish
from scenegen_datasets.info import DatasetInfo, info
from scenegen_datasets.pictures.preview import write_preview
from scenegen_datasets.receipt import Receipt, read_receipt
from scenegen_datasets.render_job import dataset_name
from scenegen_datasets.store import DATASET, LOCK, RECIPE, check_output, clean, read_lock
from scenegen_datasets.versions.parts import Part, Piece, check_parts, merged_lock, pieces_of

_CHUNK = 1 << 22
_CANNOT_LINK = {errno.EXDEV, errno.EPERM, errno.EMLINK, errno.ENOTSUP, errno.EOPNOTSUPP, errno.ENOSYS}
"""Another device, a file system without links, a file with too many of them."""

Told = Callable[[int, int], None]


@dataclass(frozen=True)
class Merged:
    """What a merge came to.

    Attributes
    ----------
    info : DatasetInfo
    linked, copied : int
        Shards, of this run; both 0 if it was all there.
    """

    info: DatasetInfo
    linked: int
    copied: int


def merge(out: Path, roots: Sequence[Path], *, copy: bool = False, progress: Told | None = None) -> Merged:
    """Make one dataset of several; it has the same content whatever their order, and keeps their splits.

    May be killed at any moment: ``dataset.json`` is written last, and the same call goes on where it stopped.

    Parameters
    ----------
    out : Path
        Directory of the whole; new, empty, or begun by a merge of the same datasets.
    roots : sequence of Path
        At least two finished datasets.
    copy : bool
        Copy shards even where a hard link would do. A linked shard is one file in both datasets: neither takes more
        space, and damage to one is damage to both.
    progress : callable, optional
        Hears of (clips done, clips in all).

    Raises
    ------
    InputError
        If the parts cannot become one (see `check_parts`), or `out` cannot be used.
    DatasetError
        If a part is damaged.
    NoSpaceError
        If the device is full.
    """
    parts = [Part.read(root) for root in roots]
    check_parts(parts)
    _refuse_nesting(out, roots)
    lock = merged_lock(parts, dataset_name(out))
    _prepare(out)
    with DirectoryLock(out):
        _begin(out, lock)
        clean(out)
        if (out / DATASET).exists():
            return Merged(info(out), 0, 0)
        pieces = pieces_of(parts)
        linked = 0
        for done, piece in enumerate(pieces, 1):
            linked += _add(out, piece, copy)
            if progress:
                progress(done, len(pieces))
        write_preview(out)
        found = finish(out, [piece.job for piece in pieces])
    return Merged(found, linked, len(pieces) - linked)


def _refuse_nesting(out: Path, roots: Sequence[Path]) -> None:
    whole = out.resolve()
    for root in roots:
        part = root.resolve()
        if whole == part or part in whole.parents or whole in part.parents:
            raise InputError(f"{out} and {root} lie in one another; merge into a directory of its own")


def _prepare(out: Path) -> None:
    if not (out / LOCK).exists() and out.is_dir():
        check_output(out)
    try:
        out.mkdir(parents=True, exist_ok=True)
    except OSError as error:
        raise InputError(
            f"{out}: cannot be made: {error.strerror or error}; choose another directory"
        ) from None


def _begin(out: Path, lock: dict[str, object]) -> None:
    """Write down what is merged, or see that the same was begun here before."""
    check_output(out)
    if (out / LOCK).exists():
        there = read_lock(out)
        if canonical.canonical(there) != canonical.canonical(lock):
            kind = "another merge" if there.get("parts") else "a dataset"
            raise InputError(f"{out} holds {kind} already; choose another directory")
        return
    parts = lock["parts"]
    assert isinstance(parts, list)
    asked = [{key: part[key] for key in ("name", "version", "recipe_id", "content_id")} for part in parts]
    head = "# What was merged; the recipe of each part is in recipe.lock.json.\n"
    write_atomic(out / RECIPE, (head + yaml.safe_dump({"merged": asked}, sort_keys=True)).encode())
    write_atomic(out / LOCK, canonical.pretty(lock))


def _add(out: Path, piece: Piece, copy: bool) -> bool:
    """Put one clip into the whole, shard first; returns whether its shard is a link."""
    receipt = read_receipt(piece.part.root, piece.clip.job.receipt)
    if receipt.clip != piece.clip:
        raise DatasetError(
            f"{piece.part.root}: receipt and clips.jsonl disagree on {piece.job.name}; verify it"
        )
    linked = _place(piece.part.root / piece.job.shard, out, piece.job.shard, receipt, copy)
    folder = make_directories(out, str(Path(piece.job.receipt).parent))
    moved = replace(receipt, clip=replace(receipt.clip, job=piece.job))
    write_atomic(folder / Path(piece.job.receipt).name, moved.to_bytes())
    return linked


def _place(source: Path, out: Path, shard: str, receipt: Receipt, copy: bool) -> bool:
    """Link or copy a shard; one that is there already and is the same file is left alone."""
    if source.is_symlink() or not source.is_file() or source.stat().st_size != receipt.size:
        raise DatasetError(
            f"{source}: missing or not as long as its receipt says; run 'scenegen verify' on its dataset"
        )
    target = make_directories(out, str(Path(shard).parent)) / Path(shard).name
    if target.exists() and not copy and target.samefile(source):
        return True
    target.unlink(missing_ok=True)
    if not copy:
        try:
            os.link(source, target, follow_symlinks=False)
            sync_directory(target.parent)
            return True
        except OSError as error:
            if error.errno not in _CANNOT_LINK:
                raise InputError(f"cannot write {target}: {error.strerror or error}") from error
    _copy(source, target, receipt)
    return False


def _copy(source: Path, target: Path, receipt: Receipt) -> None:
    found = hashlib.sha256()
    with source.open("rb") as stream, AtomicFile(target) as file:
        while block := stream.read(_CHUNK):
            found.update(block)
            file.write(block)
        if found.hexdigest() != receipt.sha256:
            raise DatasetError(f"{source}: damaged; run 'scenegen verify' on its dataset")
        file.commit()
