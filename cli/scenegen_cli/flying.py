"""How far a campaign is: a bar in a terminal, a plain line now and then elsewhere."""

from __future__ import annotations

import sys
import time
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from typing import TYPE_CHECKING, Any

from scenegen_cli.console import note, span
from scenegen_cli.progress import PLAIN_EVERY_S

if TYPE_CHECKING:
    from scenegen_trainers.campaign.run import Progress

Told = Callable[["Progress"], None]


@contextmanager
def fly_meter(*, quiet: bool = False) -> Iterator[Told]:
    """Show the progress of a campaign on standard error while the block runs."""
    if quiet:
        yield lambda progress: None
    elif not sys.stderr.isatty():
        yield _plain()
    else:
        from scenegen_cli.bar import progress_bar

        with progress_bar() as bar:
            yield _shown(bar)


def _plain() -> Told:
    began = last = time.monotonic()

    def told(progress: Progress) -> None:
        nonlocal last
        now = time.monotonic()
        if now - last >= PLAIN_EVERY_S:
            last = now
            share = 100 * progress.flown / max(progress.flights, 1)
            note(f"flying  {share:3.0f} %  {_words(progress, now - began)}")

    return told


def _shown(bar: Any) -> Told:
    began = time.monotonic()
    task = bar.add_task("flying", total=1, rate="", what="")
    last = ""

    def told(progress: Progress) -> None:
        nonlocal last
        last = progress.what or last
        words = f"{_words(progress, time.monotonic() - began)}  {last}"
        bar.update(task, completed=progress.flown, total=progress.flights, what=words)

    return told


def _words(progress: Progress, seconds: float) -> str:
    """Flights, and what is left at the rate so far, once that means something."""
    words = f"flight {progress.flown:,}/{progress.flights:,}"
    if progress.here == 0:
        return words
    left = (progress.flights - progress.flown) * seconds / progress.here
    return f"{words}  {span(left)} left"
