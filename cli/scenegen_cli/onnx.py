"""``scenegen onnx``: export a trained network as an ONNX graph and measure what it costs."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Annotated

import tyro

from scenegen.foundation.atomic import write_atomic
from scenegen.foundation.errors import InputError
from scenegen_cli.console import note, say, say_json, table
from scenegen_cli.parse import parse
from scenegen_cli.teaching import need_torch


@dataclass(frozen=True)
class Onnx:
    """Export networks as ONNX graphs, and print what each costs a drone's computer."""

    checkpoints: Annotated[tuple[Path, ...], tyro.conf.Positional]
    """One model.pt of `scenegen train`, or several; each graph is written beside its checkpoint."""
    threads: int = 1
    """Threads of torch and onnxruntime."""
    repeats: int = 20
    """Runs of each; the median counts."""
    json: bool = False
    """Report as JSON."""


def run(arguments: Sequence[str]) -> int:
    """Run the subcommand; returns the exit code."""
    command = parse(Onnx, "onnx", arguments)
    if not command.checkpoints or command.threads < 1 or command.repeats < 1:
        raise InputError("name at least one checkpoint, one thread and one repeat")
    need_torch()
    from scenegen_trainers.deploy.budget import HEAD, NOTE, budget, row
    from scenegen_trainers.models.checkpoint import read_checkpoint

    found = []
    read = [(path, read_checkpoint(path)) for path in command.checkpoints]  # whatever is wrong is said first
    for path, checkpoint in read:
        name = str(checkpoint.record.get("model", path.stem))
        ((entry, graph),) = budget({name: checkpoint}, (command.threads,), command.repeats)
        out = path.with_suffix(".onnx")
        write_atomic(out, graph)
        found.append((path, out, entry))
    if command.json:
        say_json(
            [{"checkpoint": str(path), "graph": str(out), **entry.to_json()} for path, out, entry in found]
        )
        return 0
    say(table([HEAD, *(row(entry) for _, _, entry in found)]))
    for _, out, entry in found:
        note(
            f"{out}{'' if entry.cost.from_counts else '  takes the embedded image: flow is computed outside'}"
        )
    note(NOTE)
    return 0
