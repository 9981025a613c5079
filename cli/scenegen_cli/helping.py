"""What ``--help`` prints: a command's arguments and flags and the keys of a recipe, laid out alike for all commands."""

from __future__ import annotations

import inspect
import shutil
import textwrap
from collections.abc import Callable, Iterable, Sequence
from typing import Any

from scenegen_cli.parameters import Parameter, in_words, parameters

_NARROWEST, _WIDEST = 60, 110
_LONGEST_LABEL = 26
_LONGEST_UNBROKEN, _NO_BREAK = 24, "\N{NO-BREAK SPACE}"
_OWN_HELP = Parameter("-h, --help", "Show this, and stop.", "", False, False, False)


def command_help(command: type, name: str) -> str:
    """Usage, meaning, arguments and flags of a command.

    Parameters
    ----------
    command : type
        Frozen dataclass; the docstrings under its fields say what they mean.
    name : str
        Of the subcommand.
    """
    takes = parameters(command)
    arguments = [one for one in takes if one.positional]
    flags = [*(one for one in takes if not one.positional), _OWN_HELP]
    blocks = [" ".join(["usage: scenegen", name, *(one.label for one in arguments), "[flags]"])]
    blocks += [textwrap.fill(part, _width()) for part in (inspect.getdoc(command) or "").split("\n\n")]
    if arguments:
        blocks.append(_columns(arguments))
    blocks.append("flags:\n" + _columns(flags))
    return "\n\n".join(blocks)


def keys_help(
    title: str, keys: Iterable[tuple[str, str, Any]], unset: Callable[[str], str] = lambda key: "none"
) -> str:
    """Recipe keys below a title, a blank line between sections.

    Parameters
    ----------
    title : str
    keys : iterable of (str, str, Any)
        Dotted name, meaning and default, as `scenegen_datasets.resolve.leaves` gives them.
    unset : callable
        What stands for the default of a key that has none.
    """
    lines = textwrap.wrap(title, _width())
    last = None
    for key, meaning, default in keys:
        section = key.partition(".")[0] if "." in key else ""
        lines += [""] if last not in (None, section) else []
        last = section
        said = f"--{key.replace('_', '-')}  {_with_default(meaning, in_words(default) or unset(key))}"
        lines += _wrap(said, "  ", "      ")
    return "\n".join(lines)


def _columns(rows: Sequence[Parameter]) -> str:
    """Labels left, meanings right; a long label has a line to itself."""
    indent = " " * (4 + min(max(len(row.label) for row in rows), _LONGEST_LABEL))
    lines = []
    for row in rows:
        head = f"  {row.label}".ljust(len(indent))
        if len(row.label) > _LONGEST_LABEL:
            lines.append(head)
            head = indent
        lines += _wrap(_with_default(row.meaning, row.default), head, indent)
    return "\n".join(lines)


def _with_default(meaning: str, default: str) -> str:
    """The meaning, and the default in brackets, which stay on one line if they are short."""
    whole = default.replace(" ", _NO_BREAK) if len(default) <= _LONGEST_UNBROKEN else default
    return f"{meaning} ({whole})" if default else meaning


def _wrap(text: str, first: str, then: str) -> list[str]:
    """Lines that begin with `first`, then with `then`; flags are not cut at their hyphens."""
    lines = textwrap.wrap(
        text, _width(), initial_indent=first, subsequent_indent=then, break_on_hyphens=False
    )
    return [line.replace(_NO_BREAK, " ") for line in lines]


def _width() -> int:
    """Columns to fill: the terminal's, as far as lines of that length can be read."""
    return min(max(shutil.get_terminal_size().columns - 1, _NARROWEST), _WIDEST)
