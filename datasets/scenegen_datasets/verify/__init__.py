"""Proof that a dataset is what it says it is."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path


@dataclass(frozen=True)
class Finding:
    """One thing that is wrong: the file (relative to the dataset, member after a colon) and why."""

    file: str
    reason: str


@dataclass(frozen=True)
class VerifyReport:
    """Outcome of `verify`; `ok` if nothing was found."""

    findings: tuple[Finding, ...]
    clips: int
    frames: int
    bytes: int

    @property
    def ok(self) -> bool:
        """Whether nothing was found."""
        return not self.findings


def verify(
    root: Path, jobs: int = 1, quick: bool = False, progress: Callable[[int, int], None] | None = None
) -> VerifyReport:
    """Check a dataset against its manifest, its receipts and its own rules.

    Parameters
    ----------
    root : Path
    jobs : int
        Worker processes.
    quick : bool
        Sizes and metadata only: finds what is missing or short, not flipped bits in pixels.
    progress : callable, optional
        Called with (clips done, clips in all).

    Raises
    ------
    InputError
        If there is no dataset at `root`.
    """
    raise NotImplementedError
