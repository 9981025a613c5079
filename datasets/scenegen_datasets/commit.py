"""Write one clip so that it is either there, whole, or not there.

Order: temporary tar, fsync, rename, fsync of the directory; then the receipt the same way. A clip counts only with its
receipt, so a kill between any two steps costs this clip's work and nothing else.
"""

from __future__ import annotations

import hashlib
import zlib
from collections.abc import Iterable
from pathlib import Path
from types import TracebackType

import numpy as np

from scenegen.foundation.atomic import AtomicFile, make_directories, remove_partials
from scenegen.foundation.errors import DatasetError
from scenegen_datasets import tar
from scenegen_datasets.clip import ClipRecord
from scenegen_datasets.encode import EncodedFrame
from scenegen_datasets.job import ClipJob
from scenegen_datasets.receipt import FrameEntry, Receipt, Span
from scenegen_datasets.statistics import clip_statistics


class ShardWriter:
    """Streams the frames of one clip into a temporary tar; `commit` makes it real.

    >>> with ShardWriter(root, job) as shard:        # doctest: +SKIP
    ...     for k, (frame, reading) in enumerate(frames):
    ...         shard.add(encode_frame(job.key(k), frame, reading, meta[k]))
    ...     receipt = shard.commit(record, fingerprint=fingerprint_id)

    Leaving the block without `commit` removes what was written.

    Raises
    ------
    NoSpaceError
        If the device is full; the partial file is gone by then.
    """

    def __init__(self, root: Path, job: ClipJob) -> None:
        self._root, self._job = root, job
        path, receipt = root / job.shard, root / job.receipt
        for file in (path, receipt):
            make_directories(root, str(file.parent.relative_to(root)))
            remove_partials(file.parent, of=file.name)
        self._file = AtomicFile(path)
        self._hash = hashlib.sha256()
        self._size = 0
        self._frames: list[FrameEntry] = []
        self._first: EncodedFrame | None = None
        self._depth: list[np.ndarray] = []
        self._temperature: list[np.ndarray] = []

    def __enter__(self) -> ShardWriter:
        return self

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None:
        self._file.__exit__(kind, error, trace)

    def add(self, frame: EncodedFrame) -> None:
        """Append one frame; frames come in order, all with the same layers and size."""
        expected = self._job.key(len(self._frames))
        if frame.key != expected:
            raise DatasetError(f"{self._job.name}: frame {frame.key} where {expected} belongs")
        self._first = self._first or frame
        if (frame.layers, frame.shape) != (self._first.layers, self._first.shape):
            raise DatasetError(f"{frame.key}: other layers or another size than the frames before")
        spans = {m.suffix: self._append(f"{frame.key}.{m.suffix}", m.data) for m in frame.members}
        self._frames.append(
            FrameEntry(
                key=frame.key,
                time_s=float(frame.meta.time_s),
                world_from_camera=tuple(map(tuple, frame.meta.world_from_camera.tolist())),
                K=tuple(map(tuple, frame.meta.K.tolist())),
                members=spans,
                digests={name: digest for m in frame.members for name, digest in m.digests.items()},
                statistics=frame.statistics,
            )
        )
        self._depth.append(frame.depth_sample)
        self._temperature.append(frame.temperature_sample)

    def commit(self, record: ClipRecord, *, fingerprint: str) -> Receipt:
        """Sync, rename, and write the receipt last.

        Parameters
        ----------
        record : ClipRecord
            Of this very job.
        fingerprint : str
            `scenegen_datasets.lock.fingerprint_id`.

        Raises
        ------
        DatasetError
            If frames are missing or `record` is of another clip.
        """
        self._check_complete(record)
        self._put(tar.trailer(self._size))
        receipt = Receipt(
            clip=record,
            layers=self._first.layers if self._first else (),
            size=self._size,
            sha256=self._hash.hexdigest(),
            fingerprint=fingerprint,
            frames=tuple(self._frames),
            statistics=clip_statistics(
                (f.statistics for f in self._frames),
                np.concatenate(self._depth),
                np.concatenate(self._temperature),
            ),
        )
        self._file.commit()
        with AtomicFile(self._root / self._job.receipt) as file:
            file.write(receipt.to_bytes())
            file.commit()
        return receipt

    def _check_complete(self, record: ClipRecord) -> None:
        if record.job != self._job:
            raise DatasetError(f"{self._job.name}: committed with the record of {record.job.name}")
        if len(self._frames) != self._job.frames:
            raise DatasetError(f"{self._job.name}: {len(self._frames)} frames of {self._job.frames}")
        if self._first and self._first.shape != (record.height_px, record.width_px):
            raise DatasetError(f"{self._job.name}: frames are {self._first.shape}, the record says otherwise")

    def _append(self, name: str, data: bytes) -> Span:
        self._put(tar.header(name, len(data)))
        span = Span(self._size, len(data), zlib.crc32(data))
        self._put(data)
        self._put(tar.padding(len(data)))
        return span

    def _put(self, data: bytes) -> None:
        self._file.write(data)
        self._hash.update(data)
        self._size += len(data)


def commit_clip(
    root: Path, record: ClipRecord, frames: Iterable[EncodedFrame], *, fingerprint: str
) -> Receipt:
    """Write and commit a whole clip: `ShardWriter` over `frames`."""
    with ShardWriter(root, record.job) as shard:
        for frame in frames:
            shard.add(frame)
        return shard.commit(record, fingerprint=fingerprint)
