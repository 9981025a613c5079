"""From a recipe to a dataset on disk: plan, make what is missing, finish. Idempotent; may be killed at any moment."""

from __future__ import annotations

from collections import Counter
from collections.abc import Callable, Mapping, Sequence
from dataclasses import asdict, dataclass
from typing import Any

import yaml

from scenegen.foundation.atomic import remove
from scenegen.foundation.errors import InputError, NoSpaceError, ScenegenError
from scenegen.foundation.lock import DirectoryLock
from scenegen.foundation.pool import Done, Event, Failed, Note, Pool, Strike, Task
from scenegen_datasets.finish import finish
from scenegen_datasets.info import DatasetInfo
from scenegen_datasets.job import ClipJob
from scenegen_datasets.lock import fingerprint_id, make_lock
from scenegen_datasets.pictures.preview import write_preview
from scenegen_datasets.recipe import SCENE_SEMANTICS
from scenegen_datasets.render_job import Job, prepare
from scenegen_datasets.run_log import START, RunLog, machine
from scenegen_datasets.store import DATASET, MANIFEST, clean, create_or_open, finished
from scenegen_datasets.workers import ENVIRONMENT

WORKER = "scenegen_datasets.studio:worker"
"""What a worker process does."""

SHARE_FROM = 3
"""A world is exposed a second time by another worker if at least this many of its clips are open."""

GIVE_UP_AFTER = 3
"""Clips that may fail at the start of a job before a single one succeeds."""


@dataclass(frozen=True)
class Progress:
    """How far a job is.

    Attributes
    ----------
    frames_done, frames : int
        Of this run, frames in flight included.
    clips_done, clips : int
        Of the whole plan; clips of earlier runs count as done.
    what : str
        What happened last, in words; empty for a frame.
    """

    frames_done: int
    frames: int
    clips_done: int
    clips: int
    what: str = ""


Told = Callable[[Progress], None]


@dataclass(frozen=True)
class Outcome:
    """What became of a job.

    Attributes
    ----------
    info : DatasetInfo
    quarantined : tuple of (str, str)
        Clips that could not be made, and why.
    made : int
        Clips made by this run.
    """

    info: DatasetInfo
    quarantined: tuple[tuple[str, str], ...]
    made: int


def run(job: Job, render: Mapping[str, str], told: Told) -> Outcome:
    """Make a dataset, or what is missing of it.

    Parameters
    ----------
    job : Job
    render : mapping of str to str
        The renderer's fingerprint.
    told : callable
        Hears of progress.

    Raises
    ------
    InputError
        If the directory cannot be used, or the recipe asks for something no world can give.
    NoSpaceError
        If the device is full, or would be.
    """
    lock = make_lock(
        {**job.recipe.canonical(), "pairs": job.pairs},
        name=job.name,
        scene_semantics=SCENE_SEMANTICS,
        render=render,
        license=job.license,
    )
    prepare(job)
    with DirectoryLock(job.root):
        create_or_open(job.root, _yaml(job.asked), lock, allow_mixed=job.allow_mixed)
        clean(job.root)
        done = finished(job.root)
        missing = [clip for clip in job.clips if clip.name not in done]
        if missing:  # until `finish` it grows: what proved the smaller one must not outlive it
            remove(job.root / DATASET)
            remove(job.root / MANIFEST)
        with RunLog(job.root) as log:
            log.write(
                START,
                pairs=job.pairs,
                missing=len(missing),
                processes=job.processes,
                machine=machine(),
                **lock,
            )
            quarantined = make_clips(job, missing, fingerprint_id(lock["fingerprint"]), log, told)
            told(
                Progress(
                    0,
                    0,
                    len(job.clips) - len(quarantined),
                    len(job.clips),
                    "writing index, card and pictures",
                )
            )
            write_preview(job.root)
            info = finish(job.root, job.clips)
            log.write("end", quarantined=len(quarantined), content_id=info.content_id)
    return Outcome(info, tuple(quarantined.items()), len(missing) - len(quarantined))


def make_clips(
    job: Job, missing: Sequence[ClipJob], fingerprint: str, log: RunLog, told: Told
) -> dict[str, str]:
    """Make clips of a job in worker processes, below its directory; returns those that could not be made, and why."""
    setup = {
        "recipe": job.recipe.model_dump(mode="json"),
        "root": str(job.root.resolve()),
        "fingerprint": fingerprint,
    }
    tasks = [Task(clip.name, f"{clip.map}-{clip.world}", asdict(clip)) for clip in missing]
    count = _Count(missing, len(job.clips))
    with Pool(
        WORKER,
        setup,
        job.processes,
        environment=ENVIRONMENT,
        share_from=SHARE_FROM,
    ) as pool:
        for event in pool.run(tasks):
            what = count.hear(event)
            _log(log, event)
            if isinstance(event, Failed):
                _stop_if_hopeless(event, count)
            told(count.progress(what))
    return count.quarantined


class _Count:
    """Frames and clips made so far, those in flight included."""

    def __init__(self, missing: Sequence[ClipJob], planned: int) -> None:
        self._frames = {clip.name: clip.frames for clip in missing}
        self._flying: Counter[str] = Counter()
        self._planned, self._before = planned, planned - len(missing)
        self.done: set[str] = set()
        self.quarantined: dict[str, str] = {}

    def hear(self, event: Event) -> str:
        """Take an event in; returns what to tell people about it."""
        name = event.task.key
        if isinstance(event, Note):
            if "frame" in event.data:
                self._flying[name] = event.data["frame"] + 1
            return str(event.data.get("stage", ""))
        self._flying.pop(name, None)
        if isinstance(event, Done):
            self.done.add(name)
            return f"made {name}"
        if isinstance(event, Strike):
            return f"{name}: {event.failure.message}; tried again"
        self.quarantined[name] = event.failure.message
        return f"{name}: {event.failure.message}; put aside"

    def progress(self, what: str) -> Progress:
        """Where the job stands."""
        made = sum(self._frames[name] for name in self.done) + sum(self._flying.values())
        frames = sum(n for name, n in self._frames.items() if name not in self.quarantined)
        return Progress(made, frames, self._before + len(self.done), self._planned, what)


def _log(log: RunLog, event: Event) -> None:
    if isinstance(event, Done):
        log.write("clip", clip=event.task.key, **event.value)
    elif isinstance(event, Strike | Failed):
        name = "strike" if isinstance(event, Strike) else "quarantine"
        log.write(name, clip=event.task.key, **asdict(event.failure))


def _stop_if_hopeless(event: Failed, count: _Count) -> None:
    """Stop a job whose every clip would fail in the same way."""
    failure = event.failure
    if failure.exit_code == NoSpaceError.exit_code:
        raise NoSpaceError(failure.message)
    if failure.exit_code == InputError.exit_code:
        raise InputError(failure.message)
    if not count.done and len(count.quarantined) >= GIVE_UP_AFTER:
        raise JobError(f"no clip can be made: {failure.message}; run 'scenegen doctor'")


class JobError(ScenegenError, RuntimeError):
    """A job stopped because it cannot get anywhere."""

    exit_code = 1


def _yaml(asked: Mapping[str, Any]) -> str:
    head = "# What was asked; every default is resolved in recipe.lock.json.\n"
    return head + (yaml.safe_dump(dict(asked), sort_keys=True, allow_unicode=True) if asked else "{}\n")
