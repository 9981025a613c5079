"""Where the files of one clip are written before they count.

Files are built in a directory of their own, synced, and moved to their final names one by one; the clip counts once its
marker is written after that. A file under its final name is therefore always whole, and a clip with a marker has all
of its files.
"""

from __future__ import annotations

import ctypes
import os
import shutil
import sys
from collections.abc import Iterable, Iterator
from pathlib import Path, PurePosixPath
from types import TracebackType

from scenegen.foundation.atomic import explained, make_directories
from scenegen.foundation.errors import ScenegenError

_PROBE_BYTES = 4 << 20
"""More than the largest compressed frame of a layer, the unit in which libraries write."""


class Stage:
    """A place to write files that `commit` moves to where they belong.

    Parameters
    ----------
    root : Path
        Directory of the export.
    work : str
        Directory below it, unique among the writers that live.

    Raises
    ------
    InputError, NoSpaceError
        If it cannot be made.
    """

    def __init__(self, root: Path, work: str) -> None:
        self._root, self._work = root, root / work
        self._made: set[Path] = set()
        self._clear()
        make_directories(root, work)

    def path(self, relative: str) -> Path:
        """A path to write to, for libraries that write files themselves; its directory exists.

        Parameters
        ----------
        relative : str
            Final path below the export, with slashes.
        """
        pure = PurePosixPath(relative)
        assert not pure.is_absolute() and ".." not in pure.parts and "\0" not in relative, relative
        path = self._work / pure
        if path.parent not in self._made:
            try:
                path.parent.mkdir(parents=True, exist_ok=True)
            except OSError as error:
                raise explained(error, path.parent) from error
            self._made.add(path.parent)
        return path

    def put(self, relative: str, data: bytes | str) -> None:
        """Write one file.

        Raises
        ------
        NoSpaceError
            If the device is full.
        """
        path = self.path(relative)
        try:
            with path.open("xb") as file:
                file.write(data.encode() if isinstance(data, str) else data)
        except OSError as error:
            raise explained(error, self._root / relative) from error

    def final(self, relative: str) -> Path:
        """Where a file stands once it is committed."""
        return self._root / relative

    def commit(self) -> dict[str, int]:
        """Sync all files and move them to their final names; returns their sizes by path."""
        sizes: dict[str, int] = {}
        homes: set[Path] = set()
        try:
            files = list(self._files())
            _sync(self._work, files)
            for path in files:
                relative = path.relative_to(self._work)
                sizes[relative.as_posix()] = path.stat().st_size
                home = make_directories(self._root, relative.parent.as_posix())
                path.replace(home / path.name)
                homes.add(home)
            _sync(self._root, sorted(homes))
        except ScenegenError:
            raise
        except OSError as error:
            raise explained(error, self._root) from error
        return sizes

    def prove_room(self) -> None:
        """Write a little and remove it again, to learn whether the device still takes it.

        For libraries that write files themselves: on a full device one of them raises an error that does not say so,
        and another only logs what it could not append.

        Raises
        ------
        NoSpaceError
            If the device is full.
        """
        probe = self._work / ".probe"
        try:
            probe.write_bytes(bytes(_PROBE_BYTES))
            probe.unlink()
        except OSError as error:
            raise explained(error, self._root) from error

    def __enter__(self) -> Stage:
        return self

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None:
        """Remove what was not committed; say what a library's failure to write means."""
        try:
            if isinstance(error, ScenegenError):
                return
            if isinstance(error, OSError):
                raise explained(error, self._root) from error
            if isinstance(error, RuntimeError):
                self.prove_room()
        finally:
            self._clear()

    def _files(self) -> Iterator[Path]:
        for directory, folders, names in os.walk(self._work):
            folders.sort()
            yield from (Path(directory) / name for name in sorted(names))

    def _clear(self) -> None:
        if self._work.is_symlink():
            self._work.unlink()
        elif self._work.is_dir():
            shutil.rmtree(self._work)


def _sync(directory: Path, paths: Iterable[Path]) -> None:
    """Make files and directories survive a power cut.

    Linux syncs a whole file system in one call, which is 10 times faster than one call for each of 60 pictures.
    """
    descriptor = os.open(directory, os.O_RDONLY | os.O_DIRECTORY | os.O_CLOEXEC)
    try:
        if sys.platform == "linux" and ctypes.CDLL(None).syncfs(descriptor) == 0:
            return
    finally:
        os.close(descriptor)
    for path in paths:
        descriptor = os.open(path, os.O_RDONLY | os.O_CLOEXEC)
        try:
            os.fsync(descriptor)
        finally:
            os.close(descriptor)
