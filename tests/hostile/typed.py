"""A command as a user types it, and a look at what it prints."""

from __future__ import annotations

import contextlib
import importlib
import io
from pathlib import Path

from hostile.documents import MARK
from scenegen.foundation.errors import ScenegenError
from scenegen_cli.console import complain

MOST_LETTERS = 2_000_000
"""No reader has more to say about a few clips."""


class SaidError(Exception):
    """A command printed, or wrote into a page, what no terminal or browser should get."""


def typed(*words: str) -> int:
    """Run a subcommand in this process; returns its exit code.

    Raises
    ------
    ScenegenError
        If it refuses.
    SaidError
        If it prints what no terminal should get, its refusal included.
    """
    said = io.StringIO()
    with contextlib.redirect_stdout(said), contextlib.redirect_stderr(said):
        try:
            code: int = importlib.import_module(f"scenegen_cli.{words[0]}").run(list(words[1:]))
        except ScenegenError as error:
            complain(" ".join(str(error).split()))  # as the command line does
            raise
        finally:
            check_said(said.getvalue())
    return code


def check_said(text: str) -> None:
    """Refuse text that controls a terminal, turns the direction of writing, or goes on for ever."""
    odd = next((c for c in text if c != "\n" and not c.isprintable()), None)
    if odd is not None:
        line = next(line for line in text.split("\n") if odd in line)
        raise SaidError(f"prints {odd!r}: {line[:120]!a}")
    if len(text) > MOST_LETTERS:
        raise SaidError(f"prints {len(text):,} letters")


def check_pages(*pages: Path) -> None:
    """Refuse pages and cards, those that are there, that hold markup of the dataset."""
    for page in pages:
        if page.is_file() and not page.is_symlink() and MARK in page.read_text("utf-8", "replace"):
            raise SaidError(f"{page.name} holds markup of the dataset")
