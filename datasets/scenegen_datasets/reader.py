"""Members of a shard by offset: descriptors are opened once per process, and nothing is ever extracted."""

from __future__ import annotations

import os
import zlib
from collections import OrderedDict
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from scenegen.foundation.errors import CorruptFrameError
from scenegen_datasets.job import ClipJob
from scenegen_datasets.layers import Layer, max_member_bytes, member_field
from scenegen_datasets.pixels import decode_member

_MAX_OPEN = 64


class ShardReader:
    """Decodes members of the frames of one dataset; keeps at most 64 shards open.

    Reads with ``pread``, which moves no shared position, so a forked process may go on with what it inherited.
    """

    def __init__(self, root: Path) -> None:
        self._root = root
        self._open: OrderedDict[str, int] = OrderedDict()

    def arrays(
        self, row: np.void, job: ClipJob, member: str, layers: tuple[Layer, ...]
    ) -> dict[str, NDArray[Any]]:
        """Decode one member of the frame of `job` that `row` (checked) describes.

        Raises
        ------
        CorruptFrameError
            If the shard is missing or short, or the member's bytes are not those that were written.
        """
        data = self.stored(row, job, member)
        where = f"{job.shard}: {job.key(int(row['frame']))}.{member}"
        shape = (int(row["height_px"]), int(row["width_px"]))
        try:
            return decode_member(member, layers, data, shape)
        except CorruptFrameError as error:
            raise CorruptFrameError(f"{where}: {error}") from None

    def stored(self, row: np.void, job: ClipJob, member: str) -> bytes:
        """Bytes of one member of the frame of `job` that `row` (checked) describes, as they stand in the shard.

        Raises
        ------
        CorruptFrameError
            If the shard is missing or short, or the bytes are not those that were written.
        """
        name = member_field(member)
        where = f"{job.shard}: {job.key(int(row['frame']))}.{member}"
        size = int(row[f"{name}_size"])
        shape = (int(row["height_px"]), int(row["width_px"]))
        if size > min(int(row["shard_size"]), max_member_bytes(shape)):
            raise CorruptFrameError(f"{where}: larger than its shard or its image allows")
        try:
            data = os.pread(self._descriptor(job.shard), size, int(row[f"{name}_offset"]))
        except OSError as error:
            raise CorruptFrameError(f"{where}: {error.strerror or error}") from None
        if len(data) != size or zlib.crc32(data) != int(row[f"{name}_crc32"]):
            raise CorruptFrameError(f"{where}: damaged; run `scenegen verify`")
        return data

    def close(self) -> None:
        """Close all descriptors."""
        while self._open:
            os.close(self._open.popitem()[1])

    def __del__(self) -> None:
        self.close()

    def _descriptor(self, shard: str) -> int:
        if shard in self._open:
            self._open.move_to_end(shard)
            return self._open[shard]
        if len(self._open) >= _MAX_OPEN:
            os.close(self._open.popitem(last=False)[1])
        descriptor = os.open(self._root / shard, os.O_RDONLY | os.O_NOFOLLOW | os.O_CLOEXEC)
        self._open[shard] = descriptor
        return descriptor
