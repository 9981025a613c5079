"""Remove what lies below a directory: never through a link, never on another file system, at any depth."""

from __future__ import annotations

import itertools
import os
import stat
from collections.abc import Iterator
from pathlib import Path

from scenegen.foundation.errors import DatasetError, InputError
from scenegen.foundation.printable import printable
from scenegen_datasets.inside import folder_inside, steps_of

_FOLDER = os.O_RDONLY | os.O_DIRECTORY | os.O_NOFOLLOW | os.O_CLOEXEC


def remove_inside(root: Path, path: str) -> None:
    """Remove a file, a link (not what it points to) or a whole folder; nothing happens if it is gone.

    A folder inside a folder is first moved up beside it, so that neither recursion nor descriptors limit the depth.

    Raises
    ------
    DatasetError
        If the path leads elsewhere, a step of it is a link, or the folder holds another file system.
    InputError
        If it may not be removed.
    """
    *above, name = steps_of(path)
    with folder_inside(root, "/".join(above), path) as parent:
        try:
            device = os.fstat(parent).st_dev
            waiting = [name]
            spare = _spare_names(parent)
            while waiting:
                waiting += _remove_one(parent, waiting.pop(), device, spare, path)
            os.fsync(parent)
        except OSError as error:
            raise InputError(f"{printable(path)}: cannot be removed: {error.strerror or error}") from None


def _remove_one(parent: int, name: str, device: int, spare: Iterator[str], path: str) -> list[str]:
    """Remove one entry of a folder; returns the names of folders that were moved up out of it."""
    try:
        found = os.stat(name, dir_fd=parent, follow_symlinks=False)
    except FileNotFoundError:
        return []
    if not stat.S_ISDIR(found.st_mode):
        os.unlink(name, dir_fd=parent)
        return []
    if found.st_dev != device:
        raise DatasetError(f"{printable(path)}: holds another file system; unmount it first")
    moved = []
    here = os.open(name, _FOLDER, dir_fd=parent)
    try:
        with os.scandir(here) as entries:
            names = [(e.name, e.is_dir(follow_symlinks=False)) for e in entries]
        for inner, is_folder in names:
            if is_folder:
                moved.append(next(spare))
                os.rename(inner, moved[-1], src_dir_fd=here, dst_dir_fd=parent)
            else:
                os.unlink(inner, dir_fd=here)
    finally:
        os.close(here)
    os.rmdir(name, dir_fd=parent)
    return moved


def _spare_names(parent: int) -> Iterator[str]:
    """Names nothing in a folder has; what a kill leaves under them counts as a leftover."""
    taken = set(os.listdir(parent))
    names = (f".removed.{os.getpid()}-{k}.partial" for k in itertools.count())
    return (name for name in names if name not in taken)
