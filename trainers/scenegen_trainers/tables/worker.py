"""One run of a table in a process of its own: train, judge, write the scores."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from pathlib import Path
from typing import Any

from scenegen.foundation.atomic import write_atomic
from scenegen.foundation.canonical import pretty
from scenegen_trainers.evaluation.baselines import judge_baselines
from scenegen_trainers.evaluation.evaluate import evaluate
from scenegen_trainers.evaluation.judge import PAINTED, WHOLE
from scenegen_trainers.evaluation.report import report_json
from scenegen_trainers.evaluation.scores import named
from scenegen_trainers.metrics import ValidDepth
from scenegen_trainers.models.checkpoint import read_checkpoint
from scenegen_trainers.tables.names import SCORES
from scenegen_trainers.training.loop import Taught, train
from scenegen_trainers.training.machine import Machine
from scenegen_trainers.training.recipe import TrainingRecipe
from scenegen_trainers.training.source import TrainingData

_SAID_EVERY = 50


def worker(setup: Mapping[str, Any]) -> Callable[..., dict[str, Any]]:
    """What a worker does with each run it is given."""
    data, split = TrainingData.at(Path(setup["data"])), str(setup["split"])
    trivial = _Trivial(data, split)
    machine = Machine(setup.get("accelerator", "cpu"), precision=setup.get("precision", "32-true"))

    def handle(task: Mapping[str, Any], say: Callable[[dict[str, Any]], None]) -> dict[str, Any]:
        recipe = TrainingRecipe.model_validate(task["recipe"])
        out = Path(task["out"])
        data.samples(split, recipe)  # a split that cannot be judged is refused before anything is taught

        def watch(taught: Taught) -> None:
            if taught.step % _SAID_EVERY == 0:
                say({"said": f"step {taught.step} of {taught.steps}"})

        model = train(recipe, data, out, machine, watch)
        say({"said": "judged"})
        write_atomic(out / SCORES, pretty(_scores(model, data, split, machine.device(), trivial)))
        return {}

    return handle


class _Trivial:
    """Scores of answers that look at no image: worked out once for each cap, not for every run."""

    def __init__(self, data: TrainingData, split: str) -> None:
        self._data, self._split = data, split
        self._scores: dict[float, dict[str, Any]] = {}

    def __call__(self, cap_m: float) -> dict[str, Any]:
        if cap_m not in self._scores:
            found = judge_baselines(self._data.root, self._split, ValidDepth(furthest_m=cap_m))
            self._scores[cap_m] = {
                name: {
                    "pooled": named(standings[WHOLE].report.pooled),
                    "pooled_aligned": named(standings[WHOLE].report.pooled_aligned),
                    "painted": named(standings[PAINTED].report.pooled),
                    "by_range": report_json(standings[WHOLE].report)["by_range"],
                }
                for name, standings in found.items()
            }
        return self._scores[cap_m]


def _scores(model: Path, data: TrainingData, split: str, device: str, trivial: _Trivial) -> dict[str, Any]:
    evaluation = evaluate(read_checkpoint(model), data, split, thorough=False, device=device)
    report = report_json(evaluation.report)
    return {
        "dataset": dict(evaluation.dataset),
        "pooled": report["pooled"],
        "per_image": report["per_image"],
        "pooled_aligned": report["pooled_aligned"],
        "painted": named(evaluation.painted.pooled),
        "by_range": report["by_range"],
        "interval_95": {name: list(span) for name, span in evaluation.interval.items()},
        "pixels": report["pixels"],
        "images": report["images"],
        "baselines": trivial(evaluation.valid.furthest_m),
    }
