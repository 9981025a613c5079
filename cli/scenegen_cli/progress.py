"""How far a job is: a bar in a terminal, a plain line now and then elsewhere."""

from __future__ import annotations

import sys
import time
from types import TracebackType
from typing import Any

from scenegen.foundation.words import size
from scenegen_cli.console import note, span
from scenegen_datasets.run import Progress

PLAIN_EVERY_S = 15.0


class Meter:
    """Shows the progress of a job on standard error.

    Parameters
    ----------
    quiet : bool
        Show nothing at all.
    """

    def __init__(self, *, quiet: bool = False) -> None:
        self._quiet = quiet
        self._bar: Any = None
        self._task: Any = None
        self._began = self._shown = time.monotonic()
        self._what = ""

    def __enter__(self) -> Meter:
        if not self._quiet and sys.stderr.isatty():
            from scenegen_cli.bar import progress_bar

            self._bar = progress_bar()
            self._bar.start()
        return self

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None:
        if self._bar is not None:
            self._bar.stop()

    def frames(self, progress: Progress) -> None:
        """Frames were rendered, or something happened."""
        if progress.what:
            self._what = progress.what
        clips = f"clip {progress.clips_done}/{progress.clips}"
        self._show("rendering", progress.frames_done, progress.frames, f"{clips}  {self._what}".rstrip())

    def verified(self, done: int, total: int) -> None:
        """Clips were verified."""
        if self._bar is not None and done == 1:
            self._bar.remove_task(self._task) if self._task is not None else None
            self._task = None
        self._show("verifying", done, total, f"clip {done}/{total}")

    def audited(self, done: int, total: int) -> None:
        """Steps were audited."""
        self._show("auditing", done, total, f"step {done}/{total}")

    def sensed(self, done: int, total: int) -> None:
        """Clips were sensed again."""
        self._show("sensing", done, total, f"clip {done}/{total}")

    def merged(self, done: int, total: int) -> None:
        """Clips were linked or copied."""
        self._show("merging", done, total, f"clip {done}/{total}")

    def exported(self, done: int, total: int) -> None:
        """Clips were exported."""
        self._show("exporting", done, total, f"clip {done}/{total}")

    def pushed(self, done: int, total: int) -> None:
        """Bytes were sent."""
        self._show("pushing", done, total, f"{size(done)} of {size(total)}")

    def _show(self, doing: str, done: int, total: int, what: str) -> None:
        now = time.monotonic()
        if self._quiet or total == 0:
            return
        rate = self._rate(done, total, now - self._began) if doing == "rendering" else ""
        if self._bar is not None:
            if self._task is None:
                self._task = self._bar.add_task(doing, total=total, rate="", what="")
            self._bar.update(self._task, completed=done, total=total, rate=rate, what=what)
        elif now - self._shown >= PLAIN_EVERY_S:
            self._shown = now
            note(f"{doing}  {100 * done / total:3.0f} %  {rate}  {what}")

    @staticmethod
    def _rate(done: int, total: int, seconds: float) -> str:
        """Rate over the whole run, worlds included, and what is left at that rate, once that means something."""
        if done < 0.1 * total or seconds <= 0.0:
            return ""
        rate = done / seconds
        return f"{rate:.{1 if rate >= 1.0 else 2}f} frames/s  {span((total - done) / rate)} left"
