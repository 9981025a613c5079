"""Export a dataset to a format of somebody else: plan, write what is missing, finish. May be killed at any moment."""

from __future__ import annotations

import contextlib
from collections import Counter
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field
from importlib.util import find_spec
from pathlib import Path
from typing import Any

import numpy as np

from scenegen.foundation.atomic import remove, write_atomic
from scenegen.foundation.canonical import pretty
from scenegen.foundation.errors import DatasetError, InputError, NoSpaceError, ScenegenError, nearest
from scenegen.foundation.lock import DirectoryLock
from scenegen.foundation.pool import Done, Failed, Pool, Task
from scenegen_datasets.description import read_description
from scenegen_datasets.exports.format import Exported, Format
from scenegen_datasets.exports.marker import (
    FOLDER,
    SUMMARY,
    Marker,
    claim,
    clean,
    read_marker,
)
from scenegen_datasets.exports.options import Options
from scenegen_datasets.exports.registry import format_called
from scenegen_datasets.exports.stage import Stage
from scenegen_datasets.index import checked, job_of
from scenegen_datasets.job import SPLITS, ClipJob
from scenegen_datasets.place import check_room, existing_part
from scenegen_datasets.run import WORKER_ENVIRONMENT
from scenegen_datasets.source import Source, open_source
from scenegen_datasets.store import DATASET

WORKER = "scenegen_datasets.exports.worker:worker"
"""What a worker process does."""

Told = Callable[[int, int], None]
"""Hears of clips done and clips in all."""


@dataclass(frozen=True)
class Request:
    """What to export, and to what.

    Attributes
    ----------
    dataset, root : Path
        A finished dataset, and the directory of the export.
    to : str
        Name of the format.
    options : Options
    splits, maps : tuple of str
        Which clips; empty for all.
    """

    dataset: Path
    root: Path
    to: str
    options: Options = field(default_factory=Options)
    splits: tuple[str, ...] = ()
    maps: tuple[str, ...] = ()


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


@dataclass(frozen=True, eq=False)
class _Plan:
    """The clips to export, with what they are made from."""

    format: Format
    description: Mapping[str, Any]
    positions: tuple[int, ...]
    jobs: tuple[ClipJob, ...]
    identity: Mapping[str, Any]
    options: Mapping[str, Any]

    @property
    def frames(self) -> int:
        """Frames that the format writes."""
        return sum(job.pairs if self.format.pairs_only else job.frames for job in self.jobs)

    @property
    def pixels(self) -> int:
        """Of these frames."""
        grid = self.description["grid"]
        return self.frames * int(grid["height_px"]) * int(grid["width_px"])


def export(request: Request, processes: int = 1, told: Told | None = None) -> Outcome:
    """Export a dataset, or what is missing of an export.

    The files depend on dataset, format and options alone, not on `processes` or on interruptions.

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
    plan = _plan(request)
    root = request.root
    _prepare(request, plan)
    with DirectoryLock(root):
        claim(root, plan.identity)
        clean(root)
        markers = {job.name: read_marker(root, job.name) for job in plan.jobs}
        missing = [k for k, job in enumerate(plan.jobs) if markers[job.name] is None]
        if missing:
            remove(root / SUMMARY)
        _make(request, plan, missing, processes, told or (lambda done, total: None))
        markers |= {plan.jobs[k].name: read_marker(root, plan.jobs[k].name) for k in missing}
        return _finish(request, plan, markers, len(missing))


def _plan(request: Request) -> _Plan:
    target = format_called(request.to)
    options = request.options.heeded(target.heeds, target.name)
    absent = next((name for name in target.modules if find_spec(name) is None), None)
    if absent is not None:
        raise InputError(
            f"--to {target.name} needs {absent}; install it: pip install 'thermal-scenegen[{target.extra}]'"
        )
    source = open_source(request.dataset, allow_partial=False)
    description = read_description(request.dataset / DATASET)
    lacking = [name for name in target.needs if name not in source.layers]
    if lacking:
        raise InputError(
            f"--to {target.name} needs the layer '{lacking[0]}', which {request.dataset} does not hold "
            f"(it holds {', '.join(source.layers)})"
        )
    positions, jobs = _chosen(request, source)
    if target.one_camera:
        _refuse_second_camera(target, source, positions, jobs)
    identity = {
        "format": target.name,
        "dataset": description["name"],
        "content_id": description["content_id"],
        "options": options,
        "splits": [split for split in SPLITS if split in request.splits],
        "maps": sorted(set(request.maps)),
    }
    return _Plan(target, description, positions, jobs, identity, options)


def _chosen(request: Request, source: Source) -> tuple[tuple[int, ...], tuple[ClipJob, ...]]:
    """Clips of the splits and maps that were asked for, in plan order."""
    jobs = [job_of(checked(head)) for head in source.heads]
    for flag, asked, known in (
        ("split", request.splits, set(SPLITS)),
        ("map", request.maps, {job.map for job in jobs}),
    ):
        for name in asked:
            if name not in known:
                raise InputError(f"--{flag} {name}: not in {request.dataset}{nearest(name, known)}")
    chosen = [
        (position, job)
        for position, job in enumerate(jobs)
        if (not request.splits or job.split in request.splits)
        and (not request.maps or job.map in request.maps)
    ]
    if not chosen:
        raise InputError(
            f"{request.dataset} holds no clip of what was asked for; ask for another --split or --map"
        )
    return tuple(position for position, _ in chosen), tuple(job for _, job in chosen)


def _refuse_second_camera(
    target: Format, source: Source, positions: Sequence[int], jobs: Sequence[ClipJob]
) -> None:
    intrinsics = source.heads["K"][list(positions)]
    other = np.flatnonzero((intrinsics != intrinsics[0]).any(axis=(1, 2)))
    if other.size:
        raise InputError(
            f"--to {target.name} holds one camera, and {jobs[0].name} and {jobs[int(other[0])].name} differ in K; "
            "export them apart (--map, --split)"
        )


def _prepare(request: Request, plan: _Plan) -> None:
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
        root.mkdir(parents=True, exist_ok=True)
    except ScenegenError:
        raise
    except (OSError, ValueError) as error:
        reason = error.strerror if isinstance(error, OSError) else str(error)
        raise InputError(f"--out {str(request.root)[:80]!r}: cannot be used: {reason}") from None


def _make(request: Request, plan: _Plan, missing: Sequence[int], processes: int, told: Told) -> None:
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
    with Pool(WORKER, setup, min(processes, len(missing)), environment=WORKER_ENVIRONMENT) as pool:
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


def _finish(request: Request, plan: _Plan, markers: Mapping[str, Marker | None], made: int) -> Outcome:
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


def _summary(plan: _Plan, outcome: Outcome) -> dict[str, Any]:
    row = plan.format.row()
    names = ("name", "readers", "layout", "range", "step", "lost", "sky")
    return {
        **plan.identity,
        "format": dict(zip(names, row, strict=True)),
        "clips": outcome.clips,
        "frames": outcome.frames,
        "pixels": outcome.pixels,
        "did_not_fit": dict(outcome.counts),
        "meaning": {name: plan.format.invalid[name] for name in outcome.counts},
    }


def _share(count: int, pixels: int) -> str:
    return f"{100.0 * float(np.divide(count, max(pixels, 1))):.2g} % of all pixels"
