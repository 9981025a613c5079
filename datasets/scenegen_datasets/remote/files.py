"""What a reader asks of the place a dataset lies at."""

from __future__ import annotations

import re
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any, Protocol, runtime_checkable

_URL = re.compile(r"[A-Za-z][A-Za-z0-9+.-]*(://|::)")
_HERE = "file://"

Root = Path | str
"""A directory, or a URL as text."""

Span = tuple[int, int]
"""Offset and size of a piece of a file [bytes]."""


@runtime_checkable
class Files(Protocol):
    """The files of one dataset, read-only; paths are relative to it, with slashes."""

    @property
    def where(self) -> str:
        """Place of the dataset, for messages."""
        ...

    def holds(self, path: str) -> bool:
        """Whether there is such a file."""
        ...

    def read(self, path: str, max_bytes: int) -> bytes:
        """Return a whole file that cannot soundly be larger than `max_bytes`.

        Raises
        ------
        DatasetError
            If it is missing or larger.
        """
        ...

    def spans(self, path: str, wanted: Sequence[Span]) -> list[bytes]:
        """Return pieces of a file, each as far as the file goes.

        Raises
        ------
        OSError
            If there is no such file.
        DatasetError
            If it cannot be reached; or, a `CorruptFrameError`, is no plain file.
        """
        ...

    def kept(self, path: str, sha256: str) -> Path:
        """Return a file of this directory, or a copy of it here, with the content its hash names.

        A copy is checked when it is made; a file of a directory is the reader's to check.

        Raises
        ------
        DatasetError
            If the copy is not what `sha256` says.
        """
        ...

    def close(self) -> None:
        """Let go of what is open."""
        ...


def is_url(root: Root) -> bool:
    """Whether a root is a URL that is not plainly a directory of this machine."""
    return isinstance(root, str) and _URL.match(root) is not None and not root.startswith(_HERE)


def plain_root(root: Root) -> Root:
    """Text of a URL without its last slash, or the path of a directory."""
    if is_url(root):
        return str(root).rstrip("/")
    return Path(root.removeprefix(_HERE)) if isinstance(root, str) else root


def files_at(root: Root, options: Mapping[str, Any] | None = None) -> Files:
    """Find the files of a dataset.

    Parameters
    ----------
    root : Path or str
        A directory, or a URL that fsspec knows: ``s3://``, ``gs://``, ``hf://``, ``https://``, ...
    options : mapping, optional
        What fsspec's file system wants to know besides: keys, end points (`storage_options`).
    """
    place = plain_root(root)
    if isinstance(place, Path):
        from scenegen_datasets.remote.disk import DiskFiles

        return DiskFiles(place)
    from scenegen_datasets.remote.web import WebFiles

    return WebFiles(place, options or {})
