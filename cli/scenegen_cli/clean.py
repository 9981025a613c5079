"""``scenegen clean``: remove from a dataset what is no part of it."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import tyro

from scenegen.foundation.printable import printable
from scenegen_cli.console import note, say, say_json
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
    from scenegen_cli.status import writer_of
    from scenegen_datasets.repair.clean import clean

    told = _silent if command.json else _tell
    found = clean(command.dataset, dry_run=True).strays
    if command.dry_run:
        told(found)
        if found and (writer := writer_of(command.dataset)):
            note(f"{writer} writes to it: what that works at is listed, too")
    elif found:
        found = clean(command.dataset, told=told).strays
    removed = bool(found) and not command.dry_run
    if command.json:
        say_json({"strays": [_plain(stray) for stray in found], "removed": removed})
        return 0
    what = "removed" if removed else "would be removed" if found else "nothing to remove"
    say(f"{len(found):,} {what}" if found else what)
    return 0


def _plain(stray: Stray) -> dict[str, str]:
    """Path and reason, without what `verify` says besides: that this command removes it."""
    return {"path": printable(stray.path), "reason": stray.reason.partition(";")[0]}


def _tell(strays: Sequence[Stray]) -> None:
    for plain in map(_plain, strays):
        say(f"{plain['path']}: {plain['reason']}")


def _silent(_: Sequence[Stray]) -> None:
    pass
