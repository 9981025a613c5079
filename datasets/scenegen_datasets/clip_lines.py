"""``clips.jsonl`` without holding it in memory: where each line lies, and the line when somebody asks."""

from __future__ import annotations

import hashlib
import os
from collections.abc import Iterator, Sequence
from pathlib import Path
from typing import overload

import numpy as np
from numpy.typing import NDArray

from scenegen.foundation.errors import DatasetError
from scenegen_datasets.remote.disk import DiskFiles

_CHUNK = 1 << 20
_MAX_BYTES = 1 << 34
_MIN_LINE_BYTES, _MAX_LINE_BYTES = 1 << 8, 1 << 20
"""A file of line ends alone would cost eight times its size in memory."""

_NEWLINE = 10


class ClipLines(Sequence[bytes]):
    """Lines of a file, read one at a time.

    Attributes
    ----------
    path : Path
    ends : int64 (lines,)
        Offset behind each line, its newline included.
    """

    def __init__(self, path: Path, ends: NDArray[np.int64]) -> None:
        self.path, self.ends = path, ends
        self._files = DiskFiles(path.parent)

    @classmethod
    def of(cls, path: Path, sha256: str, clips: int) -> ClipLines:
        """Find the lines of a file that must have this hash and so many clips; holds a megabyte of it at a time.

        Raises
        ------
        DatasetError
            If it is missing, a link, or damaged.
        """
        if path.is_symlink() or not path.is_file():
            raise DatasetError(f"{path}: missing; run `scenegen verify`")
        if not clips * _MIN_LINE_BYTES <= path.stat().st_size <= clips * _MAX_LINE_BYTES:
            raise DatasetError(
                f"{path}: damaged, its size is not that of {clips} clips; run `scenegen verify`"
            )
        found, ends, size, count = hashlib.sha256(), [], 0, 0
        with path.open("rb") as file:
            while size <= _MAX_BYTES and (chunk := file.read(_CHUNK)):
                found.update(chunk)
                ends.append(np.flatnonzero(np.frombuffer(chunk, np.uint8) == _NEWLINE) + (size + 1))
                size += len(chunk)
                count += len(ends[-1])
                if count > clips:
                    break
        lines = np.concatenate([np.zeros(0, np.int64), *ends])
        if count != clips or found.hexdigest() != sha256 or (lines[-1] if len(lines) else 0) != size:
            raise DatasetError(f"{path}: damaged; run `scenegen verify`")
        return cls(path, lines)

    def __len__(self) -> int:
        return len(self.ends)

    @overload
    def __getitem__(self, index: int) -> bytes: ...

    @overload
    def __getitem__(self, index: slice) -> list[bytes]: ...

    def __getitem__(self, index: int | slice) -> bytes | list[bytes]:
        """One line without its end.

        Raises
        ------
        DatasetError
            If the file is gone or shorter than it was.
        """
        if isinstance(index, slice):
            return [self[k] for k in range(*index.indices(len(self)))]
        at = range(len(self))[index]
        start, end = int(self.ends[at - 1]) if at else 0, int(self.ends[at])
        try:
            (line,) = self._files.spans(self.path.name, [(start, min(end - start, _MAX_LINE_BYTES))])
        except OSError as error:
            raise DatasetError(f"{self.path}: {os.strerror(error.errno or 0)}") from None
        if not line.endswith(b"\n"):
            raise DatasetError(f"{self.path}: damaged; run `scenegen verify`")
        return line[:-1]

    def __iter__(self) -> Iterator[bytes]:
        return (self[k] for k in range(len(self)))
