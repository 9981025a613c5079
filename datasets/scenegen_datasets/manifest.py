"""``MANIFEST.sha256``: what ``sha256sum -c`` reads."""

from __future__ import annotations

import hashlib
import io
import re
from collections.abc import Mapping
from pathlib import Path

from scenegen.foundation.errors import DatasetError
from scenegen_datasets.seal import read_bounded

_PATH = re.compile(r"(?:[A-Za-z0-9_.-]+/)*[A-Za-z0-9_.-]+")
_UNSAFE = re.compile(r"(?i)(?:^|/)(?:[^/]*\.|(?:con|prn|aux|nul|com[0-9]|lpt[0-9])(?:\.[^/]*)?)(?:/|$)")
"""Steps of a path that lead up, or that are no file on Windows: those that end in a dot, and names of devices."""

_LINE = re.compile(rf"([0-9a-f]{{64}})  ({_PATH.pattern})")
_MAX_BYTES = 64 << 20


def listable(path: str) -> bool:
    """Whether a manifest can name this path: letters, digits, ``_``, ``.`` and ``-``, and a file on every system."""
    return _PATH.fullmatch(path) is not None and _UNSAFE.search(path) is None


def manifest_bytes(sums: Mapping[str, str]) -> bytes:
    """Return the manifest of ``path below the dataset -> SHA-256``, sorted by path."""
    return "".join(f"{sums[path]}  {path}\n" for path in sorted(sums)).encode()


def read_manifest(path: Path) -> dict[str, str]:
    """Read a manifest.

    Raises
    ------
    DatasetError
        If it is missing, or holds anything but sums and plain relative paths, each once.
    """
    sums: dict[str, str] = {}
    folded: set[str] = set()
    for raw in io.BytesIO(read_bounded(path, _MAX_BYTES)):  # line by line: a list of them could be far larger
        line = raw.removesuffix(b"\n").decode("utf-8", "replace")
        match = _LINE.fullmatch(line)
        if match is None or not listable(match[2]):
            raise DatasetError(f"{path}: not a line of a manifest: {line[:80]!a}")
        if match[2].casefold() in folded:
            raise DatasetError(
                f"{path}: names {match[2][:80]} twice, or two files that are one on other systems"
            )
        folded.add(match[2].casefold())
        sums[match[2]] = match[1]
    return sums


def file_sha256(path: Path) -> str:
    """SHA-256 of a file."""
    with path.open("rb") as file:
        return hashlib.file_digest(file, "sha256").hexdigest()
