"""What an export will hold: the format, the clips, and who it is; refused here if it cannot be."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from importlib.util import find_spec
from pathlib import Path
from typing import Any

import numpy as np

from scenegen.foundation.errors import InputError, nearest
from scenegen_datasets.description import read_description
from scenegen_datasets.exports.clip import clip_sha256
from scenegen_datasets.exports.format import Format
from scenegen_datasets.exports.options import Options
from scenegen_datasets.exports.registry import format_called
from scenegen_datasets.index import checked, job_of
from scenegen_datasets.job import SPLITS, ClipJob
from scenegen_datasets.source import Source, open_source
from scenegen_datasets.store import DATASET


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


@dataclass(frozen=True, eq=False)
class Plan:
    """The clips to export, with what they are made from.

    Attributes
    ----------
    format : Format
    description : mapping
        ``dataset.json``.
    positions : tuple of int
        Of the clips in the dataset, in plan order.
    jobs : tuple of ClipJob
        Of the same clips.
    sums : mapping of str to str
        `clip_sha256` by name of the clip.
    identity : mapping
        By which a directory knows its export again; the same for a dataset that has grown.
    options : mapping
        `Options.heeded`.
    """

    format: Format
    description: Mapping[str, Any]
    positions: tuple[int, ...]
    jobs: tuple[ClipJob, ...]
    sums: Mapping[str, str]
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


def plan_of(request: Request) -> Plan:
    """Find what a request asks for.

    Raises
    ------
    InputError
        If there is no such format, dataset or clip, an extra is not installed, or the dataset lacks what the format
        needs.
    DatasetError
        If the dataset is damaged.
    """
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
        "recipe_id": description["recipe_id"],
        "options": options,
        "splits": [split for split in SPLITS if split in request.splits],
        "maps": sorted(set(request.maps)),
    }
    sums = {job.name: clip_sha256(source, at) for at, job in zip(positions, jobs, strict=True)}
    return Plan(target, description, positions, jobs, sums, identity, options)


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
