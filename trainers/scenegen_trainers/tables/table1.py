"""Table 1: five rows, several seeds, one dataset. Runs that are finished are kept, so a stopped table goes on."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from statistics import fmean, stdev
from typing import Any

from scenegen.foundation.atomic import make_directories
from scenegen.foundation.canonical import read
from scenegen.foundation.errors import InputError
from scenegen.foundation.lock import DirectoryLock
from scenegen.foundation.pool import Done, Failed, Note, Pool, Task
from scenegen_datasets.place import make_directory
from scenegen_datasets.resolve import Source
from scenegen_datasets.source import open_source
from scenegen_trainers.evaluation.baselines import PAINTED_ROW_MEAN, ROW_MEAN
from scenegen_trainers.evaluation.scores import NAMES
from scenegen_trainers.tables.names import SCORES
from scenegen_trainers.tables.order import Found, judge
from scenegen_trainers.tables.paper import RELATIONS, ROWS, Relation, Row
from scenegen_trainers.training.recipe import TrainingRecipe, resolve_training

WORKER = "scenegen_trainers.tables.worker:worker"
RUNS = "runs"
TRIVIAL = {
    "pooled": ROW_MEAN,
    "pooled_aligned": ROW_MEAN,
    "painted": PAINTED_ROW_MEAN,
}
"""The answer without an image that a network has to beat, by kind of score: it knows where ground and sky are, on
average."""

_ENVIRONMENT = dict.fromkeys(("OMP_NUM_THREADS", "OPENBLAS_NUM_THREADS", "MKL_NUM_THREADS"), "1")
"""Of a worker: one thread each. More would fight over the same cores."""


@dataclass(frozen=True, eq=False)
class Table1Job:
    """What to run.

    Attributes
    ----------
    data : Path
        Dataset.
    out : Path
    profile : str
    seeds : tuple of int
    asked : mapping
        Recipe keys from file and flags, for all rows alike.
    split : str
        Judged on.
    processes : int
        Trainings side by side, one thread each.
    accelerator, precision : str
        As in `scenegen_trainers.training.machine.Machine`.
    """

    data: Path
    out: Path
    profile: str
    seeds: tuple[int, ...]
    asked: Mapping[str, Any]
    split: str = "test"
    processes: int = 1
    accelerator: str = "cpu"
    precision: str = "32-true"

    def recipe(self, row: Row, seed: int) -> TrainingRecipe:
        """Of one run."""
        fixed = {"seed": seed, "pix2pix": {"w_l1": row.w_l1}}
        return resolve_training(row.model, self.profile, [Source("", self.asked), Source("the row", fixed)])


@dataclass(frozen=True, eq=False)
class Table1:
    """What came out.

    Attributes
    ----------
    dataset : mapping of str to str
    split, profile : str
    seeds : tuple of int
    runs : mapping of (str to list of mapping)
        Scores of every seed, by key of the row: ``{"pooled": {...}, "painted": {...}, ...}``.
    baselines : mapping of str to mapping
        Trivial answers on the same pixels, scored as `runs` are.
    steps : int
        Of each training.
    """

    dataset: Mapping[str, str]
    split: str
    profile: str
    seeds: tuple[int, ...]
    runs: Mapping[str, Sequence[Mapping[str, Any]]]
    baselines: Mapping[str, Mapping[str, Any]]
    steps: int

    def values(self, row: str, score: str, kind: str = "pooled") -> list[float]:
        """One score of all seeds of a row."""
        return [float(run[kind][score]) for run in self.runs[row]]

    def mean_and_spread(self, row: str, score: str, kind: str = "pooled") -> tuple[float, float | None]:
        """Mean and standard deviation over seeds; None for a single one."""
        values = self.values(row, score, kind)
        return fmean(values), stdev(values) if len(values) > 1 else None

    def relations(self) -> list[Found]:
        """What the runs say about the paper's claims, score by score."""
        return [
            judge(relation, score, {row.key: self.values(row.key, score) for row in ROWS})
            for relation in RELATIONS
            for score in NAMES
        ]

    def against_trivial(self, kind: str = "pooled") -> list[Found]:
        """Whether each row beats the best answer that looks at no image, score by score."""
        rival = TRIVIAL[kind]
        if rival not in self.baselines:
            return []
        found = []
        for row in ROWS:
            relation = Relation(f"{row.method}, w_L1 = {row.w_l1:g}", (row.key,), (rival,))
            for score in NAMES:
                level = [float(self.baselines[rival][kind][score])] * len(self.seeds)
                found.append(
                    judge(relation, score, {row.key: self.values(row.key, score, kind), rival: level})
                )
        return found


def run_table1(job: Table1Job, watch: Callable[[str, str], None] = lambda run, said: None) -> Table1:
    """Train and judge what is missing, then collect.

    Parameters
    ----------
    job : Table1Job
    watch : callable
        Told the name of a run and what it says.

    Raises
    ------
    InputError
        If the dataset or a key cannot be used, or `out` holds runs of another table.
    """
    if not job.seeds or len(set(job.seeds)) < len(job.seeds):
        raise InputError("a table needs one seed or more, each once")
    finish_runs(job, ROWS, watch)
    return _collected(job)


def finish_runs(
    job: Table1Job, rows: Sequence[Row], watch: Callable[[str, str], None] = lambda run, said: None
) -> dict[str, Path]:
    """Train and judge what is missing of some rows.

    Returns
    -------
    dict of str to Path
        Directory of each run, by its name.

    Raises
    ------
    InputError
        As `run_table1`.
    """
    open_source(job.data, allow_partial=False)  # what is wrong with it is said before anything is made
    make_directory(job.out.parent)
    root = make_directories(job.out.parent, job.out.name)
    make_directories(root, RUNS)
    with DirectoryLock(root):
        setup = {
            "data": str(job.data.resolve()),
            "split": job.split,
            "accelerator": job.accelerator,
            "precision": job.precision,
        }
        with Pool(WORKER, setup, job.processes, environment=_ENVIRONMENT, silence_s=3600.0) as pool:
            for event in pool.run(_tasks(job, rows)):
                if isinstance(event, Note):
                    watch(event.task.key, str(event.data["said"]))
                elif isinstance(event, Done):
                    watch(event.task.key, "done")
                elif isinstance(event, Failed):
                    raise InputError(f"{event.task.key}: {event.failure.message}")
    names = [run_name(row, seed) for row in rows for seed in job.seeds]
    return {name: job.out / RUNS / name for name in names}


def _tasks(job: Table1Job, rows: Sequence[Row]) -> list[Task]:
    """Seed by seed, so that a table that was stopped is complete for some seeds."""
    tasks = []
    for seed in job.seeds:
        for row in rows:
            name = run_name(row, seed)
            payload = {
                "recipe": job.recipe(row, seed).model_dump(mode="json"),
                "out": str(job.out / RUNS / name),
            }
            tasks.append(Task(key=name, group=name, payload=payload))
    return tasks


def run_name(row: Row, seed: int) -> str:
    """Directory of a run."""
    return f"{row.key}-seed{seed}"


def _collected(job: Table1Job) -> Table1:
    results = {
        row.key: [read(job.out / RUNS / run_name(row, seed) / SCORES) for seed in job.seeds] for row in ROWS
    }
    first = results[ROWS[0].key][0]
    return Table1(
        dataset=first["dataset"],
        split=job.split,
        profile=job.profile,
        seeds=job.seeds,
        runs=results,
        baselines=first["baselines"],
        steps=job.recipe(ROWS[0], job.seeds[0]).training.steps,
    )
