"""``scenegen table2``: the paper's Table 2, from two checkpoints or from a dataset, to a page."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Any

from scenegen.foundation.errors import InputError, nearest
from scenegen_cli.asking import sources
from scenegen_cli.console import note, say, say_json
from scenegen_cli.leaving import resumable
from scenegen_cli.making import processes
from scenegen_cli.parse import parse, split_recipe_flags
from scenegen_cli.teaching import need_torch
from scenegen_datasets.recipe import Recipe
from scenegen_datasets.resolve import Source, leaves, merge

if TYPE_CHECKING:
    from scenegen_trainers.campaign.recipe import FlightRecipe
    from scenegen_trainers.tables.entrants import Entrant
    from scenegen_trainers.tables.table2 import Table2Job
    from scenegen_trainers.training.source import TrainingData

_SCHOOL = ("network", "inputs", "target", "training", "pix2pix")
"""Sections of a training's recipe; all others are the flights'."""

PUT_ASIDE = 3
"""Exit code of a table that lacks some flights."""


@dataclass(frozen=True)
class Table2:
    """Fly the paper's Table 2: conventional against proposed, w_L1 = 300, on the same missions. Run again to resume.

    Give two checkpoints, or --data alone: then both are trained on it first. Oracle and blind fly along as bounds;
    other networks with --also.
    Takes recipe keys as flags, such as --map, --seed, --mission.distance-m, --loop.latency measured.
    """

    conventional: Path | None = None
    """Checkpoint of `scenegen train --model pix2pix`."""
    proposed: Path | None = None
    """Checkpoint of `scenegen train --model pix2pix-flow --pix2pix.w-l1 300`."""
    also: tuple[str, ...] = ()
    """Other checkpoints that fly along, each held against both methods: PATH or NAME=PATH."""
    data: Path | None = None
    """Finished dataset: its test worlds are flown, and without checkpoints the networks learn from it."""
    profile: str = "ci"
    """Size: ci (6 flights a map), small (100), paper (400); that of the trainings, too."""
    flights: int = 0
    """Flights a map; 0 takes the profile's. Raise it to fly more."""
    planner: str = "waypoint"
    """Turns depth into velocities: waypoint, five_section, straight, or module:attribute."""
    training_seed: int = 0
    """Seed of the trainings; --seed is that of the worlds."""
    out: Path | None = None
    """Directory of runs, flights and pages; by default table2-PROFILE here."""
    recipe: Path | None = None
    """YAML file of recipe keys; flags win over it."""
    size: str | None = None
    """Image size WIDTHxHEIGHT; by default the checkpoints' or the dataset's."""
    jobs: int = 0
    """Processes; 0 is one per CPU."""
    allow_mixed: bool = False
    """Go on with flights that other software versions began."""
    json: bool = False
    """Report as JSON."""


def run(arguments: Sequence[str]) -> int:
    """Run the subcommand; returns the exit code."""
    from scenegen_trainers.campaign.recipe import flight_keys
    from scenegen_trainers.training.recipe import TrainingRecipe

    keys = [key for key, _, _ in (*leaves(Recipe), *flight_keys(), *leaves(TrainingRecipe)) if key != "model"]
    own, flags = split_recipe_flags(arguments, keys)
    command = parse(Table2, "table2", own, _HELP)
    need_torch()
    out = command.out or Path(f"table2-{command.profile}")
    again = ["scenegen", "table2", *arguments, *([] if command.out else ["--out", str(out)])]
    with resumable("what is finished is kept", again):
        return _fly(prepare(command, flags, out), command)


def prepare(command: Table2, flags: Mapping[str, Any], out: Path) -> Table2Job:
    """The job a command line asks for; its networks are trained where none were given.

    Raises
    ------
    InputError
        For whatever is wrong, before anything is trained or built.
    """
    from scenegen_trainers.pilots.camera_check import check_camera
    from scenegen_trainers.pilots.modules import find_modules_here
    from scenegen_trainers.tables.entrants import others
    from scenegen_trainers.tables.table2 import FLIGHTS, Table2Job
    from scenegen_trainers.tables.table2_recipe import check_planner, flight_recipe
    from scenegen_trainers.training.source import TrainingData

    if command.profile not in FLIGHTS:
        raise InputError(f"--profile {command.profile}: unknown profile{nearest(command.profile, FLIGHTS)}")
    if command.flights < 0 or command.training_seed < 0:
        raise InputError("--flights and --training-seed must not be negative")
    given, also = _given(command), others(command.also)
    school, flights = _sources(command, flags)
    data = TrainingData.at(command.data) if command.data is not None else None
    recipe = flight_recipe(flights, given[0].camera if given else None, command.data)
    find_modules_here()
    check_planner(command.planner, recipe)
    for other in also:
        check_camera(other.path, other.camera, recipe.dataset.camera.camera())
    if not given:
        assert data is not None
        _check_camera(data, recipe)
        given = _taught(command, school, out)
    elif school:
        raise InputError(f"--{next(iter(school))}...: is a key of trainings, and both networks are given")
    job = Table2Job(
        out=out,
        recipe=recipe,
        conventional=given[0],
        proposed=given[1],
        flights=command.flights or FLIGHTS[command.profile],
        planner=command.planner,
        processes=processes(command.jobs),
        profile=command.profile,
        dataset={} if data is None else {**data.record()},
        allow_mixed=command.allow_mixed,
        others=also,
    )
    assert job.campaign  # looks at everything that checkpoints can have wrong
    return job


def _check_camera(data: TrainingData, recipe: FlightRecipe) -> None:
    """Networks fly with the camera they learn from."""
    from scenegen_trainers.pilots.camera_check import check_camera

    try:
        check_camera(data.root, data.camera(), recipe.dataset.camera.camera())
    except InputError:
        frames = "{width_px}x{height_px} pixels, {hfov_deg:g} deg".format_map(data.camera())
        raise InputError(
            f"--data {data.root}: its frames have {frames}, and networks fly with the camera they learn from; "
            "leave out --size and --camera, or give them the same values"
        ) from None


def _given(command: Table2) -> tuple[Entrant, Entrant] | None:
    from scenegen_trainers.tables.entrants import entrant

    if command.conventional is None and command.proposed is None:
        if command.data is None:
            raise InputError(
                "give --conventional and --proposed, two checkpoints, or --data to train them on"
            )
        return None
    if command.conventional is None or command.proposed is None:
        missing = "conventional" if command.conventional is None else "proposed"
        raise InputError(
            f"--{missing} is missing: give both checkpoints, or none and --data to train them on"
        )
    return entrant("conventional", command.conventional), entrant("proposed", command.proposed)


def _taught(command: Table2, school: Mapping[str, Any], out: Path) -> tuple[Entrant, Entrant]:
    from scenegen_trainers.tables.entrants import trained
    from scenegen_trainers.tables.table1 import Table1Job

    assert command.data is not None
    job = Table1Job(
        data=command.data,
        out=out,
        profile=command.profile,
        seeds=(command.training_seed,),
        asked=school,
        processes=processes(command.jobs),
    )
    return trained(job, lambda name, said: None if command.json else note(f"{name}  {said}"))


def _sources(command: Table2, flags: Mapping[str, Any]) -> tuple[dict[str, Any], list[Source]]:
    """Keys of the trainings, and where those of the flights come from."""
    asked = sources(command.recipe, flags, command.size)
    school = merge({k: v for k, v in s.values.items() if k in _SCHOOL} for s in asked)
    return school, [Source(s.name, {k: v for k, v in s.values.items() if k not in _SCHOOL}) for s in asked]


def _fly(job: Table2Job, command: Table2) -> int:
    from scenegen_cli.flying import fly_meter
    from scenegen_trainers.tables.table2 import run_table2
    from scenegen_trainers.tables.table2_page import as_json, write_table2
    from scenegen_trainers.tables.table2_text import as_markdown

    with fly_meter(quiet=command.json) as told:
        table = run_table2(job, told)
    paths = write_table2(table, job.out)
    if command.json:
        say_json(as_json(table))
    else:
        say(as_markdown(table))
        say("\n".join(map(str, paths)))
    for batch, reason in table.failed.items():
        note(f"put aside: {batch}: {reason}")
    return PUT_ASIDE if table.failed else 0


_HELP = (
    "\n\nrecipe keys: those of worlds, weather and camera show scenegen render --help, those of the closed loop "
    "scenegen fly --help, those of trainings scenegen table1 --help"
)
