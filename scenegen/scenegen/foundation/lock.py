"""One writer per directory."""

from __future__ import annotations

from pathlib import Path
from types import TracebackType


class DirectoryLock:
    """Exclusive right to write below a directory, held from ``with`` to its end.

    Parameters
    ----------
    directory : Path
        Must exist.
    name : str
        File of the lock inside it.

    Raises
    ------
    InputError
        On entering, if another living process holds it; names that process and its host.
    """

    def __init__(self, directory: Path, name: str = ".lock") -> None:
        self.path = directory / name

    def __enter__(self) -> DirectoryLock:
        raise NotImplementedError

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None:
        raise NotImplementedError
