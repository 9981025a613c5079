"""``scenegen table1``: the paper's Table 1 on a dataset, from nothing to a page."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any, Literal

from scenegen.foundation.errors import InputError
from scenegen_cli.asking import sources
from scenegen_cli.console import note, say, say_json
from scenegen_cli.leaving import resumable
from scenegen_cli.parse import parse
from scenegen_cli.teaching import need_torch, recipe_help, training_flags


@dataclass(frozen=True)
class Table1:
    """Train and judge the five rows of the paper's Table 1, several seeds each. Run again to resume.

    The conventional method at w_L1 = 100, the proposed one at 0, 100, 200 and 300; mean and spread over seeds, the
    paper's figures beside, and which of its order relations hold.
    """

    data: Path | None = None
    """Directory of a finished dataset. Must be given."""
    profile: str = "ci"
    """Size of the trainings: ci (15 minutes for all on two cores), small (half an hour), paper (a GPU)."""
    seeds: int = 3
    """How many seeds, from --first-seed on."""
    first_seed: int = 0
    """Smallest seed."""
    split: Literal["val", "test"] = "test"
    """Which part of the dataset the rows are judged on."""
    out: Path | None = None
    """Directory of runs and pages; by default table1-PROFILE here."""
    recipe: Path | None = None
    """YAML file of recipe keys for all rows; flags win over it."""
    jobs: int = 0
    """Trainings side by side, one thread each; 0 is one per CPU, or one on a GPU."""
    accelerator: Literal["cpu", "gpu"] = "cpu"
    """Where it runs."""
    precision: Literal["32-true", "bf16-mixed", "16-mixed"] = "32-true"
    """Numbers they compute with."""
    json: bool = False
    """Report as JSON."""


def run(arguments: Sequence[str]) -> int:
    """Run the subcommand; returns the exit code."""
    own, flags = training_flags(arguments)
    command = parse(Table1, "table1", own, recipe_help())
    if command.data is None:
        raise InputError("--data is missing: name the directory of a dataset that `scenegen render` made")
    if command.seeds < 1 or command.first_seed < 0:
        raise InputError("--seeds must be at least 1, --first-seed at least 0")
    need_torch()
    from scenegen_cli.making import processes
    from scenegen_datasets.resolve import merge
    from scenegen_trainers.tables.table1 import Table1Job, run_table1
    from scenegen_trainers.tables.table1_page import as_json, write_table1

    asked: dict[str, Any] = merge(source.values for source in sources(command.recipe, flags))
    job = Table1Job(
        data=command.data,
        out=command.out or Path(f"table1-{command.profile}"),
        profile=command.profile,
        seeds=tuple(range(command.first_seed, command.first_seed + command.seeds)),
        asked=asked,
        split=command.split,
        processes=1 if command.accelerator == "gpu" and not command.jobs else processes(command.jobs),
        accelerator=command.accelerator,
        precision=command.precision,
    )
    with resumable("what is finished is kept", ["scenegen", "table1", *arguments]):
        result = run_table1(job, lambda name, said: None if command.json else note(f"{name}  {said}"))
    paths = write_table1(result, job.out)
    if command.json:
        say_json(as_json(result))
        return 0
    for path in paths:
        say(str(path))
    return 0
