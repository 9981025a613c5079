"""``scenegen evaluate``: judge a trained network on a split of a dataset."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Annotated, Literal

import tyro

from scenegen.foundation.errors import InputError
from scenegen_cli.console import note, say, say_json, table
from scenegen_cli.parse import parse
from scenegen_cli.teaching import Steps, need_torch


@dataclass(frozen=True)
class Evaluate:
    """Judge a network: scores with intervals, by distance, map, hour and class, beside trivial answers."""

    checkpoint: Annotated[Path, tyro.conf.Positional]
    """model.pt of `scenegen train`."""
    dataset: Annotated[Path, tyro.conf.Positional]
    """Directory of a finished dataset, of the camera the network was trained on."""
    split: Literal["train", "val", "test"] = "test"
    """Which part of the dataset it is judged on."""
    pairs: int = 0
    """Pairs it is judged on, evenly spread; 0 takes all."""
    out: Path | None = None
    """Directory of the report and the pictures; by default evaluation-SPLIT beside the checkpoint."""
    accelerator: Literal["cpu", "gpu"] = "cpu"
    """Where it runs."""
    threads: int = 1
    """Threads of the CPU."""
    json: bool = False
    """Report as JSON."""


def run(arguments: Sequence[str]) -> int:
    """Run the subcommand; returns the exit code."""
    command = parse(Evaluate, "evaluate", arguments)
    need_torch()
    from scenegen_datasets.place import make_directory
    from scenegen_trainers.evaluation.evaluate import evaluate
    from scenegen_trainers.evaluation.report import as_json, write_report
    from scenegen_trainers.evaluation.words import ANSWERS_HEAD, answer_rows
    from scenegen_trainers.models.checkpoint import read_checkpoint
    from scenegen_trainers.training.machine import Machine
    from scenegen_trainers.training.source import TrainingData

    if command.pairs < 0:
        raise InputError(f"--pairs {command.pairs}: so many, or 0 for all")
    machine = Machine(command.accelerator, threads=command.threads)
    machine.settle()
    device = machine.device()
    checkpoint, data = read_checkpoint(command.checkpoint), TrainingData.at(command.dataset)
    out = command.out or command.checkpoint.parent / f"evaluation-{command.split}"
    make_directory(out)
    found = evaluate(
        checkpoint,
        data,
        command.split,
        command.pairs,
        device=device,
        watch=Steps("judged", quiet=command.json),
    )
    paths = write_report(found, checkpoint, data, out)
    if command.json:
        say_json(as_json(found))
        return 0
    say(table([ANSWERS_HEAD, *answer_rows(found, briefly=True)]))
    for path in paths:
        note(str(path))
    return 0
