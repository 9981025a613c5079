"""Export a dataset to a format of somebody else: plan, write what is missing, finish. May be killed at any moment."""

from __future__ import annotations

import contextlib
from collections import Counter
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np

from scenegen.foundation.atomic import remove, write_atomic
from scenegen.foundation.canonical import pretty
from scenegen.foundation.errors import DatasetError, InputError, NoSpaceError, ScenegenError
from scenegen.foundation.lock import DirectoryLock
from scenegen.foundation.pool import Done, Failed, Pool, Task
from scenegen_datasets.exports.format import Exported
from scenegen_datasets.exports.marker import (
    FOLDER,
    SUMMARY,
    Marker,
    claim,
    clean,
    kept_clips,
    read_marker,
)
from scenegen_datasets.exports.plan import Plan, Request, plan_of
from scenegen_datasets.exports.stage import Stage
from scenegen_datasets.licence import licence_of
from scenegen_datasets.place import check_room, existing_part, make_directory
from scenegen_datasets.workers import ENVIRONMENT

WORKER = "scenegen_datasets.exports.worker:worker"
"""What a worker process does."""

Told = Callable[[int, int], None]
"""Hears of clips done and clips in all."""


@dataclass(frozen=True)
class Outcome:
    """What became of an export.

    Attributes
    ----------
    root : Path
    to : str
    clips, frames, bytes : int
        Of the whole export.
    made : int
        Clips written by this run; the others were there.
    pixels : int
        Pixels of all frames exported.
    counts : mapping of str to int
        Values that did not fit, by what the format calls them.
    words : tuple of str
        The same as sentences.
    """

    root: Path
    to: str
    clips: int
    frames: int
    bytes: int
    made: int
    pixels: int
    counts: Mapping[str, int]
    words: tuple[str, ...]


def export(request: Request, processes: int = 1, told: Told | None = None) -> Outcome:
    """Export a dataset, or what is missing of an export: it was interrupted, files are gone, or the dataset has grown.

    The files depend on dataset, format and options alone, not on `processes`, on interruptions or on growth.

    Parameters
    ----------
    request : Request
    processes : int
        Worker processes; 1 works in this one.
    told : callable, optional
        Hears of progress.

    Raises
    ------
    InputError
        If the dataset cannot be exported as asked, or the directory holds something else.
    NoSpaceError
        If it does not fit on the device.
    DatasetError
        If a clip of the dataset is damaged.
    """
    plan = plan_of(request)
    root = request.root
    _prepare(request, plan)
    with DirectoryLock(root):
        claim(root, plan.identity)
        clean(root)
        kept = kept_clips(root, plan.sums)
        missing = [k for k, job in enumerate(plan.jobs) if job.name not in kept]
        if missing:
            remove(root / SUMMARY)
        _make(request, plan, missing, processes, told or (lambda done, total: None))
        made = {plan.jobs[k].name: read_marker(root, plan.jobs[k].name) for k in missing}
        return _finish(request, plan, kept | made, len(missing))


def _prepare(request: Request, plan: Plan) -> None:
    """Make the directory, after refusing what cannot end well."""
    try:
        root, dataset = request.root.resolve(), request.dataset.resolve()
        if root == dataset or dataset in root.parents or root in dataset.parents:
            raise InputError(
                f"--out {request.root}: lies inside the dataset or around it; choose another --out"
            )
        existing = existing_part(request.root)
        missing = [job for job in plan.jobs if not (root / FOLDER / "clips" / f"{job.name}.json").exists()]
        need_bytes = plan.format.bytes_per_pixel * plan.pixels * len(missing) / len(plan.jobs)
        check_room(
            request.root,
            existing,
            need_bytes,
            "export fewer clips (--split, --map), or choose another --out",
        )
    except ScenegenError:
        raise
    except (OSError, ValueError) as error:
        reason = error.strerror if isinstance(error, OSError) else str(error)
        raise InputError(f"--out {str(request.root)[:80]!r}: cannot be used: {reason}") from None
    make_directory(request.root)


def _make(request: Request, plan: Plan, missing: Sequence[int], processes: int, told: Told) -> None:
    setup = {
        "dataset": str(request.dataset.resolve()),
        "root": str(request.root.resolve()),
        "format": plan.format.name,
        "options": dict(plan.options),
    }
    done = len(plan.jobs) - len(missing)
    payloads = [(plan.jobs[k].name, {"position": plan.positions[k]}) for k in missing]
    if processes <= 1 or len(missing) <= 1:
        from scenegen_datasets.exports.worker import worker

        export_clip = worker(setup) if missing else None
        for _, payload in payloads:
            assert export_clip is not None
            export_clip(payload, None)
            done += 1
            told(done, len(plan.jobs))
        return
    with Pool(WORKER, setup, min(processes, len(missing)), environment=ENVIRONMENT) as pool:
        for event in pool.run(Task(name, name, payload) for name, payload in payloads):
            if isinstance(event, Failed):
                _raise(event)
            done += isinstance(event, Done)
            told(done, len(plan.jobs))


def _raise(event: Failed) -> None:
    failure = event.failure
    kinds = {InputError.exit_code: InputError, NoSpaceError.exit_code: NoSpaceError}
    kind = kinds.get(failure.exit_code or -1, DatasetError)
    raise kind(failure.message if failure.exit_code is not None else f"{event.task.key}: {failure.message}")


def _finish(request: Request, plan: Plan, markers: Mapping[str, Marker | None], made: int) -> Outcome:
    """Write what belongs to all clips, and last the summary that says that everything is there."""
    root = request.root
    whole = {name: marker for name, marker in markers.items() if marker is not None}
    if len(whole) != len(plan.jobs):
        raise DatasetError(f"{root}: files of the export vanish while it is written; export again")
    clips = [
        Exported(job.name, job.map, job.split, job.world, job.clip, job.frames, whole[job.name].written.facts)
        for job in plan.jobs
    ]
    with Stage(root, f"{FOLDER}/work/all") as stage:
        plan.format.finish(stage, clips, plan.description, request.options)
        sizes = stage.commit()
    with contextlib.suppress(OSError):
        (root / FOLDER / "work").rmdir()
    counts: Counter[str] = Counter()
    for job in plan.jobs:
        counts.update(whole[job.name].written.counts)
    total = sum(sum(marker.files.values()) for marker in whole.values()) + sum(sizes.values())
    words = tuple(
        f"{counts[name]:,} {meaning} ({_share(counts[name], plan.pixels)})"
        for name, meaning in plan.format.invalid.items()
        if counts[name]
    )
    outcome = Outcome(
        root=root,
        to=plan.format.name,
        clips=len(clips),
        frames=plan.frames,
        bytes=total,
        made=made,
        pixels=plan.pixels,
        counts={name: counts[name] for name in plan.format.invalid},
        words=words,
    )
    write_atomic(root / SUMMARY, pretty(_summary(plan, outcome)))
    return outcome


def _summary(plan: Plan, outcome: Outcome) -> dict[str, Any]:
    row = plan.format.row()
    names = ("name", "readers", "layout", "range", "step", "lost", "sky")
    return {
        **plan.identity,
        "content_id": plan.description["content_id"],
        "version": plan.description["version"],
        "license": licence_of(plan.description),
        "format": dict(zip(names, row, strict=True)),
        "clips": outcome.clips,
        "frames": outcome.frames,
        "pixels": outcome.pixels,
        "did_not_fit": dict(outcome.counts),
        "meaning": {name: plan.format.invalid[name] for name in outcome.counts},
    }


def _share(count: int, pixels: int) -> str:
    return f"{100.0 * float(np.divide(count, max(pixels, 1))):.2g} % of all pixels"
