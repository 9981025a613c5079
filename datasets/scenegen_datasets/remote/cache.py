"""Copies of small files of remote datasets, named by their content: they are never stale, and shared by all readers."""

from __future__ import annotations

import hashlib
import os
from collections.abc import Iterable
from pathlib import Path

from scenegen.foundation.atomic import AtomicFile
from scenegen.foundation.errors import DatasetError, InputError

ENVIRONMENT = "SCENEGEN_CACHE"
"""Environment variable that moves the folder of copies; ``~/.cache/thermal-scenegen`` without it."""


def cache_folder() -> Path:
    """Folder of the copies, made if it is not there.

    Raises
    ------
    InputError
        If it cannot be made.
    """
    base = os.environ.get("XDG_CACHE_HOME") or "~/.cache"
    folder = Path(os.environ.get(ENVIRONMENT) or f"{base}/thermal-scenegen").expanduser() / "files"
    try:
        folder.mkdir(parents=True, exist_ok=True)
    except OSError as error:
        raise InputError(
            f"{folder} cannot be made: {error.strerror or error}; name another folder in {ENVIRONMENT}"
        ) from None
    return folder


def keep(chunks: Iterable[bytes], sha256: str, where: str) -> Path:
    """Return the copy named `sha256`; it is filled from `chunks` unless it is there already.

    Raises
    ------
    DatasetError
        If the chunks are other bytes than the hash says; nothing is kept then.
    """
    path = cache_folder() / sha256
    if path.is_file():
        return path
    found = hashlib.sha256()
    with AtomicFile(path) as file:
        for chunk in chunks:
            found.update(chunk)
            file.write(chunk)
        if found.hexdigest() != sha256:
            raise DatasetError(f"{where}: damaged, or changed while it was read; try again")
        file.commit()
    return path
