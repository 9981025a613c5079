"""``scenegen verify``: check every byte, array and rule of a dataset."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import asdict, dataclass
from pathlib import Path
from typing import Annotated

import tyro

from scenegen_cli.console import say, say_json, size
from scenegen_cli.parse import HelpShown, parse

SHOWN = 20


@dataclass(frozen=True)
class Verify:
    """Check a dataset: hashes, decoding, digests of every array, invariants, index.

    Exits with 1 if anything is wrong.
    """

    dataset: Annotated[Path, tyro.conf.Positional]
    """Directory of the dataset."""
    quick: bool = False
    """Sizes and metadata only."""
    jobs: int = 0
    """Processes; 0 is one per CPU."""
    json: bool = False
    """Report as JSON."""


def run(arguments: Sequence[str]) -> int:
    """Run the subcommand; returns the exit code."""
    try:
        command = parse(Verify, "verify", arguments)
    except HelpShown:
        return 0
    from scenegen_cli.making import processes
    from scenegen_cli.progress import Meter
    from scenegen_datasets.verify import verify

    with Meter(quiet=command.json) as meter:
        report = verify(command.dataset, processes(command.jobs), command.quick, meter.verified)
    if command.json:
        say_json({**asdict(report), "ok": report.ok})
        return 0 if report.ok else 1
    for finding in report.findings[:SHOWN]:
        say(f"{finding.file}: {finding.reason}")
    if len(report.findings) > SHOWN:
        say(f"... and {len(report.findings) - SHOWN} more (--json lists all)")
    what = "ok" if report.ok else f"{len(report.findings)} findings"
    say(f"{what}: {report.clips:,} clips, {report.frames:,} frames, {size(report.bytes)}")
    return 0 if report.ok else 1
