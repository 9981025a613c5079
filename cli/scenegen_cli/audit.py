"""``scenegen audit``: what a dataset is like, measured."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import tyro

from scenegen_cli.console import say, say_json
from scenegen_cli.parse import parse

if TYPE_CHECKING:
    from scenegen_datasets.audits.run import Audits


@dataclass(frozen=True)
class Audit:
    """Measure what a dataset is like: draws against recipe, depth leak, label consistency, edges, quality of flow.

    Looks at a bounded sample, always the same one. Exits with 1 if anything is at fault.
    """

    dataset: Annotated[Path, tyro.conf.Positional]
    """Directory of the dataset, finished or growing."""
    json: bool = False
    """All figures as JSON."""


def run(arguments: Sequence[str]) -> int:
    """Run the subcommand; returns the exit code."""
    command = parse(Audit, "audit", arguments)
    from scenegen_cli.progress import Meter
    from scenegen_datasets.audits.run import as_json, audit
    from scenegen_datasets.source import open_source

    with Meter(quiet=command.json) as meter:
        audits = audit(command.dataset, open_source(command.dataset, True), meter.audited)
    if command.json:
        say_json(as_json(audits))
    else:
        say_verdicts(audits)
    return 0 if audits.ok else 1


def say_verdicts(audits: Audits) -> None:
    """Print question, answer and reasons of every audit."""
    from scenegen_datasets.audits.run import QUESTIONS

    for name, verdict in audits.verdicts.items():
        say(f"{verdict.level:<7}  {QUESTIONS[name]} {verdict.headline}")
        if verdict.words:
            say(f"         {verdict.words}")
