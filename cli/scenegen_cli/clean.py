"""``scenegen clean``: remove from a dataset what is no part of it."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import tyro

from scenegen_cli.console import say, say_json
from scenegen_cli.parse import parse

if TYPE_CHECKING:
    from scenegen_datasets.verify.strays import Stray


@dataclass(frozen=True)
class Clean:
    """Remove leftovers of killed jobs, strange files and links from a dataset; lists them first.

    Links are removed, never followed; hidden files at the top and pictures below preview/ stay.
    """

    dataset: Annotated[Path, tyro.conf.Positional]
    """Directory of the dataset."""
    dry_run: bool = False
    """List, and stop."""
    json: bool = False
    """Report as JSON."""


def run(arguments: Sequence[str]) -> int:
    """Run the subcommand; returns the exit code."""
    command = parse(Clean, "clean", arguments)
    from scenegen.foundation.printable import printable
    from scenegen_datasets.repair.clean import clean

    found = clean(command.dataset, dry_run=True).strays
    if not command.json:
        for stray in found:
            say(f"{printable(stray.path)}: {_why(stray)}")
    if not command.dry_run and found:
        found = clean(command.dataset).strays
    removed = bool(found) and not command.dry_run
    if command.json:
        strays = [{"path": printable(stray.path), "reason": _why(stray)} for stray in found]
        say_json({"strays": strays, "removed": removed})
        return 0
    what = "removed" if removed else "would be removed" if found else "nothing to remove"
    say(f"{len(found):,} {what}" if found else what)
    return 0


def _why(stray: Stray) -> str:
    """Without what `verify` says besides: that this command removes it."""
    return stray.reason.partition(";")[0]
