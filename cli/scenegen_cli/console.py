"""What people read: results on standard output, everything else on standard error.

Datasets come from strangers, and so do the names in them: nothing reaches a terminal that could control it.
"""

from __future__ import annotations

import json
import sys
from collections.abc import Iterable, Sequence
from typing import Any, TextIO

from scenegen.foundation.printable import printable_json, printable_lines


def say(text: str) -> None:
    """Print a result."""
    _write(sys.stdout, printable_lines(text))


def note(text: str) -> None:
    """Print something on the way."""
    _write(sys.stderr, printable_lines(text))


def complain(text: str) -> None:
    """Print an error: one line."""
    note(f"scenegen: {text}")


def say_json(value: Any) -> None:
    """Print a result for machines: one JSON document."""
    _write(sys.stdout, printable_json(json.dumps(value, indent=2, sort_keys=True, ensure_ascii=False)))


def table(rows: Iterable[Sequence[str]]) -> str:
    """Left-aligned columns, two blanks apart."""
    lines = [list(row) for row in rows]
    widths = [max(len(line[k]) for line in lines) for k in range(len(lines[0]))] if lines else []
    return "\n".join(
        "  ".join(c.ljust(w) for c, w in zip(line, widths, strict=True)).rstrip() for line in lines
    )


def span(seconds: float) -> str:
    """Seconds as 12 s, 3:07 or 1:02:33."""
    whole = max(round(seconds), 0)
    if whole < 60:
        return f"{whole} s"
    hours, rest = divmod(whole, 3600)
    return f"{hours}:{rest // 60:02d}:{rest % 60:02d}" if hours else f"{rest // 60}:{rest % 60:02d}"


def _write(stream: TextIO, text: str) -> None:
    stream.write(f"{text}\n")
    stream.flush()
