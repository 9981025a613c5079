"""The networks of Table 2: the checkpoints that were given, looked at before anything is flown, or trained here."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from scenegen.foundation.errors import InputError
from scenegen_trainers.campaign.names import is_slug
from scenegen_trainers.models.checkpoint import Checkpoint, read_checkpoint
from scenegen_trainers.tables.names import BOUNDS
from scenegen_trainers.tables.paper import ROWS, Row
from scenegen_trainers.tables.table1 import Table1Job, finish_runs, run_name
from scenegen_trainers.tables.table2_paper import METHODS, Method
from scenegen_trainers.training.loop import MODEL

W_L1: Mapping[Method, float] = {"conventional": 100.0, "proposed": 300.0}
"""Weights with which the paper flew."""

_MODEL: Mapping[Method, str] = {"conventional": "pix2pix", "proposed": "pix2pix-flow"}
_IN_FLIGHT = ("farneback", "dis")


@dataclass(frozen=True, eq=False)
class Entrant:
    """A network that is to fly.

    Attributes
    ----------
    name : str
        "conventional", "proposed", or what another network is called in the table.
    architecture, flow : str
        Kind of network, and where its flow comes from.
    path : Path
        Of its checkpoint.
    camera : mapping
        ``width_px``, ``height_px``, ``hfov_deg`` of the frames it was trained on.
    record : mapping
        How it came to be; see `scenegen_trainers.models.checkpoint.Checkpoint`.
    """

    name: str
    architecture: str
    flow: str
    path: Path
    camera: Mapping[str, Any]
    record: Mapping[str, Any]

    @property
    def flag(self) -> str:
        """How it was given on the command line."""
        return f"--{self.name} {self.path}" if self.name in METHODS else f"--also {self.name}={self.path}"

    @property
    def recipe(self) -> Mapping[str, Any]:
        """Of its training, as plain data; empty if the checkpoint does not say."""
        recipe = self.record.get("recipe")
        return recipe if isinstance(recipe, Mapping) else {}

    @property
    def w_l1(self) -> float | None:
        """Weight of the L1 loss it was trained with."""
        knobs = self.recipe.get("pix2pix", {})
        return None if "w_l1" not in knobs else float(knobs["w_l1"])

    @property
    def steps(self) -> int | None:
        """Of its training."""
        knobs = self.recipe.get("training", {})
        return None if "steps" not in knobs else int(knobs["steps"])

    @property
    def content_id(self) -> str:
        """Of the dataset it was trained on."""
        dataset = self.record.get("dataset")
        return str(dataset.get("content_id", "")) if isinstance(dataset, Mapping) else ""

    def to_json(self) -> dict[str, Any]:
        """Plain data."""
        return {
            "method": self.name,
            "architecture": self.architecture,
            "flow": self.flow,
            "w_l1": self.w_l1,
            "steps": self.steps,
            "camera": dict(self.camera),
            "record": dict(self.record),
        }


def entrant(method: Method, path: Path) -> Entrant:
    """Look at a checkpoint.

    Raises
    ------
    InputError
        If there is none at `path`, or it holds a network of another kind than the method takes.
    """
    flag = f"--{method} {path}"
    checkpoint = read_checkpoint(path)
    network, inputs = checkpoint.network.architecture, checkpoint.network.inputs
    found = f"{network} with {'no flow' if inputs.flow == 'none' else f'{inputs.flow} flow'}"
    wanted = ("none",) if method == "conventional" else _IN_FLIGHT
    if network != "pix2pix" or inputs.flow not in wanted:
        raise InputError(
            f"{flag}: holds {found}; the {method} method is `scenegen train --model {_MODEL[method]}`, "
            f"pix2pix with {' or '.join(wanted).replace('none', 'no')} flow"
        )
    return _entrant(method, path, checkpoint)


def others(words: Sequence[str]) -> tuple[Entrant, ...]:
    """Look at checkpoints that fly along: any network of `scenegen train`.

    Parameters
    ----------
    words : sequence of str
        ``PATH`` or ``NAME=PATH``; without a name the kind of network is the name. A file that is there is a path.

    Raises
    ------
    InputError
        If a file is no such checkpoint, or a name cannot head a column or is taken.
    """
    found: list[Entrant] = []
    for word in words:
        name, equals, rest = word.partition("=")
        named = bool(equals) and "/" not in name and not Path(word).is_file()
        path = Path(rest if named else word)
        checkpoint = read_checkpoint(path)
        if checkpoint.network.inputs.flow == "truth":
            raise InputError(f"--also {word}: holds a network with truth flow, which no drone has in flight")
        name = name if named else checkpoint.network.architecture
        if not is_slug(name):
            raise InputError(f"--also {word}: '{name}' is no name; letters, digits and . _ = + , - make one")
        if name in (*METHODS, *BOUNDS, *(other.name for other in found)):
            raise InputError(f"--also {word}: the name '{name}' is taken; say --also NAME={path}")
        found.append(_entrant(name, path, checkpoint))
    return tuple(found)


def _entrant(name: str, path: Path, checkpoint: Checkpoint) -> Entrant:
    network = checkpoint.network
    return Entrant(
        name, network.architecture, network.inputs.flow, path, checkpoint.camera, checkpoint.record
    )


def check_sizes(first: Entrant, *rest: Entrant) -> None:
    """All are to see the same frames.

    Raises
    ------
    InputError
        If they were trained on frames of different cameras.
    """
    wanted = _frames(first)
    for other in rest:
        if _frames(other) != wanted:
            raise InputError(
                f"{other.flag}: was trained on frames of {_frames(other)}, the {first.name} one on {wanted}; "
                "train all on one dataset"
            )


def _frames(entrant: Entrant) -> str:
    return "{width_px}x{height_px} pixels, {hfov_deg:g} deg".format_map(entrant.camera)


def trained(
    job: Table1Job, watch: Callable[[str, str], None] = lambda run, said: None
) -> tuple[Entrant, Entrant]:
    """Train the two rows of Table 1 that Table 2 flies, or what is missing of them.

    Parameters
    ----------
    job : Table1Job
        With one seed.
    watch : callable
        Told the name of a run and what it says.
    """
    (seed,) = job.seeds
    rows = [_row_of(method) for method in METHODS]
    runs = finish_runs(job, rows, watch)
    first, second = (
        entrant(method, runs[run_name(row, seed)] / MODEL) for method, row in zip(METHODS, rows, strict=True)
    )
    return first, second


def _row_of(method: Method) -> Row:
    return next(row for row in ROWS if row.model == _MODEL[method] and row.w_l1 == W_L1[method])
