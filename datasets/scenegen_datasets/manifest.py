"""``MANIFEST.sha256``: what ``sha256sum -c`` reads."""

from __future__ import annotations

import hashlib
import re
from collections.abc import Mapping
from pathlib import Path

from scenegen.foundation.errors import DatasetError
from scenegen_datasets.seal import read_bounded

_PATH = re.compile(r"(?:[A-Za-z0-9_.-]+/)*[A-Za-z0-9_.-]+")
_LINE = re.compile(rf"([0-9a-f]{{64}})  ({_PATH.pattern})")
_MAX_BYTES = 64 << 20


def listable(path: str) -> bool:
    """Whether a manifest can name this path: those of ours are letters, digits, ``_``, ``.`` and ``-``."""
    return _PATH.fullmatch(path) is not None


def manifest_bytes(sums: Mapping[str, str]) -> bytes:
    """Return the manifest of ``path below the dataset -> SHA-256``, sorted by path."""
    return "".join(f"{sums[path]}  {path}\n" for path in sorted(sums)).encode()


def read_manifest(path: Path) -> dict[str, str]:
    """Read a manifest.

    Raises
    ------
    DatasetError
        If it is missing or holds anything but sums and plain relative paths.
    """
    sums = {}
    for line in read_bounded(path, _MAX_BYTES).decode("utf-8", "replace").splitlines():
        match = _LINE.fullmatch(line)
        if match is None or {".", ".."} & set(match[2].split("/")):
            raise DatasetError(f"{path}: not a line of a manifest: {line[:80]!r}")
        sums[match[2]] = match[1]
    return sums


def file_sha256(path: Path) -> str:
    """SHA-256 of a file."""
    with path.open("rb") as file:
        return hashlib.file_digest(file, "sha256").hexdigest()
