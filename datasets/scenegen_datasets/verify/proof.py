"""A dataset that was just made of others: proven whole, or not finished."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path

from scenegen.foundation.atomic import remove
from scenegen.foundation.lock import DirectoryLock
from scenegen_datasets.store import DATASET, MANIFEST
from scenegen_datasets.verify import VerifyReport, verify


def prove(root: Path, jobs: int = 1, progress: Callable[[int, int], None] | None = None) -> VerifyReport:
    """Verify what was made; where anything is wrong, take back what says that it is whole.

    Parts that are damaged, or that lie, give a whole that does. Without ``dataset.json`` nobody takes it for one, and
    the command that made it goes on with it once they are put right.

    Parameters
    ----------
    root : Path
        A dataset that this process has just finished.
    jobs : int
        Worker processes.
    progress : callable, optional
        Called with (clips done, clips in all).

    Raises
    ------
    InputError, DatasetError
        As `scenegen_datasets.verify.verify`.
    """
    report = verify(root, jobs, progress=progress)
    if not report.ok:
        with DirectoryLock(root):
            remove(root / DATASET)
            remove(root / MANIFEST)
    return report
