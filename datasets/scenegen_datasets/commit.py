"""Write one clip so that it is either there, whole, or not there."""

from __future__ import annotations

from collections.abc import Iterable
from pathlib import Path
from types import TracebackType

from scenegen_datasets.clip import ClipRecord
from scenegen_datasets.encode import EncodedFrame
from scenegen_datasets.job import ClipJob
from scenegen_datasets.receipt import Receipt


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
        raise NotImplementedError

    def __enter__(self) -> ShardWriter:
        raise NotImplementedError

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None:
        raise NotImplementedError

    def add(self, frame: EncodedFrame) -> None:
        """Append one frame; frames come in order."""
        raise NotImplementedError

    def commit(self, record: ClipRecord, *, fingerprint: str) -> Receipt:
        """Sync, rename, and write the receipt last."""
        raise NotImplementedError


def commit_clip(
    root: Path, record: ClipRecord, frames: Iterable[EncodedFrame], *, fingerprint: str
) -> Receipt:
    """Write and commit a whole clip: `ShardWriter` over `frames`."""
    raise NotImplementedError
