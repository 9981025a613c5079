"""Any recording, by the ending of its name."""

from __future__ import annotations

import hashlib
from functools import lru_cache
from pathlib import Path

from scenegen.foundation.errors import InputError
from scenegen_flythrough.recordings.recording import Recording

_LARGEST_BYTES = 2**30


def identity(file: str) -> str:
    """SHA-256 of a file that holds a sound recording.

    Raises
    ------
    InputError
        In one line: no such file, another format, or not a flight.
    """
    content = _hash(_existing(file))
    recording_of(file, content)
    return content


@lru_cache(maxsize=4)
def recording_of(file: str, sha256: str) -> Recording:
    """The recording in a file of this content; read once per process."""
    path = _existing(file)
    if _hash(path) != sha256:
        raise InputError(f"{file}: is not the recording this recipe was made with")
    kind = path.suffix.lower()
    try:
        if kind == ".csv":
            from scenegen_flythrough.recordings.text import read_csv

            return read_csv(path)
        if kind in (".tum", ".txt"):
            from scenegen_flythrough.recordings.text import read_tum

            return read_tum(path)
    except UnicodeDecodeError as error:
        raise InputError(f"{file}: is not a text file") from error
    if kind in (".ulg", ".ulog"):
        from scenegen_flythrough.recordings.ulog import read_ulog

        return read_ulog(path)
    raise InputError(f"{file}: a recording ends in .csv, .tum, .txt or .ulg")


def _existing(file: str) -> Path:
    if not file:
        raise InputError(
            "flight.recorded.file: give the file again that this recipe's recording was read from"
        )
    path = Path(file)
    if not path.is_file():
        raise InputError(f"{file}: no such file; flight.recorded.file takes a .csv, .tum or .ulg")
    if path.stat().st_size > _LARGEST_BYTES:
        raise InputError(f"{file}: larger than {_LARGEST_BYTES >> 30} GiB; cut it")
    return path


def _hash(path: Path) -> str:
    return hashlib.sha256(path.read_bytes()).hexdigest()
