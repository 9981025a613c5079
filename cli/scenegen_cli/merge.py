"""``scenegen merge``: join several datasets into one."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import asdict, dataclass
from pathlib import Path
from typing import Annotated

import tyro

from scenegen.foundation.words import counted
from scenegen_cli.console import note, say, say_json, size
from scenegen_cli.parse import parse


@dataclass(frozen=True)
class Merge:
    """Join datasets into a new one, with their splits and one index; the parts stay as they are.

    They must agree on layers, image size, band, camera and conventions, and no world may be in two of them. Where two
    seeds have worlds of one name, these get new numbers.
    """

    out: Annotated[Path, tyro.conf.Positional]
    """Directory of the new dataset."""
    parts: Annotated[tuple[Path, ...], tyro.conf.Positional]
    """Directories of two or more finished datasets."""
    copy: bool = False
    """Copy shards; by default they are hard links, which take no space."""
    no_verify: bool = False
    """Do not verify the whole at the end."""
    jobs: int = 0
    """Processes that verify; 0 is one per CPU."""
    json: bool = False
    """Report as JSON."""


def run(arguments: Sequence[str]) -> int:
    """Run the subcommand; returns the exit code."""
    command = parse(Merge, "merge", arguments)
    from scenegen_cli.making import processes
    from scenegen_cli.progress import Meter
    from scenegen_datasets.verify import verify
    from scenegen_datasets.versions.merge import merge

    workers = processes(command.jobs)
    merged = merge(command.out, command.parts, copy=command.copy)
    found = merged.info
    with Meter(quiet=command.json) as meter:
        report = None if command.no_verify else verify(command.out, workers, progress=meter.verified)
    if command.json:
        findings = [] if report is None else [asdict(finding) for finding in report.findings]
        facts = {
            "linked": merged.linked,
            "copied": merged.copied,
            "world_offsets": dict(merged.offsets),
            "findings": findings,
        }
        say_json({**asdict(found), **facts, "verified": None if report is None else report.ok})
    else:
        splits = ", ".join(f"{count:,} {name}" for name, count in found.splits.items() if count)
        checked = (
            ""
            if report is None
            else ", verified"
            if report.ok
            else f", {counted(len(report.findings), 'finding')}"
        )
        say(f"{command.out}: {counted(found.pairs, 'pair')} ({splits}), {size(found.bytes)}{checked}")
        say(
            f"{counted(merged.linked, 'shard')} linked, {merged.copied:,} copied; content {found.content_id[:16]}"
        )
        for seed, offset in sorted(merged.offsets.items()):
            say(
                f"worlds of seed {seed} are numbered from {offset} on, for other seeds have worlds of the same names"
            )
    if report is not None and not report.ok:
        note(f"verify found: {report.findings[0]}")
        return 1
    return 0
