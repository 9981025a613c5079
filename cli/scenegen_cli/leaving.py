"""How the command leaves when it is told to."""

from __future__ import annotations

from types import FrameType

INTERRUPTED, TERMINATED = 130, 143
"""Exit codes after SIGINT and SIGTERM."""


class HelpShown(Exception):  # noqa: N818 - not an error
    """Help was asked for and printed; there is nothing else to do."""


class TerminatedError(BaseException):
    """SIGTERM was received. Like KeyboardInterrupt, nothing but the front door catches it."""


def terminate(_signal: int, _frame: FrameType | None) -> None:
    """Signal handler."""
    raise TerminatedError
