"""Files that are either there, whole, or not there.

A file is written under a temporary name in its own directory, synced, renamed, and the directory is synced: after a
crash at any moment the old content, the new content or nothing is found under the real name. What a killed writer
leaves behind is recognised by its name and removed by the next one.
"""

from __future__ import annotations

import errno
import os
import stat
import time
from pathlib import Path
from types import TracebackType

from scenegen.foundation.errors import InputError, NoSpaceError, ScenegenError

_PARTIAL = ".partial"
_FULL = {errno.ENOSPC, errno.EDQUOT, errno.EFBIG}


class AtomicFile:
    """A file under construction: `write` as often as needed, then `commit`. Leaving the block without it undoes all.

    Parameters
    ----------
    path : Path
        Final name; its directory must exist.

    Raises
    ------
    NoSpaceError
        If the device is full; the temporary file is gone by then.
    InputError
        If the directory cannot be written.
    """

    def __init__(self, path: Path) -> None:
        self.path = path
        self._temporary, self._descriptor = _create(path)

    def write(self, data: bytes | memoryview) -> None:
        """Append bytes."""
        view = memoryview(data).cast("B")
        try:
            while len(view):
                view = view[os.write(self._descriptor, view) :]
        except OSError as error:
            self.discard()
            raise explained(error, self.path) from error

    def commit(self) -> None:
        """Sync, rename to the final name, sync the directory."""
        try:
            os.fsync(self._descriptor)
            self._close()
            self._temporary.replace(self.path)
            sync_directory(self.path.parent)
        except OSError as error:
            self.discard()
            raise explained(error, self.path) from error

    def discard(self) -> None:
        """Remove the temporary file, if there still is one."""
        self._close()
        self._temporary.unlink(missing_ok=True)

    def _close(self) -> None:
        if self._descriptor >= 0:
            descriptor, self._descriptor = self._descriptor, -1
            os.close(descriptor)

    def __enter__(self) -> AtomicFile:
        return self

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None:
        if self._descriptor >= 0:
            self.discard()


def write_atomic(path: Path, data: bytes) -> None:
    """Write a whole file; leaves it untouched if it holds these very bytes already."""
    if (
        not path.is_symlink()
        and path.is_file()
        and path.stat().st_size == len(data)
        and path.read_bytes() == data
    ):
        return
    with AtomicFile(path) as file:
        file.write(data)
        file.commit()


def remove(path: Path) -> None:
    """Remove a file if it is there, and make the removal last."""
    if path.is_symlink() or path.exists():
        path.unlink()
        sync_directory(path.parent)


def make_directories(root: Path, relative: str) -> Path:
    """Create ``root/relative`` step by step and return it; refuses to walk through symbolic links.

    Raises
    ------
    InputError
        If a step exists and is not a real directory, or cannot be made.
    """
    directory = root
    for part in Path(relative).parts:
        parent, directory = directory, directory / part
        try:
            directory.mkdir()
            sync_directory(parent)
        except FileExistsError:
            if not stat.S_ISDIR(directory.lstat().st_mode):
                raise InputError(
                    f"{directory} is a link or a file where a directory belongs; move it away"
                ) from None
        except OSError as error:
            raise explained(error, directory) from error
    return directory


def sync_directory(directory: Path) -> None:
    """Make renames and removals in a directory survive a power cut."""
    descriptor = os.open(directory, os.O_RDONLY | os.O_DIRECTORY | os.O_CLOEXEC)
    try:
        os.fsync(descriptor)
    finally:
        os.close(descriptor)


def is_partial(name: str) -> bool:
    """Whether a file name is that of an unfinished `AtomicFile`."""
    return name.startswith(".") and name.endswith(_PARTIAL)


def remove_partials(directory: Path, of: str | None = None) -> None:
    """Remove what killed writers left in one directory: of the file called `of`, or of all files."""
    if not directory.is_dir():
        return
    for entry in os.scandir(directory):
        if entry.is_dir(follow_symlinks=False):
            continue  # no writer of ours leaves one
        if is_partial(entry.name) and (of is None or entry.name.startswith(f".{of}.")):
            Path(entry.path).unlink(missing_ok=True)


def _create(path: Path) -> tuple[Path, int]:
    """Open a fresh temporary file. Process id and a monotonic counter make the name; O_EXCL makes it ours."""
    flags = os.O_WRONLY | os.O_CREAT | os.O_EXCL | os.O_NOFOLLOW | os.O_CLOEXEC
    while True:
        temporary = path.with_name(f".{path.name}.{os.getpid()}-{time.monotonic_ns()}{_PARTIAL}")
        try:
            return temporary, os.open(temporary, flags, 0o666)
        except FileExistsError:
            continue
        except OSError as error:
            raise explained(error, path) from error


def is_full(error: OSError) -> bool:
    """Whether a write failed because the device, a quota or a limit is full."""
    return error.errno in _FULL


def explained(error: OSError, path: Path) -> ScenegenError:
    """What a failed write means to a user: a full device, or a place that cannot be written."""
    if is_full(error):
        return NoSpaceError(f"no space left for {path}; free some and run the same command again to continue")
    return InputError(f"cannot write {path}: {error.strerror or error}")
