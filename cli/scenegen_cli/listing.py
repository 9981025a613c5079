"""What the listing commands share."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from typing import Any

from scenegen_cli.console import say, say_json, table
from scenegen_cli.parse import parse


@dataclass(frozen=True)
class Listing:
    """What a listing command takes; each says in a docstring of its own what it lists."""

    json: bool = False
    """Report as JSON."""


def show(
    kind: type[Listing],
    name: str,
    arguments: Sequence[str],
    rows: Callable[[], Sequence[Mapping[str, Any]]],
    columns: Sequence[str],
) -> int:
    """Print rows as a table of some columns, or all of them as JSON; returns the exit code."""
    command = parse(kind, name, arguments)
    found = rows()
    if command.json:
        say_json([dict(row) for row in found])
        return 0
    say(table([columns, *([_text(row[column]) for column in columns] for row in found)]))
    return 0


def _text(value: Any) -> str:
    return f"{value:g}" if isinstance(value, float) else str(value)
