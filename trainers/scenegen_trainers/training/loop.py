"""The training loop. Every step is a function of the state before it and of its own number, so nothing but the state
has to be saved for a killed training to end where an undisturbed one does."""

from __future__ import annotations

import io
import math
from collections.abc import Callable, Iterable
from contextlib import nullcontext
from dataclasses import dataclass
from functools import partial
from pathlib import Path
from typing import Any

import torch
from torch.utils.data import DataLoader

from scenegen.foundation.atomic import write_atomic
from scenegen.foundation.errors import InputError
from scenegen.foundation.lock import DirectoryLock
from scenegen.foundation.rng import stream
from scenegen_datasets.place import make_directory
from scenegen_trainers.evaluation.answers import Answer, answers
from scenegen_trainers.evaluation.pictures import answer_sheet
from scenegen_trainers.inputs.target import decode
from scenegen_trainers.metrics import DepthMeter, ValidDepth
from scenegen_trainers.models.checkpoint import write_checkpoint
from scenegen_trainers.models.learner import Batch, Learner
from scenegen_trainers.models.registry import ARCHITECTURES
from scenegen_trainers.training.log import Log
from scenegen_trainers.training.machine import Machine, is_first_process
from scenegen_trainers.training.recipe import TrainingRecipe
from scenegen_trainers.training.samples import batches, collate
from scenegen_trainers.training.source import TrainingData
from scenegen_trainers.training.state import read_state, write_state

MODEL = "model.pt"
"""The finished network; its presence says that the training is done."""

_SHOWN = 6


@dataclass(frozen=True)
class Taught:
    """How far a training is.

    Attributes
    ----------
    step, steps : int
    losses : dict of str to float
        Of this step; empty where they were not looked at.
    """

    step: int
    steps: int
    losses: dict[str, float]


def train(
    recipe: TrainingRecipe,
    data: TrainingData,
    out: Path,
    machine: Machine,
    watch: Callable[[Taught], None] = lambda _: None,
) -> Path:
    """Teach a network, or go on where a killed training stopped.

    Parameters
    ----------
    recipe : TrainingRecipe
    data : TrainingData
        Dataset.
    out : Path
        Directory for the network (`MODEL`), log, state and pictures. It is made.
    machine : Machine
    watch : callable
        Told of every step.

    Returns
    -------
    Path
        Of the finished network.

    Raises
    ------
    InputError
        If `out` holds another training or one that still runs, the dataset does not fit, or the losses stop being
        numbers.
    """
    if recipe.training.batch % max(machine.devices, 1):
        raise InputError(
            f"a batch of {recipe.training.batch} cannot be shared evenly by {machine.devices} devices; "
            "change --training.batch or --devices"
        )
    fabric = machine.fabric(out)
    make_directory(out)
    with DirectoryLock(out) if is_first_process() else nullcontext():
        fabric.launch()
        identity = {"recipe": recipe.deciding(), "dataset": data.content_id}
        state = read_state(out, identity)
        if state is not None and not state["learner"] and not (out / MODEL).is_file():
            state = None  # a finished training keeps its weights in the network alone: that is made anew
        if state is None or state["step"] < recipe.training.steps:
            _School(recipe, data, out, fabric, machine.precision, identity).teach(state, watch)
    return out / MODEL


class _School:
    """One training at work."""

    def __init__(
        self,
        recipe: TrainingRecipe,
        data: TrainingData,
        out: Path,
        fabric: Any,
        precision: str,
        identity: dict[str, Any],
    ) -> None:
        self.recipe, self.data, self.out, self.fabric = recipe, data, out, fabric
        self.precision, self.identity = precision, identity
        self.camera = data.camera()
        knobs = recipe.training
        self.samples = data.samples("train", recipe, knobs.pairs, keep=knobs.workers == 0)
        self.judged = data.samples("val", recipe, knobs.judge_pairs, keep=True, stored=True)
        torch.manual_seed(_number(recipe.seed, "weights"))
        self.learner: Learner = ARCHITECTURES[recipe.network].teach(
            recipe.inputs.channels, recipe.knobs, recipe.target, knobs.learning_rate
        )
        self.learner.move_to(fabric)

    def teach(self, state: dict[str, Any] | None, watch: Callable[[Taught], None]) -> None:
        """All steps from the last saved one to the end."""
        knobs, first = self.recipe.training, 0
        if state is not None:
            self.learner.restore(state["learner"])
            first = int(state["step"])
        log = Log(self.out, first)
        rank, count = self.fabric.global_rank, self.fabric.world_size
        for step, batch in enumerate(self._batches(first, slice(rank, None, count)), first):
            torch.manual_seed(_number(self.recipe.seed, "step", step, rank))
            rate = self.learner.set_rate(_rate_share(step, knobs.steps, knobs.decay_from))
            losses = self.learner.step(self.fabric.to_device(batch))
            watch(Taught(step + 1, knobs.steps, self._after(step + 1, rate, losses, log)))
        self.fabric.barrier()

    def _after(self, done: int, rate: float, losses: Any, log: Log) -> dict[str, float]:
        """Log, judge and save where it is time; returns the losses if they were looked at."""
        knobs, first, seen = self.recipe.training, self.fabric.is_global_zero, {}
        last = done == knobs.steps
        if last or done % knobs.log == 0:
            seen = self._look_at(losses, done)
            log.add(done, {"rate": rate, **seen})
            self.fabric.log_dict(seen, done)
        if first and (last or done % knobs.judge == 0):
            scores = self._examine(done)
            log.add(done, scores)
            self.fabric.log_dict(scores, done)
        if first and (last or done % knobs.keep == 0):
            log.write()
            if last:
                self._graduate(done)
            write_state(self.out, self.identity, done, {} if last else self.learner.state())
        return seen

    def _batches(self, first: int, share: slice) -> Iterable[Batch]:
        knobs = self.recipe.training
        return DataLoader(  # type: ignore[no-any-return]
            self.samples,
            batch_sampler=_Planned(len(self.samples), self.recipe, first, share),
            collate_fn=partial(collate, self.recipe.target),
            num_workers=knobs.workers,
            multiprocessing_context="spawn" if knobs.workers else None,
        )

    def _look_at(self, losses: Any, step: int) -> dict[str, float]:
        seen = {name: float(loss.detach()) for name, loss in losses.items()}
        if not all(map(math.isfinite, seen.values())):
            raise InputError(
                f"{self.out}: the losses are no longer numbers at step {step}; "
                "lower --training.learning-rate or take --precision 32-true"
            )
        return seen

    def _examine(self, step: int) -> dict[str, float]:
        """Scores on the validation split, and a picture of some answers."""
        network, target = self.learner.network.module, self.recipe.target
        network.eval()
        meter = DepthMeter(ValidDepth(furthest_m=target.cap_m))
        shown: list[tuple[str, Answer]] = []
        some = set(range(0, len(self.judged), max(1, len(self.judged) // _SHOWN)))
        for answer in answers(
            lambda image: decode(network(image)[:, 0].float(), target), self.judged, self.fabric.device
        ):
            scores = meter.add(answer.estimate_m, answer.truth_m)
            if answer.position in some and len(shown) < _SHOWN:
                said = "sky only" if scores is None else f"RMSE {scores.rmse_m:.1f} m, Rel {scores.rel:.2f}"
                shown.append((said, answer))
        network.train()
        title = f"{self.recipe.model}, step {step}"
        _write_picture(self.out / "samples" / f"{step:08d}.png", answer_sheet(title, shown, target.cap_m))
        if meter.pixels == 0:
            return {}  # nothing but sky; the picture says so
        pooled = meter.report().pooled
        return {"val_rmse_m": pooled.rmse_m, "val_rel": pooled.rel, "val_delta1": pooled.delta[0]}

    def _graduate(self, step: int) -> None:
        record = {
            "model": self.recipe.model,
            "seed": self.recipe.seed,
            "step": step,
            "recipe": self.recipe.deciding(),
            "dataset": self.data.record(),
            "torch": str(torch.__version__),
            "threads": torch.get_num_threads(),
            "precision": self.precision,
        }
        network = self.learner.network.module
        write_checkpoint(self.out / MODEL, network, self.recipe.network_config(), self.camera, record)


class _Planned:
    """The draws of every step as a ``batch_sampler``."""

    def __init__(self, count: int, recipe: TrainingRecipe, first: int, share: slice) -> None:
        self._count, self._recipe, self._first, self._share = count, recipe, first, share

    def __iter__(self) -> Any:
        return batches(self._count, self._recipe.training, self._recipe.seed, self._first, self._share)

    def __len__(self) -> int:
        return self._recipe.training.steps - self._first


def _number(seed: int, *path: str | int) -> int:
    """Seed for torch's own generator."""
    return int(stream(seed, *path).integers(2**63))


def _rate_share(step: int, steps: int, decay_from: float) -> float:
    """1 at first, then linearly down; never quite 0."""
    start = decay_from * steps
    return 1.0 if step < start else (steps - step) / max(steps - start, 1.0)


def _write_picture(path: Path, picture: Any) -> None:
    path.parent.mkdir(exist_ok=True)
    buffer = io.BytesIO()
    picture.save(buffer, "PNG")
    write_atomic(path, buffer.getvalue())
