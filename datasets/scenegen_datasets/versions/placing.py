"""Put a clip of one dataset into another: its shard as it is, or with its world under another number."""

from __future__ import annotations

import errno
import hashlib
import os
import zlib
from collections.abc import Iterator
from dataclasses import replace
from pathlib import Path

from scenegen.foundation.atomic import AtomicFile, make_directories, sync_directory, write_atomic
from scenegen.foundation.canonical import canonical, digest, parse
from scenegen.foundation.errors import DatasetError, InputError
from scenegen_datasets import tar
from scenegen_datasets.index import rows_of
from scenegen_datasets.inside import folder_inside, open_inside, size_inside
from scenegen_datasets.job import ClipJob
from scenegen_datasets.reader import ShardReader
from scenegen_datasets.receipt import FrameEntry, Receipt, Span

_CHUNK = 1 << 22
_CANNOT_LINK = {errno.EXDEV, errno.EPERM, errno.EMLINK, errno.ENOTSUP, errno.EOPNOTSUPP, errno.ENOSYS}
"""Another device, a file system without links, a file with too many of them."""


def place_clip(source: Path, receipt: Receipt, out: Path, job: ClipJob, *, copy: bool) -> bool:
    """Put one clip into `out`, shard first, receipt last; returns whether its shard is a link.

    Where the clip keeps its name, the shard is the same file, or a copy. Under another name it is written anew: every
    member the same bytes, but for the key in those of JSON.

    Parameters
    ----------
    source : Path
        Dataset, or directory laid out like one, that holds the clip.
    receipt : Receipt
        Of the clip there.
    out : Path
    job : ClipJob
        The clip's name and place in `out`.
    copy : bool
        Copy the shard even where a hard link would do.

    Raises
    ------
    DatasetError
        If the shard is missing or damaged.
    NoSpaceError
        If the device is full.
    """
    if _size(source, receipt.clip.job.shard) != receipt.size:
        raise DatasetError(
            f"{source / receipt.clip.job.shard}: missing or not as long as its receipt says; "
            "run 'scenegen verify' on its dataset"
        )
    linked = False
    if job.name == receipt.clip.job.name:
        linked = _link_or_copy(source, out, job.shard, receipt, copy)
        moved = replace(receipt, clip=replace(receipt.clip, job=job))
    else:
        moved = _rename(source, receipt, out, job)
    folder = make_directories(out, str(Path(job.receipt).parent))
    write_atomic(folder / Path(job.receipt).name, moved.to_bytes())
    return linked


def _size(source: Path, shard: str) -> int:
    """Bytes of a plain file, to which no step is a link; -1 if there is none."""
    try:
        return size_inside(source, shard)
    except DatasetError:
        return -1


def _link_or_copy(source: Path, out: Path, shard: str, receipt: Receipt, copy: bool) -> bool:
    """Link or copy a shard; one that is there already and is the same file is left alone."""
    target = make_directories(out, str(Path(shard).parent)) / Path(shard).name
    if target.exists() and not copy and target.samefile(source / shard):
        return True
    target.unlink(missing_ok=True)
    if not copy:
        try:
            _link(source, shard, target)
            return True
        except OSError as error:
            if error.errno not in _CANNOT_LINK:
                raise InputError(f"cannot write {target}: {error.strerror or error}") from error
    _copy(source, shard, target, receipt)
    return False


def _link(source: Path, shard: str, target: Path) -> None:
    folder, _, name = shard.rpartition("/")
    with folder_inside(source, folder) as place:
        os.link(name, target, src_dir_fd=place, follow_symlinks=False)
    sync_directory(target.parent)


def _copy(source: Path, shard: str, target: Path, receipt: Receipt) -> None:
    found = hashlib.sha256()
    with os.fdopen(open_inside(source, shard), "rb") as stream, AtomicFile(target) as file:
        while block := stream.read(_CHUNK):
            found.update(block)
            file.write(block)
        if found.hexdigest() != receipt.sha256:
            raise DatasetError(f"{source / shard}: damaged; run 'scenegen verify' on its dataset")
        file.commit()


def _rename(source: Path, receipt: Receipt, out: Path, job: ClipJob) -> Receipt:
    """Write a shard under another name of its clip; returns the receipt that belongs to it."""
    target = make_directories(out, str(Path(job.shard).parent)) / Path(job.shard).name
    target.unlink(missing_ok=True)
    total, size = hashlib.sha256(), 0
    frames: list[FrameEntry] = []
    with AtomicFile(target) as file:
        for entry, members in _frames(source, receipt, job):
            spans = {}
            for suffix, data in members.items():
                head = tar.header(f"{entry.key}.{suffix}", len(data))
                spans[suffix] = Span(size + len(head), len(data), zlib.crc32(data))
                for piece in (head, data, tar.padding(len(data))):
                    file.write(piece)
                    total.update(piece)
                    size += len(piece)
            frames.append(replace(entry, members=spans))
        end = tar.trailer(size)
        file.write(end)
        total.update(end)
        file.commit()
    return replace(
        receipt,
        clip=replace(receipt.clip, job=job),
        size=size + len(end),
        sha256=total.hexdigest(),
        frames=tuple(frames),
    )


def _frames(source: Path, receipt: Receipt, job: ClipJob) -> Iterator[tuple[FrameEntry, dict[str, bytes]]]:
    """Every frame under its new key, and the bytes of its members, each checked against its CRC-32."""
    reader = ShardReader(source)
    try:
        for k, (row, entry) in enumerate(zip(rows_of(receipt), receipt.frames, strict=True)):
            members = {suffix: reader.stored(row, receipt.clip.job, suffix) for suffix in entry.members}
            told = parse(members["json"], f"{entry.key}.json")
            if not isinstance(told, dict):
                raise DatasetError(f"{receipt.clip.job.shard}: {entry.key}.json is not a mapping")
            told = {**told, "key": job.key(k)}
            members["json"] = canonical(told)
            yield replace(entry, key=job.key(k), digests={**entry.digests, "json": digest(told)}), members
    finally:
        reader.close()
