"""``scenegen verify``: check every byte, array and rule of a dataset."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import asdict, dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import tyro

from scenegen.foundation.errors import InputError
from scenegen.foundation.words import counted, size
from scenegen_cli.console import note, say, say_json
from scenegen_cli.parse import parse

if TYPE_CHECKING:
    from scenegen_datasets.verify.rerender import Rerendered

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
    rerender: int = 0
    """So many random frames are rendered again, from the lock alone, and compared."""
    seed: int = 0
    """Seed that draws those frames."""
    own_files: tuple[Path, ...] = ()
    """Scenes and recordings of your own, for --rerender, if they do not lie where recipe.yaml says."""
    jobs: int = 0
    """Processes; 0 is one per CPU."""
    json: bool = False
    """Report as JSON."""


def run(arguments: Sequence[str]) -> int:
    """Run the subcommand; returns the exit code."""
    command = parse(Verify, "verify", arguments)
    from scenegen_cli.making import processes
    from scenegen_cli.progress import Meter
    from scenegen_datasets.verify import verify

    if not 0 <= command.rerender <= 10**6 or command.seed < 0:
        raise InputError("--rerender takes 0 to 1,000,000 frames, and --seed nothing below 0")
    workers = processes(command.jobs)
    with Meter(quiet=command.json) as meter:
        report = verify(command.dataset, workers, command.quick, meter.verified)
        again = None
        if command.rerender and report.ok:
            from scenegen_datasets.verify.rerender import rerender

            again = rerender(
                command.dataset, command.rerender, workers, command.seed, meter.frames, command.own_files
            )
    findings = report.findings if again is None else again.findings
    if command.json:
        more = {"rerendered": None if again is None else asdict(again)} if command.rerender else {}
        say_json({**asdict(report), "ok": not findings, **more})
        return 1 if findings else 0
    for finding in findings[:SHOWN]:
        say(f"{finding.file}: {finding.reason}")
    if len(findings) > SHOWN:
        say(f"... and {len(findings) - SHOWN} more (--json lists all)")
    what = counted(len(findings), "finding") if findings else "ok"
    looked_at = f"{counted(report.clips, 'clip')}, {counted(report.frames, 'frame')}, {size(report.bytes)}"
    say(f"{what}: {looked_at}{_again(again)}")
    if command.rerender and again is None:
        note("nothing was rendered again, because of what was found; `scenegen repair` puts it right")
    return 1 if findings else 0


def _again(again: Rerendered | None) -> str:
    if again is None:
        return ""
    software = "the same software" if again.same_software else "other software"
    return f"; {len(again.frames)} frames rendered again by {software}, {again.identical} of them identical"
