"""``scenegen report``: a dataset on one page."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Annotated

import tyro

from scenegen.foundation.words import size
from scenegen_cli.audit import say_verdicts
from scenegen_cli.console import say, say_json
from scenegen_cli.parse import parse


@dataclass(frozen=True)
class Report:
    """Write one self-contained HTML page about a dataset: pictures, flights, audits, provenance, cost.

    Exits with 1 if an audit found a fault; the page is written all the same.
    """

    dataset: Annotated[Path, tyro.conf.Positional]
    """Directory of the dataset, finished or growing."""
    out: Path | None = None
    """The file; by default preview/report.html in the dataset."""
    json: bool = False
    """Path, size and all figures of the audits as JSON."""


def run(arguments: Sequence[str]) -> int:
    """Run the subcommand; returns the exit code."""
    command = parse(Report, "report", arguments)
    from scenegen_cli.progress import Meter
    from scenegen_datasets.audits.run import as_json
    from scenegen_datasets.report.page import write_report

    with Meter(quiet=command.json) as meter:
        report = write_report(command.dataset, command.out, meter.audited)
    if command.json:
        say_json({"path": str(report.path), "bytes": report.bytes, "audits": as_json(report.audits)})
    else:
        say_verdicts(report.audits)
        say(f"{report.path} ({size(report.bytes)})")
    return 0 if report.audits.ok else 1
