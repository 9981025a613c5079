"""``scenegen merge``: join several datasets into one."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import asdict, dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import tyro

from scenegen.foundation.words import counted, size
from scenegen_cli.console import say, say_json
from scenegen_cli.leaving import resumable
from scenegen_cli.parse import parse

if TYPE_CHECKING:
    from scenegen_datasets.verify import VerifyReport
    from scenegen_datasets.versions.merge import Merged


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
    from scenegen_cli.proving import exit_code, facts, proven
    from scenegen_datasets.versions.merge import merge

    workers = processes(command.jobs)
    with (
        resumable("finished clips are kept", ["scenegen", "merge", *arguments]),
        Meter(quiet=command.json) as meter,
    ):
        merged = merge(command.out, command.parts, copy=command.copy, progress=meter.merged)
        report = None if command.no_verify else proven(command.out, workers, meter, new=merged.new)
    if command.json:
        whole = {
            "linked": merged.linked,
            "copied": merged.copied,
            "world_offsets": dict(merged.offsets),
        }
        say_json({**asdict(merged.info), **whole, **facts(report)})
    else:
        say("\n".join(_words(command.out, merged, report)))
    return exit_code(command.out, report, new=merged.new)


def _words(out: Path, merged: Merged, report: VerifyReport | None) -> Iterator[str]:
    from scenegen_cli.proving import in_words

    found = merged.info
    splits = ", ".join(f"{count:,} {name}" for name, count in found.splits.items() if count)
    yield f"{out}: {counted(found.pairs, 'pair')} ({splits}), {size(found.bytes)}{in_words(report)}"
    placed = f"{counted(merged.linked, 'shard')} linked, {merged.copied:,} copied"
    yield f"{placed if merged.new else 'it was there already'}; content {found.content_id[:16]}"
    for seed, offset in sorted(merged.offsets.items()):
        yield f"worlds of seed {seed} are numbered from {offset} on, for other seeds have worlds of the same names"
