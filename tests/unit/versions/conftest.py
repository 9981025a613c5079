"""Hand-made datasets, as for the tests of the files themselves, and a way to die in the middle."""

from __future__ import annotations

import itertools
import os
from collections.abc import Callable, Sequence
from dataclasses import replace
from pathlib import Path
from types import ModuleType, SimpleNamespace
from typing import Any

import pytest

import fakes as _fakes
from scenegen.foundation.lock import DirectoryLock
from scenegen_datasets.clip import ClipRecord
from scenegen_datasets.job import ClipJob
from scenegen_datasets.layers import DEFAULT_LAYERS
from scenegen_datasets.lock import fingerprint, make_lock
from scenegen_datasets.store import create_or_open


@pytest.fixture(scope="session")
def fakes() -> ModuleType:
    return _fakes


class Killed(BaseException):
    """Death at a call that touches the disk."""


def run_until(step: int, act: Callable[[], object]) -> bool:
    """Run `act`, and at its `step`-th call that touches the disk die there; returns whether it died.

    From the death on every such call fails, so that no clean-up changes anything, as after SIGKILL. The lock's
    descriptor stays open in this process: go on in a copy of the directory.
    """
    steps = itertools.count(1)
    dead = False

    def counted(call: Callable[..., object]) -> Callable[..., object]:
        def wrapper(*args: object, **kwargs: object) -> object:
            nonlocal dead
            dead = dead or next(steps) >= step
            if dead:
                raise Killed
            return call(*args, **kwargs)

        return wrapper

    with pytest.MonkeyPatch.context() as patch:
        for name in ("write", "fsync", "replace", "unlink", "link", "mkdir"):
            patch.setattr(os, name, counted(getattr(os, name)))
        try:
            act()
        except Killed:
            return True
    assert not dead
    return False


@pytest.fixture
def dies() -> Callable[[int, Callable[[], object]], bool]:
    """``dies(step, act)``: run `act` and die at its `step`-th call that touches the disk; False if it lived."""
    return run_until


SENSOR = {"scale_K": [233.0, 423.0], "linear_in": "radiance", "netd_mk": 50.0}


def _make_map(root: Path, map: str, clips: int = 6, **more: Any) -> Path:
    """A dataset of another map; `more` are recipe keys, `shape`, `layers`, and `change`, which alters a record."""
    change = more.pop("change", lambda record: record)
    shape, layers = more.pop("shape", _fakes.SHAPE), more.pop("layers", DEFAULT_LAYERS)
    camera = {"width_px": shape[1], "band_um": [8.0, 14.0]}
    recipe = {
        "pairs": clips * _fakes.PAIRS,
        "map": [map],
        "seed": 0,
        "sensor": SENSOR,
        "camera": camera,
        **more,
    }
    lock = make_lock(recipe, name=root.name, scene_semantics=3, render=_fakes.RENDER)
    plan = [replace(job, map=map) for job in _fakes.jobs(clips)]
    root.mkdir(exist_ok=True)
    with DirectoryLock(root):
        create_or_open(root, f"map: {map}\n", lock)
        for job in plan:
            frames = _fakes.encoded(job, layers, shape)
            _fakes.commit_clip(root, change(_record(job, shape)), frames, fingerprint=_fakes.FINGERPRINT)
        _fakes.finish(root, plan)
    return root


def _record(job: ClipJob, shape: tuple[int, int] = _fakes.SHAPE) -> ClipRecord:
    record = _fakes.record(job, shape)
    return replace(record, weather={**record.weather, "cloud_fraction": 0.5})


@pytest.fixture
def studio(monkeypatch: pytest.MonkeyPatch) -> list[str]:
    """Clips of these maps are made again without a renderer; gives the names of those that were."""
    made: list[str] = []

    def job_of(root: Path, entry: dict[str, Any], into: Any = None, _: int = 1) -> Any:
        (map,), clips = entry["recipe"]["map"], entry["recipe"]["pairs"] // _fakes.PAIRS
        plan = tuple(replace(job, map=map) for job in _fakes.jobs(clips))
        return SimpleNamespace(root=into or root, clips=plan)

    def remake(job: Any, clips: Sequence[ClipJob], fingerprint: str, *_: Any) -> dict[str, str]:
        for clip in clips:
            _fakes.commit_clip(job.root, _record(clip), _fakes.encoded(clip), fingerprint=fingerprint)
            made.append(clip.name)
        return {}

    monkeypatch.setattr("scenegen_datasets.repair.again.job_of", job_of)
    monkeypatch.setattr("scenegen_datasets.repair.again.located", lambda job, *_: job)
    monkeypatch.setattr("scenegen_datasets.repair.again.remake", remake)
    monkeypatch.setattr(
        "scenegen_datasets.repair.remake.fingerprint_here", lambda: fingerprint(_fakes.RENDER)
    )
    return made


@pytest.fixture(scope="session")
def make_map() -> Callable[..., Path]:
    """``make_map(root, map, clips, **recipe keys)``: a finished dataset."""
    return _make_map


@pytest.fixture(scope="session")
def parts(tmp_path_factory: pytest.TempPathFactory) -> dict[str, Path]:
    """Three maps, read-only."""
    base = tmp_path_factory.mktemp("parts")
    return {
        name: _make_map(base / name, name, clips, seed=seed)
        for name, clips, seed in (("city", 6, 0), ("field", 4, 1), ("coastline", 2, 0))
    }


@pytest.fixture(autouse=True)
def without_pictures(request: pytest.FixtureRequest, monkeypatch: pytest.MonkeyPatch) -> None:
    """Only one test draws them: they are most of the time of a merge of such small clips."""
    if "verifies_loads" not in request.node.name:
        monkeypatch.setattr("scenegen_datasets.versions.merge.write_preview", lambda _: None)
