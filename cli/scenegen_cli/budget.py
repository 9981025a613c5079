"""``scenegen budget``: what depth networks cost a drone's computer."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Annotated

import tyro

from scenegen.foundation.errors import InputError
from scenegen.foundation.words import counted
from scenegen_cli.console import note, say, say_json, table
from scenegen_cli.parse import parse, parse_size
from scenegen_cli.teaching import need_torch


@dataclass(frozen=True)
class Budget:
    """Measure weights, multiplications, milliseconds, and the metres a drone flies meanwhile.

    Takes checkpoints; without any, all models of a profile with the weights they start from.
    """

    checkpoints: Annotated[tuple[Path, ...], tyro.conf.Positional] = ()
    """model.pt of `scenegen train`, any number."""
    profile: str = "paper"
    """Size of the networks that are not given: ci, small, paper."""
    size: str = "256x256"
    """Frames WIDTHxHEIGHT of networks that are not given."""
    threads: tuple[int, ...] = (1,)
    """Threads of torch and onnxruntime; with several numbers, each is measured."""
    repeats: int = 20
    """Runs of each; the median counts."""
    markdown: bool = False
    """Print a Markdown table."""
    json: bool = False
    """Report as JSON."""


def run(arguments: Sequence[str]) -> int:
    """Run the subcommand; returns the exit code."""
    command = parse(Budget, "budget", arguments)
    if not command.threads or min(*command.threads, command.repeats) < 1:
        raise InputError("--threads and --repeats must be at least 1")
    width, height = parse_size(command.size)
    need_torch()
    from scenegen_trainers.deploy.budget import HEAD, NOTE, budget, row, untrained
    from scenegen_trainers.models.checkpoint import read_checkpoint
    from scenegen_trainers.training.recipe import MODELS

    networks = {str(path): read_checkpoint(path) for path in command.checkpoints} or {
        model: untrained(model, command.profile, width, height) for model in MODELS
    }
    entries = []
    for entry, _ in budget(networks, command.threads, command.repeats):
        entries.append(entry)
        if not command.json:
            note(f"{entry.model}, {counted(entry.cost.threads, 'thread')}")
    if command.json:
        say_json([entry.to_json() for entry in entries])
        return 0
    rows = [HEAD, *(row(entry) for entry in entries)]
    if command.markdown:
        rows.insert(1, ["---"] * len(HEAD))
        say("\n".join(f"| {' | '.join(cells)} |" for cells in rows))
    else:
        say(table(rows))
    note(NOTE)
    return 0
