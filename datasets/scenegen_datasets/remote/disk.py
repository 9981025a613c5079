"""A dataset in a directory: descriptors are opened once per process, and nothing is ever extracted."""

from __future__ import annotations

import os
import threading
from collections import OrderedDict
from collections.abc import Sequence
from pathlib import Path

from scenegen.foundation.errors import CorruptFrameError, DatasetError
from scenegen_datasets.inside import open_inside
from scenegen_datasets.remote.files import Span
from scenegen_datasets.seal import read_bounded

_MAX_OPEN = 64


class DiskFiles:
    """Reads with ``pread``, which moves no shared position, so threads and forked processes may go on with it."""

    def __init__(self, root: Path) -> None:
        self._root = root
        self._open: OrderedDict[str, _Opened] = OrderedDict()
        self._lock = threading.Lock()

    @property
    def where(self) -> str:
        """The directory."""
        return str(self._root)

    def holds(self, path: str) -> bool:
        """Whether there is such a file."""
        return (self._root / path).is_file()

    def read(self, path: str, max_bytes: int) -> bytes:
        """Return a whole file."""
        return read_bounded(self._root / path, max_bytes)

    def spans(self, path: str, wanted: Sequence[Span]) -> list[bytes]:
        """Return pieces of a plain file; never through a symbolic link."""
        file = self._opened(path)
        return [os.pread(file.descriptor, size, offset) for offset, size in wanted]

    def kept(self, path: str, sha256: str) -> Path:
        """Return the file itself."""
        return self._root / path

    def close(self) -> None:
        """Close all descriptors, those in use as soon as they are not."""
        with self._lock:
            self._open.clear()

    def _opened(self, path: str) -> _Opened:
        with self._lock:
            file = self._open.get(path)
            if file is None:
                if len(self._open) >= _MAX_OPEN:
                    self._open.popitem(last=False)
                file = self._open[path] = self._open_anew(path)
            else:
                self._open.move_to_end(path)
            return file

    def _open_anew(self, path: str) -> _Opened:
        try:
            return _Opened(self._root, path)
        except DatasetError as error:
            raise CorruptFrameError(f"{self._root}/{error}; run `scenegen verify`") from None


class _Opened:
    """A descriptor that closes with its last user, so that no thread ever reads from a number that was given away."""

    def __init__(self, root: Path, path: str) -> None:
        self.descriptor = -1
        self.descriptor = open_inside(root, path)

    def __del__(self) -> None:
        if self.descriptor >= 0:
            os.close(self.descriptor)
