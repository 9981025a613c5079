"""``scenegen repair``: bring a damaged dataset back to the bytes it had."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import asdict, dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import tyro

from scenegen.foundation.words import counted
from scenegen_cli.console import note, say, say_json
from scenegen_cli.parse import parse

if TYPE_CHECKING:
    from scenegen_datasets.repair.repair import Repaired

SHOWN = 20


@dataclass(frozen=True)
class Repair:
    """Verify a dataset and put right what is wrong: render broken or missing clips again, derive the rest anew.

    What is sound is not touched. Merged and sensed datasets need neither their parts nor their source. Exits with 1 if
    something is still wrong.
    """

    dataset: Annotated[Path, tyro.conf.Positional]
    """Directory of the dataset."""
    own_files: tuple[Path, ...] = ()
    """Scenes and recordings of your own, if they do not lie where recipe.yaml says; told by content."""
    jobs: int = 0
    """Processes; 0 is one per CPU."""
    json: bool = False
    """Report as JSON."""


def run(arguments: Sequence[str]) -> int:
    """Run the subcommand; returns the exit code."""
    command = parse(Repair, "repair", arguments)
    from scenegen_cli.making import processes
    from scenegen_cli.progress import Meter
    from scenegen_datasets.repair.repair import repair

    with Meter(quiet=command.json) as meter:
        workers = processes(command.jobs)
        done = repair(command.dataset, workers, meter.frames, meter.verified, command.own_files)
    if command.json:
        say_json({**asdict(done), "ok": done.after.ok})
    else:
        _tell(done)
    return 0 if done.after.ok else 1


def _tell(done: Repaired) -> None:
    if done.before.ok:
        healed = f"put right: {', '.join(done.healed)}" if done.healed else "nothing to repair"
        say(f"{healed}: {counted(done.after.clips, 'clip')}, {counted(done.after.frames, 'frame')} are sound")
        return
    for finding in done.before.findings[:SHOWN]:
        note(f"was: {finding}")
    if done.rewritten:
        note("recipe.yaml was lost: it holds the recipe with every default now, not what was asked")
    for clip, reason in done.failed:
        note(f"not repaired: {clip}: {reason}")
    if done.shared:
        note(
            f"{counted(len(done.shared), 'shard')} put right ({done.shared[0]}) had hard links, as `scenegen merge` "
            "makes them: the file of the other datasets is what it was; repair those, too"
        )
    for finding in done.after.findings[:SHOWN]:
        note(f"still: {finding}")
    state = "sound again" if done.after.ok else f"{counted(len(done.after.findings), 'finding')} left"
    made = f", {counted(len(done.remade), 'clip')} rendered again" if done.remade else ""
    say(f"{state}: {counted(len(done.before.findings), 'finding')} before{made}")
