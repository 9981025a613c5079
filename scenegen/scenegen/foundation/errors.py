"""Errors a user can act on. Each derives from a builtin and from one family, so that callers may catch either.

A message says what is wrong, where, and what to do next, in one short line. Programming errors stay `AssertionError`,
`TypeError` and the like, with their tracebacks.
"""

from __future__ import annotations

import difflib
from collections.abc import Iterable


class ScenegenError(Exception):
    """Base of every error that is shown to a user as one line, without a traceback.

    Attributes
    ----------
    exit_code : int
        What the command exits with: 1 a check failed, 2 bad input, 4 no space left.
    """

    exit_code = 2


class InputError(ScenegenError, ValueError):
    """Something the user asked for cannot be done as written."""


class DatasetError(ScenegenError, RuntimeError):
    """A dataset on disk is not what it should be."""

    exit_code = 1


class CorruptFrameError(DatasetError):
    """A stored frame does not decode to what its receipt says."""


class BackendError(ScenegenError, RuntimeError):
    """The renderer cannot run on this machine as it is set up."""


class NoSpaceError(ScenegenError, OSError):
    """The output device is full."""

    exit_code = 4


class RejectedDrawError(ScenegenError, RuntimeError):
    """A random draw failed too often; the recipe asks for something this world does not offer."""

    exit_code = 1


def nearest(word: str, known: Iterable[str]) -> str:
    """Return ``"; perhaps you meant 'x'"`` for the closest known word, or the list of what is known.

    Parameters
    ----------
    word : str
        What the user wrote.
    known : iterable of str
        What would have been right.
    """
    options = sorted(known)
    close = difflib.get_close_matches(word, options, n=1, cutoff=0.6)
    return f"; perhaps you meant '{close[0]}'" if close else f"; known: {', '.join(options)}"
