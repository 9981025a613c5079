"""Files below a directory, reached without following a link, waiting for a pipe, or leaving the directory.

A dataset may come from anywhere. A plain ``open`` would follow a link planted in it, hang on a named pipe, and read a
device; a recursive walk would die in a folder nested ten thousand deep. Here every step of a path is opened by the
descriptor of the step before, and what is not a plain file is refused before a byte of it is read.
"""

from __future__ import annotations

import contextlib
import errno
import hashlib
import os
import stat
from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path
from typing import Literal

from scenegen.foundation.errors import DatasetError
from scenegen.foundation.printable import printable

MAX_DEPTH = 8
"""Folders inside folders below a dataset; ours are four deep."""

_FOLDER = os.O_RDONLY | os.O_DIRECTORY | os.O_NOFOLLOW | os.O_CLOEXEC
_FILE = os.O_RDONLY | os.O_NOFOLLOW | os.O_NONBLOCK | os.O_CLOEXEC
_NOT_THERE = {errno.ENOENT, errno.ENOTDIR, errno.ELOOP, errno.ENXIO, errno.ENAMETOOLONG}

Kind = Literal["file", "folder", "link", "other"]


@dataclass(frozen=True)
class Entry:
    """Something found below a directory.

    Attributes
    ----------
    path : str
        Below the directory, with slashes.
    kind : str
        ``file`` (a plain one), ``folder``, ``link`` (symbolic), or ``other``: pipe, socket, device.
    """

    path: str
    kind: Kind


def open_inside(root: Path, path: str) -> int:
    """Open a plain file for reading.

    Parameters
    ----------
    root : Path
    path : str
        Below `root`, with slashes; no step of it may be a link.

    Returns
    -------
    int
        Descriptor; the caller closes it.

    Raises
    ------
    DatasetError
        If there is no plain file at this place, or it cannot be read.
    """
    *folders, name = steps_of(path)
    with folder_inside(root, "/".join(folders), path) as folder:
        try:
            descriptor = os.open(name, _FILE, dir_fd=folder)
        except OSError as error:
            raise _refusal(path, error) from None
    if not stat.S_ISREG(os.fstat(descriptor).st_mode):
        os.close(descriptor)
        raise DatasetError(f"{printable(path)}: missing (or not a plain file)")
    return descriptor


@contextlib.contextmanager
def folder_inside(root: Path, path: str, where: str | None = None) -> Iterator[int]:
    """Descriptor of a folder, open within the block; "" is `root` itself, which may be reached through links.

    Raises
    ------
    DatasetError
        If a step is missing, a link or no folder.
    """
    with contextlib.ExitStack() as steps:
        try:
            here = os.open(root, os.O_RDONLY | os.O_DIRECTORY | os.O_CLOEXEC)
            steps.callback(os.close, here)
            for step in steps_of(path) if path else ():
                here = os.open(step, _FOLDER, dir_fd=here)
                steps.callback(os.close, here)
        except OSError as error:
            raise _refusal(where or path or str(root), error) from None
        yield here


def read_inside(root: Path, path: str, max_bytes: int) -> bytes:
    """Read a plain file that cannot soundly be larger than `max_bytes`; its size is looked at first.

    Raises
    ------
    DatasetError
        As `open_inside`, or if it is larger.
    """
    with os.fdopen(open_inside(root, path), "rb") as file:
        size = os.fstat(file.fileno()).st_size
        if size > max_bytes:
            raise DatasetError(f"{printable(path)}: larger than the {max_bytes} bytes a sound file can have")
        try:
            return file.read(size)  # not `max_bytes`, for which a buffer would be made
        except OSError as error:
            raise _refusal(path, error) from None


def size_inside(root: Path, path: str) -> int:
    """Size of a plain file [bytes].

    Raises
    ------
    DatasetError
        As `open_inside`.
    """
    descriptor = open_inside(root, path)
    try:
        return os.fstat(descriptor).st_size
    finally:
        os.close(descriptor)


def sha256_inside(root: Path, path: str, max_bytes: int = 1 << 30) -> str:
    """SHA-256 of a plain file, which must not be larger: a sparse one may claim to be of any size.

    Raises
    ------
    DatasetError
        As `read_inside`.
    """
    with os.fdopen(open_inside(root, path), "rb") as file:
        if os.fstat(file.fileno()).st_size > max_bytes:
            raise DatasetError(f"{printable(path)}: larger than the {max_bytes} bytes a sound file can have")
        try:
            return hashlib.file_digest(file, "sha256").hexdigest()
        except OSError as error:
            raise _refusal(path, error) from None


def steps_of(path: str) -> list[str]:
    """Names of the folders on the way to a file, and its own.

    Raises
    ------
    DatasetError
        If the path is absolute, leads up, or is none.
    """
    steps = path.split("/")
    if {"", ".", ".."} & set(steps) or "\0" in path:
        raise DatasetError(f"{printable(path)}: not a path below a dataset")
    return steps


def walk(root: Path, below: str = "") -> Iterator[Entry]:
    """Everything below a directory, or below one folder in it; neither links nor folders below `MAX_DEPTH` are entered.

    Entries come folder by folder, sorted within each; a folder comes before what is in it.

    Raises
    ------
    DatasetError
        If a folder cannot be listed.
    """
    waiting = [below]
    while waiting:
        here = waiting.pop()
        with folder_inside(root, here) as descriptor, os.scandir(descriptor) as found:
            entries = sorted((entry.name, _kind(entry)) for entry in found)
        for name, kind in entries:
            path = f"{here}/{name}" if here else name
            yield Entry(path, kind)
            if kind == "folder" and path.count("/") < MAX_DEPTH - 1:
                waiting.append(path)


def _kind(entry: os.DirEntry[str]) -> Kind:
    if entry.is_symlink():
        return "link"
    if entry.is_dir(follow_symlinks=False):
        return "folder"
    return "file" if entry.is_file(follow_symlinks=False) else "other"


def _refusal(path: str, error: OSError) -> DatasetError:
    if error.errno in _NOT_THERE:
        return DatasetError(f"{printable(path)}: missing (or not a plain file)")
    return DatasetError(f"{printable(path)}: cannot be read: {error.strerror or error}")
