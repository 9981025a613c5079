"""A dataset behind a URL: pieces by range requests, read ahead where somebody reads on, small files kept here."""

from __future__ import annotations

import os
import threading
import time
from collections import OrderedDict
from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any, TypeVar

from scenegen.foundation.errors import DatasetError, InputError, ScenegenError
from scenegen_datasets.remote.cache import keep
from scenegen_datasets.remote.files import Span

_WAITS_S = (0.2, 1.0)
"""Pauses before the second and the third attempt at a request."""

_GAP = 256 << 10
"""Bytes between two pieces that are rather read than asked around."""

_AHEAD = 1 << 20
_MOST_AHEAD = 8 << 20
_BLOCKS = 8
"""Shards that are read ahead at the same time; with `_MOST_AHEAD` it bounds the memory of a reader."""

_CHUNK = 4 << 20
_MAX_KEPT_BYTES = 1 << 36

Value = TypeVar("Value")


@dataclass(frozen=True)
class _Block:
    """A piece of a shard that was read, and how much is read ahead when somebody goes on behind it."""

    start: int
    data: bytes
    ahead: int

    @property
    def end(self) -> int:
        return self.start + len(self.data)


class WebFiles:
    """Files that fsspec reaches.

    Parameters
    ----------
    url : str
    options : mapping
        Of fsspec's file system.

    Raises
    ------
    InputError
        If fsspec, or what it needs for this kind of URL, is not installed.
    """

    def __init__(self, url: str, options: Mapping[str, Any]) -> None:
        self._url, self._options = url, dict(options)
        self._blocks: OrderedDict[str, _Block] = OrderedDict()
        self._lock = threading.Lock()
        self._process = -1
        self._connect()

    @property
    def where(self) -> str:
        """The URL."""
        return self._url

    def holds(self, path: str) -> bool:
        """Whether there is such a file; asks for a byte, because some file systems take no answer for a no."""
        try:
            self._ask(path, lambda fs, place: fs.cat_file(place, start=0, end=1))
        except FileNotFoundError:
            return False
        return True

    def read(self, path: str, max_bytes: int) -> bytes:
        """Return a whole file."""
        data = b"".join(self._chunks(path, max_bytes + 1))
        if len(data) > max_bytes:
            raise DatasetError(f"{self._url}/{path}: larger than the {max_bytes} bytes a sound file can have")
        return data

    def spans(self, path: str, wanted: Sequence[Span]) -> list[bytes]:
        """Return pieces of a file; those that lie close together come in one request."""
        if not wanted:
            return []
        low = min(offset for offset, _ in wanted)
        high = max(offset + size for offset, size in wanted)
        if high - low > sum(size for _, size in wanted) + _GAP * len(wanted):
            return [self.spans(path, [one])[0] for one in wanted]
        block = self._covering(path, low, high)
        return [block.data[offset - block.start :][:size] for offset, size in wanted]

    def kept(self, path: str, sha256: str) -> Path:
        """Return a copy of the file in the folder of copies."""
        return keep(self._chunks(path, _MAX_KEPT_BYTES), sha256, f"{self._url}/{path}")

    def close(self) -> None:
        """Forget what was read ahead."""
        with self._lock:
            self._blocks.clear()

    def _covering(self, path: str, low: int, high: int) -> _Block:
        """What was read already, or what a request brings; it is kept unless it lies before what is kept."""
        with self._lock:
            last = self._blocks.get(path)
        if last is not None and last.start <= low and high <= last.end:
            return last
        on = last is not None and last.start <= low <= last.end + _MOST_AHEAD
        ahead = min(max(2 * last.ahead, _AHEAD), _MOST_AHEAD) if on and last is not None else 0
        fresh = _Block(low, self._range(path, low, max(high, low + ahead)), ahead)
        if last is None or low >= last.start:
            with self._lock:
                self._blocks[path] = fresh
                self._blocks.move_to_end(path)
                while len(self._blocks) > _BLOCKS:
                    self._blocks.popitem(last=False)
        return fresh

    def _range(self, path: str, start: int, end: int) -> bytes:
        data = bytes(self._ask(path, lambda fs, place: fs.cat_file(place, start=start, end=end)))
        if len(data) > end - start:
            raise InputError(
                f"{self._url}: the server sends whole files where pieces are asked for; "
                "copy the dataset to a disk, or serve it by something that answers range requests"
            )
        return data

    def _chunks(self, path: str, limit: int) -> Iterator[bytes]:
        """A file piece by piece, at most `limit` bytes of it."""
        try:
            file = self._ask(path, lambda fs, place: fs.open(place, "rb"))
            with file:
                while limit > 0 and (chunk := file.read(min(_CHUNK, limit))):
                    limit -= len(chunk)
                    yield chunk
        except FileNotFoundError:
            raise DatasetError(f"{self._url}/{path}: missing") from None
        except ScenegenError:
            raise
        except Exception as error:
            raise unreachable(f"{self._url}/{path}", error) from None

    def _ask(self, path: str, question: Callable[[Any, str], Value]) -> Value:
        """Put a question to the file system; errors as `tried`."""
        if self._process != os.getpid():
            self._connect()  # connections do not survive a fork
        return tried(lambda: question(self._fs, f"{self._root}/{path}"), f"{self._url}/{path}")

    def _connect(self) -> None:
        self._fs, self._root = connected(self._url, self._options)
        self._fs.invalidate_cache()  # of listings: a place may have been filled since this process looked at it
        self._process = os.getpid()


def tried(question: Callable[[], Value], where: str) -> Value:
    """Ask a file system, three times before giving up.

    Raises
    ------
    FileNotFoundError
        If there is no such file.
    DatasetError
        If there is no answer; every file system has errors of its own, so any of them means that.
    """
    for wait_s in (*_WAITS_S, None):
        try:
            return question()
        except (FileNotFoundError, ScenegenError):
            raise
        except Exception as error:
            if wait_s is None:
                raise unreachable(where, error) from None
            time.sleep(wait_s)
    raise AssertionError("the last attempt returns or raises")


def unreachable(where: str, error: Exception) -> DatasetError:
    """What an error of a file system means to a user; what an error came from often says more than the error."""
    cause = error.__cause__
    reasons = [_line(error), _line(cause)] if cause is not None else [_line(error)]
    reason = ": ".join(dict.fromkeys(reasons))
    return DatasetError(
        f"{where}: cannot be reached: {reason}; try again later, or check the URL and your access"
    )


def _line(error: BaseException) -> str:
    return " ".join(str(error).split())[:200].rstrip(".") or type(error).__name__


def connected(url: str, options: Mapping[str, Any]) -> tuple[Any, str]:
    """Fsspec's file system for a URL, and the path of the URL in it.

    Raises
    ------
    InputError
        If fsspec does not know such a URL, or lacks what it needs for it.
    """
    try:
        from fsspec.core import url_to_fs
    except ImportError:
        raise InputError(
            f"{url}: remote datasets need fsspec: pip install 'thermal-scenegen[remote]'"
        ) from None
    try:
        fs, root = url_to_fs(url, **options)
    except (ImportError, ValueError) as error:
        raise InputError(f"{url}: {' '.join(str(error).split())[:200]}") from None
    return fs, str(root).rstrip("/")
