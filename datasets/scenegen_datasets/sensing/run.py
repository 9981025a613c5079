"""A new dataset from the stored radiance of another: its clips, its worlds, its splits, another camera."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import yaml
from pydantic import ValidationError

from scenegen.foundation.atomic import remove
from scenegen.foundation.errors import DatasetError, InputError, NoSpaceError
from scenegen.foundation.lock import DirectoryLock
from scenegen.foundation.pool import Done, Failed, Pool, Task
from scenegen_datasets.finish import finish
from scenegen_datasets.info import DatasetInfo
from scenegen_datasets.job import ClipJob
from scenegen_datasets.layers import DEFAULT_LAYERS
from scenegen_datasets.licence import KEY
from scenegen_datasets.lock import SOURCE, VOLATILE_KEYS, fingerprint, fingerprint_id, make_lock
from scenegen_datasets.pictures.preview import write_preview
from scenegen_datasets.place import make_directory
from scenegen_datasets.render_job import dataset_name
from scenegen_datasets.sensing.camera import CameraKeys, NewCamera, new_camera
from scenegen_datasets.sensing.film import Film, payload_of, setup_of
from scenegen_datasets.source import open_source
from scenegen_datasets.store import DATASET, LOCK, MANIFEST, clean, create_or_open, finished, read_lock
from scenegen_datasets.versions.state import finished_description
from scenegen_datasets.workers import ENVIRONMENT

WORKER = "scenegen_datasets.sensing.film:worker"

_KEPT = ("recipe", "recipe_id", "scene_semantics", "parts", SOURCE)
"""What the lock of a sensed dataset says of its source: all that is needed to make its radiance again."""

Told = Callable[[int, int], None]


@dataclass(frozen=True)
class Sensed:
    """What came of it.

    Attributes
    ----------
    info : DatasetInfo
    side : int
        Stored pixels along the side of a new one.
    made : int
        Clips made by this run.
    """

    info: DatasetInfo
    side: int
    made: int


def sense_dataset(
    source: Path,
    out: Path,
    asked: Mapping[str, Any],
    *,
    seed: int | None = None,
    processes: int = 1,
    told: Told = lambda done, total: None,
) -> Sensed:
    """Make a dataset of what another camera sees, or what is missing of it; truth and splits stay what they are.

    Parameters
    ----------
    source : Path
        A finished dataset with the default layers.
    out : Path
        The new one.
    asked : mapping
        Keys of the recipe sections `camera` and `sensor`.
    seed : int, optional
        Of the new noise; that of the recipe by default, with which the same camera gives the same counts again.
    processes : int
    told : callable
        Called with (clips done, clips in all).

    Raises
    ------
    InputError
        If the camera needs a new render, the dataset lacks a layer, or `out` cannot be used.
    DatasetError
        If the stored dataset is damaged.
    """
    old, jobs = _opened(source)
    chosen = new_camera(str(source), old["recipe"], asked)
    if out.resolve() == source.resolve():
        raise InputError(f"--out {out} is the dataset itself; name another directory")
    seed = int(old["recipe"].get("seed", 0)) if seed is None else seed
    lock = _lock(old, chosen, seed, out)
    keys = CameraKeys(camera=chosen.camera, sensor=chosen.sensor)
    film = Film(source, out, keys, chosen.side, seed, lock["fingerprint_id"])
    make_directory(out)
    with DirectoryLock(out):
        create_or_open(out, _yaml(old, asked, seed), lock)
        clean(out)
        done = finished(out)
        missing = [job for job in jobs if job.name not in done]
        if missing:
            remove(out / DATASET)
            remove(out / MANIFEST)
            _make(film, missing, len(jobs), processes, told)
        write_preview(out)
        return Sensed(finish(out, jobs), chosen.side, len(missing))


def film_again(
    recipe: Mapping[str, Any],
    source: Path,
    out: Path,
    clips: Sequence[ClipJob],
    fingerprint: str,
    processes: int = 1,
) -> None:
    """Sense clips as a dataset with this recipe holds them.

    Parameters
    ----------
    recipe : mapping
        Of a sensed dataset's lock.
    source, out : Path
        Directories laid out like datasets: where the radiance of these clips is, and where they are to be.
    clips : sequence of ClipJob
    fingerprint : str
        Id for the receipts.
    processes : int

    Raises
    ------
    DatasetError
        If the recipe makes no sense, or a clip's radiance is damaged.
    """
    told = recipe["sensed"]
    try:
        keys = CameraKeys.model_validate({"camera": recipe["camera"], "sensor": recipe["sensor"]})
        side, seed = int(told["side_px"]), int(told["seed"])
    except (ValidationError, InputError, KeyError, TypeError, ValueError):
        raise DatasetError(f"{LOCK}: what it says of the camera makes no sense") from None
    if clips:
        film = Film(source, out, keys, side, seed, fingerprint)
        _make(film, list(clips), len(clips), processes, lambda done, total: None)


def _opened(source: Path) -> tuple[dict[str, Any], list[ClipJob]]:
    lock, told = read_lock(source), finished_description(source)
    stored = open_source(source, allow_partial=False)
    missing = [name for name in DEFAULT_LAYERS if name not in stored.layers]
    if missing:
        raise InputError(
            f"{source} holds no layer '{missing[0]}'; sensing again needs {', '.join(DEFAULT_LAYERS)}"
        )
    if told["missing"]:
        raise InputError(f"{source} lacks clips of its plan; make them first (scenegen repair)")
    return lock, [stored.record(clip).job for clip in range(len(stored.lines))]


def _lock(old: Mapping[str, Any], chosen: NewCamera, seed: int, out: Path) -> dict[str, Any]:
    """The lock of the new dataset: the old recipe with the new camera, and whence its radiance comes."""
    recipe = {
        **old["recipe"],
        "camera": chosen.camera.model_dump(mode="json"),
        "sensor": chosen.sensor.model_dump(mode="json"),
        "sensed": {"recipe_id": old["recipe_id"], "seed": seed, "side_px": chosen.side},
    }
    ours = fingerprint({})
    lock = make_lock(
        {name: value for name, value in recipe.items() if name == "pairs" or name not in VOLATILE_KEYS},
        name=dataset_name(out),
        scene_semantics=old["scene_semantics"],
        render={name: value for name, value in old["fingerprint"].items() if name not in ours},
        license=old.get(KEY),
    )
    others = [{**p, **ours} for p in old["mixed_with"]]
    lock[SOURCE] = {name: old[name] for name in _KEPT if name in old}
    return {**lock, "mixed_with": [p for p in others if fingerprint_id(p) != lock["fingerprint_id"]]}


def _yaml(old: Mapping[str, Any], asked: Mapping[str, Any], seed: int) -> str:
    head = f"# Sensed from the radiance of dataset {old['name']}, recipe {old['recipe_id']}.\n"
    return head + str(yaml.safe_dump({**asked, "seed": seed}, sort_keys=True, allow_unicode=True))


def _make(film: Film, missing: list[ClipJob], total: int, processes: int, told: Told) -> None:
    done = total - len(missing)
    tasks = [Task(job.name, f"{job.map}-{job.world}", payload_of(job)) for job in missing]
    count = min(processes, len(missing))
    with Pool(WORKER, setup_of(film), count, environment=ENVIRONMENT) as pool:
        for event in pool.run(tasks):
            if isinstance(event, Failed):
                kinds = {NoSpaceError.exit_code: NoSpaceError, InputError.exit_code: InputError}
                raise kinds.get(event.failure.exit_code or -1, DatasetError)(event.failure.message)
            if isinstance(event, Done):
                done += 1
                told(done, total)
