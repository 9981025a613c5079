"""``scenegen train``: teach a depth network on a dataset, or go on where a killed training stopped."""

from __future__ import annotations

from collections.abc import Sequence
from contextlib import nullcontext
from dataclasses import dataclass
from pathlib import Path
from typing import Literal

from scenegen.foundation.errors import InputError
from scenegen_cli.asking import sources
from scenegen_cli.console import note, say, say_json
from scenegen_cli.leaving import resumable
from scenegen_cli.parse import parse
from scenegen_cli.teaching import Steps, need_torch, recipe_help, training_flags


@dataclass(frozen=True)
class Train:
    """Teach a depth network. Run again to resume a training where it stopped.

    Writes model.pt, which `scenegen evaluate` judges and `scenegen fly --pilot` flies.
    """

    data: Path | None = None
    """Directory of a finished dataset. Must be given."""
    model: str = "pix2pix-flow"
    """pix2pix (the paper's conventional method), pix2pix-flow (its proposed one), fastdepth or litemono."""
    profile: str = "ci"
    """Size of the training: ci (a minute of a core), small (three to ten), paper (a GPU)."""
    seed: int = 0
    """Seed of initial weights, order of samples, mirroring and dropout."""
    out: Path | None = None
    """Directory of the training; by default MODEL-seedSEED here."""
    recipe: Path | None = None
    """YAML file of recipe keys; flags win over it."""
    accelerator: Literal["cpu", "gpu", "auto"] = "cpu"
    """Where it runs."""
    devices: int = 1
    """How many CPUs or GPUs; they share every batch."""
    precision: Literal["32-true", "bf16-mixed", "16-mixed"] = "32-true"
    """Numbers it computes with."""
    threads: int = 1
    """Threads of the CPU; part of the result's last digit, hence not taken from the machine."""
    tensorboard: bool = False
    """Log for TensorBoard besides log.csv."""
    dry_run: bool = False
    """Print the recipe, and stop."""
    json: bool = False
    """Report as JSON."""


def run(arguments: Sequence[str]) -> int:
    """Run the subcommand; returns the exit code."""
    own, flags = training_flags(arguments)
    command = parse(Train, "train", own, recipe_help())
    from scenegen_trainers.training.recipe import resolve_training

    seeded = {**flags, "seed": command.seed}
    recipe = resolve_training(command.model, command.profile, sources(command.recipe, seeded))
    if command.dry_run:
        say_json(recipe.deciding())
        return 0
    if command.data is None:
        raise InputError("--data is missing: name the directory of a dataset that `scenegen render` made")
    need_torch()
    from scenegen_trainers.training.loop import train
    from scenegen_trainers.training.machine import Machine, is_first_process
    from scenegen_trainers.training.source import TrainingData

    machine = Machine(
        command.accelerator, command.devices, command.precision, command.threads, command.tensorboard
    )
    out = command.out or Path(f"{command.model}-seed{command.seed}")
    speaks = is_first_process()
    steps = Steps(command.model, quiet=command.json or not speaks)
    again = resumable("what was learned up to the last state.pt is kept", ["scenegen", "train", *arguments])
    with again if speaks else nullcontext():
        model = train(
            recipe, TrainingData.at(command.data), out, machine, lambda t: steps(t.step, t.steps, t.losses)
        )
    if not speaks:
        return 0
    if command.json:
        say_json({"model": str(model), "log": str(out / "log.csv")})
        return 0
    say(str(model))
    note(f"next: scenegen evaluate {model} {command.data}")
    return 0
