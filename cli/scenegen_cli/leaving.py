"""How the command leaves when it is told to."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from contextlib import contextmanager
from types import FrameType

from scenegen_cli.console import note

INTERRUPTED, TERMINATED = 130, 143
"""Exit codes after SIGINT and SIGTERM."""


class HelpShown(Exception):  # noqa: N818 - not an error
    """Help was asked for and printed; there is nothing else to do."""


class TerminatedError(BaseException):
    """SIGTERM was received. Like KeyboardInterrupt, nothing but the front door catches it."""


@contextmanager
def resumable(kept: str, again: Sequence[str]) -> Iterator[None]:
    """Say how to go on if the block is interrupted.

    Parameters
    ----------
    kept : str
        What is not lost, such as "finished clips are kept".
    again : sequence of str
        The command that goes on.
    """
    try:
        yield
    except (KeyboardInterrupt, TerminatedError):
        import shlex

        note(f"interrupted; {kept}. Continue with: {shlex.join(again)}")
        raise


def terminate(_signal: int, _frame: FrameType | None) -> None:
    """Signal handler."""
    raise TerminatedError
