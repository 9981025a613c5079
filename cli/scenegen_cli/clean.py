"""``scenegen clean``: remove from a dataset what is no part of it."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import asdict, dataclass
from pathlib import Path
from typing import Annotated

import tyro

from scenegen_cli.console import say, say_json
from scenegen_cli.parse import parse


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
            say(f"{printable(stray.path)}: {stray.reason.partition(';')[0]}")
    if not command.dry_run and found:
        found = clean(command.dataset).strays
    removed = bool(found) and not command.dry_run
    if command.json:
        strays = [{**asdict(stray), "path": printable(stray.path)} for stray in found]
        say_json({"strays": strays, "removed": removed})
        return 0
    what = "removed" if removed else "would be removed" if found else "nothing to remove"
    say(f"{len(found):,} {what}" if found else what)
    return 0
