"""Members of a shard by offset: pieces are read where they lie, and nothing is ever extracted."""

from __future__ import annotations

import zlib
from collections.abc import Iterable, Mapping
from typing import Any

import numpy as np
from numpy.typing import NDArray

from scenegen.foundation.errors import CorruptFrameError
from scenegen_datasets.job import ClipJob
from scenegen_datasets.layers import Layer, max_member_bytes, member_field
from scenegen_datasets.pixels import decode_member
from scenegen_datasets.remote import Files, Root, files_at

_MAX_SHARD_BYTES = 1 << 48
"""Beyond any file; what an index says is bounded before the system is asked."""


class ShardReader:
    """Decodes members of the frames of one dataset, in a directory or behind a URL.

    Threads may share one, and forked processes may go on with it.

    Parameters
    ----------
    root : Path or str
        Of the dataset.
    files : Files, optional
        Its files, if they were found already.
    """

    def __init__(self, root: Root, files: Files | None = None) -> None:
        self._files = files or files_at(root)

    def arrays(
        self, row: np.void, job: ClipJob, member: str, layers: tuple[Layer, ...]
    ) -> dict[str, NDArray[Any]]:
        """Decode one member of the frame of `job` that `row` (checked) describes.

        Raises
        ------
        CorruptFrameError
            If the shard is missing or short, or the member's bytes are not those that were written.
        DatasetError
            If what is behind a URL cannot be reached now.
        """
        return self.frame(row, job, {member: layers})

    def frame(
        self, row: np.void, job: ClipJob, members: Mapping[str, tuple[Layer, ...]]
    ) -> dict[str, NDArray[Any]]:
        """Decode several members of one frame, read together; errors as `arrays`.

        Parameters
        ----------
        row : structured scalar
            Checked.
        job : ClipJob
        members : mapping of str to tuple of Layer
            Suffix to all the layers the member was written with.
        """
        if not members:
            return {}
        shape = (int(row["height_px"]), int(row["width_px"]))
        found: dict[str, NDArray[Any]] = {}
        for (member, layers), data in zip(members.items(), self._read(row, job, members), strict=True):
            try:
                found |= decode_member(member, layers, data, shape)
            except CorruptFrameError as error:
                raise CorruptFrameError(f"{self._where(row, job, member)}: {error}") from None
        return found

    def stored(self, row: np.void, job: ClipJob, member: str) -> bytes:
        """Bytes of one member of the frame of `job` that `row` (checked) describes, as they stand in the shard.

        Raises
        ------
        CorruptFrameError
            If the shard is missing or short, or the bytes are not those that were written.
        """
        return self._read(row, job, (member,))[0]

    def close(self) -> None:
        """Close all descriptors."""
        self._files.close()

    def _read(self, row: np.void, job: ClipJob, members: Iterable[str]) -> list[bytes]:
        names = [(member, member_field(member)) for member in members]
        limit = min(int(row["shard_size"]), max_member_bytes((int(row["height_px"]), int(row["width_px"]))))
        wanted = [(int(row[f"{name}_offset"]), int(row[f"{name}_size"])) for _, name in names]
        for (member, _), (offset, size) in zip(names, wanted, strict=True):
            if size > limit or offset > min(int(row["shard_size"]), _MAX_SHARD_BYTES) - size:
                raise CorruptFrameError(
                    f"{self._where(row, job, member)}: larger than its shard or its image allows"
                )
        try:
            pieces = self._files.spans(job.shard, wanted)
        except OSError as error:
            raise CorruptFrameError(f"{self._files.where}/{job.shard}: {error.strerror or error}") from None
        for (member, name), (_, size), data in zip(names, wanted, pieces, strict=True):
            if len(data) != size or zlib.crc32(data) != int(row[f"{name}_crc32"]):
                raise CorruptFrameError(f"{self._where(row, job, member)}: damaged; run `scenegen verify`")
        return pieces

    def _where(self, row: np.void, job: ClipJob, member: str) -> str:
        return f"{self._files.where}/{job.shard}: {job.key(int(row['frame']))}.{member}"
