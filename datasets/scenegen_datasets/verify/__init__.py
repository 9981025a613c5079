"""Proof that a dataset is what it says it is."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from concurrent.futures import ProcessPoolExecutor, as_completed
from concurrent.futures.process import BrokenProcessPool
from multiprocessing import get_context
from pathlib import Path

from scenegen_datasets.codecs import single_threaded
from scenegen_datasets.receipt import receipt_paths
from scenegen_datasets.store import read_lock
from scenegen_datasets.verify.clip import ClipCheck, check_clip
from scenegen_datasets.verify.report import Finding, VerifyReport
from scenegen_datasets.verify.tree import check_tree

__all__ = ["ClipCheck", "Finding", "VerifyReport", "examine", "verify"]


def verify(
    root: Path, jobs: int = 1, quick: bool = False, progress: Callable[[int, int], None] | None = None
) -> VerifyReport:
    """Check a dataset against its manifest, its receipts and its own rules.

    Decodes every member of every frame, compares the digests of the arrays, and proves what `docs/dataset_format.md`
    promises of them. Safe on hostile input: nothing is extracted, no size is believed before it is checked.

    Parameters
    ----------
    root : Path
    jobs : int
        Worker processes; 1 works in this one. A script that asks for more does so below ``if __name__ == "__main__":``,
        as the processes import it.
    quick : bool
        Sizes and metadata only: finds what is missing or short, not flipped bits in pixels.
    progress : callable, optional
        Called with (clips done, clips in all).

    Returns
    -------
    VerifyReport
        With one finding per file and reason.

    Raises
    ------
    InputError
        If there is no dataset at `root`.
    DatasetError
        If its lock is damaged.
    """
    return examine(root, jobs, quick, progress)[0]


def examine(
    root: Path, jobs: int = 1, quick: bool = False, progress: Callable[[int, int], None] | None = None
) -> tuple[VerifyReport, tuple[ClipCheck, ...]]:
    """Verify, and give what was found clip by clip as well; arguments and errors as `verify`."""
    read_lock(root)
    paths = receipt_paths(root)
    checks: list[ClipCheck] = []
    for check in _checks(root, paths, jobs, quick):
        checks.append(check)
        if progress:
            progress(len(checks), len(paths))
    findings = [f for c in checks for f in c.findings] + list(check_tree(root, checks))
    report = VerifyReport(
        findings=tuple(sorted(set(findings))),
        clips=len(checks),
        frames=sum(c.frames for c in checks),
        bytes=sum(c.size for c in checks),
        quick=quick,
    )
    return report, tuple(checks)


def _checks(root: Path, paths: list[str], jobs: int, quick: bool) -> Iterator[ClipCheck]:
    if jobs <= 1 or len(paths) <= 1:
        for path in paths:
            yield check_clip(root, path, quick)
        return
    pending = dict.fromkeys(paths)
    try:
        with _executor(min(jobs, len(paths))) as pool:
            for future in as_completed([pool.submit(check_clip, root, path, quick) for path in paths]):
                check = future.result()
                del pending[check.receipt]
                yield check
    except BrokenProcessPool:
        yield from _one_by_one(root, list(pending), quick)


def _one_by_one(root: Path, paths: list[str], quick: bool) -> Iterator[ClipCheck]:
    """After a decoder took its process down: a process per clip, to name the clip that does it."""
    for path in paths:
        try:
            with _executor(1) as pool:
                yield pool.submit(check_clip, root, path, quick).result()
        except BrokenProcessPool:
            yield ClipCheck(path, (Finding(path, "the process that decoded this clip died"),))


def _executor(workers: int) -> ProcessPoolExecutor:
    return ProcessPoolExecutor(workers, mp_context=get_context("spawn"), initializer=single_threaded)
