"""``index.npy``: one row per stored frame, in plan order, memory-mapped by whoever reads it.

Every row carries a CRC-32 over itself, so that a reader which maps a million rows and touches a few still never acts
on a damaged one.
"""

from __future__ import annotations

import os
import zlib
from collections.abc import Iterable
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from scenegen.foundation.atomic import AtomicFile
from scenegen.foundation.errors import CorruptFrameError, DatasetError
from scenegen_datasets.job import SPLITS, ClipJob
from scenegen_datasets.layers import MEMBERS, member_field
from scenegen_datasets.receipt import FrameEntry, Receipt

_HEAD = [
    ("map", "S24"),
    ("world", "<u4"),
    ("clip", "<u2"),
    ("frame", "<u2"),
    ("frames", "<u2"),
    ("split", "u1"),
    ("is_pair", "?"),
    ("ordinal", "<u4"),
    ("height_px", "<u2"),
    ("width_px", "<u2"),
    ("shard_size", "<u8"),
]
_MEMBER_FIELDS = [
    field
    for suffix in MEMBERS
    for field in (
        (f"{member_field(suffix)}_offset", "<u8"),
        (f"{member_field(suffix)}_size", "<u4"),
        (f"{member_field(suffix)}_crc32", "<u4"),
    )
]
_STATISTICS = [
    ("counts_min", "<u2"),
    ("counts_max", "<u2"),
    ("saturated", "<u4"),
    ("sky_pixels", "<u4"),
    ("depth_min_m", "<f4"),
    ("depth_median_m", "<f4"),
    ("temperature_min_K", "<f4"),
    ("temperature_max_K", "<f4"),
]
_GEOMETRY = [("time_s", "<f8"), ("world_from_camera", "<f8", (4, 4)), ("K", "<f8", (3, 3))]

ROW = np.dtype([*_HEAD, *_MEMBER_FIELDS, *_STATISTICS, *_GEOMETRY, ("row_crc32", "<u4")])
"""One row. A member that was not written has size 0; a statistic that does not exist is NaN."""

Rows = NDArray[Any]


def rows_of(receipt: Receipt) -> Rows:
    """Return the rows of one clip."""
    job, clip = receipt.clip.job, receipt.clip
    rows = np.zeros(len(receipt.frames), ROW)
    head = {
        "map": job.map.encode(),
        "world": job.world,
        "clip": job.clip,
        "frames": job.frames,
        "split": SPLITS.index(job.split),
        "ordinal": job.ordinal,
        "height_px": clip.height_px,
        "width_px": clip.width_px,
        "shard_size": receipt.size,
    }
    for name, value in head.items():
        rows[name] = value
    rows["frame"] = np.arange(len(rows))
    rows["is_pair"] = rows["frame"] > 0
    for name in ("time_s", "world_from_camera", "K"):
        rows[name] = [getattr(f, name) for f in receipt.frames]
    _fill_members(rows, receipt.frames)
    for name, kind in _STATISTICS:
        missing = float("nan") if kind == "<f4" else 0
        values = (f.statistics[name] for f in receipt.frames)
        rows[name] = [missing if value is None else value for value in values]
    for k in range(len(rows)):
        rows["row_crc32"][k] = _crc32(rows[k])
    return rows


def write_index(path: Path, parts: Iterable[Rows], total: int) -> None:
    """Stream rows into an ``.npy`` file of `total` rows."""
    with AtomicFile(path) as file:
        file.write(_npy_header(total))
        written = 0
        for rows in parts:
            file.write(rows.tobytes())
            written += len(rows)
        if written != total:
            raise DatasetError(f"{path}: {written} rows where {total} belong")
        file.commit()


def open_index(path: Path, total: int) -> Rows:
    """Map an index read-only.

    Raises
    ------
    DatasetError
        If it is missing, of another layout or of another length than `total`.
    """
    if path.is_symlink() or not path.is_file():
        raise DatasetError(f"{path}: missing")
    header = _npy_header(total)
    with path.open("rb") as file:
        found = file.read(len(header))
    if found != header or path.stat().st_size != len(header) + total * ROW.itemsize:
        raise DatasetError(f"{path}: not an index of {total} frames of this version")
    if total == 0:
        return np.zeros(0, ROW)
    return np.memmap(path, ROW, "r", offset=len(header), shape=(total,))


def first_rows(path: Path, total: int, clips: int) -> tuple[NDArray[np.int64], Rows]:
    """Find the first row of every clip by jumping from one to the next: reads one row a clip, maps no page.

    Parameters
    ----------
    path : Path
        An index that `open_index` took.
    total, clips : int
        Frames and clips there must be.

    Returns
    -------
    starts : int64 (clips,)
        Their positions.
    heads : structured array (clips,)

    Raises
    ------
    DatasetError
        If the clips do not fill the index.
    """
    starts = np.zeros(clips, np.int64)
    found, at, base = [], 0, len(_npy_header(total))
    field = ROW.fields["frames"][1] if ROW.fields else 0
    descriptor = os.open(path, os.O_RDONLY | os.O_NOFOLLOW | os.O_CLOEXEC)
    try:
        for k in range(clips):
            head = os.pread(descriptor, ROW.itemsize, base + at * ROW.itemsize)
            starts[k] = at
            found.append(head)
            at += max(int.from_bytes(head[field : field + 2], "little"), 1)
    finally:
        os.close(descriptor)
    heads = b"".join(found)
    if at != total or len(heads) != clips * ROW.itemsize:
        raise DatasetError(f"{path}: holds other frames than the list of clips; run `scenegen verify`")
    return starts, np.frombuffer(heads, ROW)


def checked(row: np.void) -> np.void:
    """Return the row if its checksum holds.

    Raises
    ------
    CorruptFrameError
        If it was damaged.
    """
    if int(row["row_crc32"]) != _crc32(row):
        raise CorruptFrameError("index.npy: a row is damaged; run `scenegen verify`")
    return row


def job_of(row: np.void) -> ClipJob:
    """Return the clip a row belongs to.

    Raises
    ------
    CorruptFrameError
        If no clip can have such a row.
    """
    try:
        return ClipJob(
            ordinal=int(row["ordinal"]),
            map=row["map"].decode("ascii", "replace"),
            world=int(row["world"]),
            clip=int(row["clip"]),
            split=SPLITS[int(row["split"])],
            pairs=int(row["frames"]) - 1,
        )
    except (ValueError, IndexError) as error:
        raise CorruptFrameError(f"index.npy: a row makes no sense ({error}); run `scenegen verify`") from None


def _fill_members(rows: Rows, frames: Iterable[FrameEntry]) -> None:
    for k, frame in enumerate(frames):
        for suffix, span in frame.members.items():
            name = member_field(suffix)
            rows[f"{name}_offset"][k] = span.offset
            rows[f"{name}_size"][k] = span.size
            rows[f"{name}_crc32"][k] = span.crc32


def _crc32(row: Any) -> int:
    return zlib.crc32(row.tobytes()[: -ROW["row_crc32"].itemsize])


def _npy_header(total: int) -> bytes:
    """Header of an ``.npy`` file, version 1.0 of the format, written the same way by every numpy."""
    text = (
        f"{{'descr': {np.lib.format.dtype_to_descr(ROW)!r}, 'fortran_order': False, 'shape': ({total},), }}"
    )
    fill = -(10 + len(text) + 1) % 64
    body = (text + " " * fill + "\n").encode("latin-1")
    return b"\x93NUMPY\x01\x00" + len(body).to_bytes(2, "little") + body
