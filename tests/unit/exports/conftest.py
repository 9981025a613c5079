"""A small dataset whose cameras turn, and a way to export it."""

from __future__ import annotations

import hashlib
from collections.abc import Callable
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

import fakes
from scenegen.foundation.lock import DirectoryLock
from scenegen_datasets.clip import ClipRecord
from scenegen_datasets.commit import commit_clip
from scenegen_datasets.encode import FrameMeta, encode_frame
from scenegen_datasets.exports.engine import Outcome, export
from scenegen_datasets.exports.options import Options
from scenegen_datasets.exports.plan import Request
from scenegen_datasets.finish import finish
from scenegen_datasets.job import ClipJob
from scenegen_datasets.layers import DEFAULT_LAYERS
from scenegen_datasets.store import create_or_open, finished

Exporter = Callable[..., Outcome]


def meta(job: ClipJob, frame: int) -> FrameMeta:
    """A camera somewhere, turned anyhow: only then do swapped axes show."""
    rng = np.random.default_rng((job.ordinal, frame))
    pose = np.eye(4)
    pose[:3, :3] = Rotation.random(random_state=int(rng.integers(2**31))).as_matrix()
    pose[:3, 3] = rng.uniform(-300, 300, 3)
    return replace(fakes.meta(frame), world_from_camera=pose)


def record(job: ClipJob) -> ClipRecord:
    sensor = {
        "low_radiance": 15.13,
        "high_radiance": 215.4,
        "counts": 16384,
        "low_K": 233.0,
        "high_K": 423.0,
        "linear_in": "radiance",
    }
    return replace(fakes.record(job), sensor=sensor)


def _seen_by(camera: int, K: np.ndarray) -> np.ndarray:
    """Intrinsics of one of several cameras, longer one by one; the first is that of the hand-made frames."""
    return K * np.array([[1.0 + camera, 1.0, 1.0], [1.0, 1.0 + camera, 1.0], [1.0, 1.0, 1.0]])


def make(
    root: Path,
    clips: int = 6,
    layers: tuple[str, ...] = DEFAULT_LAYERS,
    cameras: int = 1,
    netd_mk: float = 50.0,
) -> Path:
    """Make or grow a dataset of clips with 3 pairs, two of each split; cameras take turns, as in a merged one."""
    root.mkdir(exist_ok=True)
    plan = fakes.jobs(clips)
    with DirectoryLock(root):
        create_or_open(root, "map: city\n", fakes.lock(clips * fakes.PAIRS, camera={"netd_mk": netd_mk}))
        have = finished(root)
        for job in (job for job in plan if job.name not in have):
            rng = np.random.default_rng(job.ordinal)
            K = _seen_by(job.ordinal % cameras, meta(job, 0).K)
            frames = (
                encode_frame(
                    job.key(k), fakes.frame(rng), fakes.reading(rng), replace(meta(job, k), K=K), layers
                )
                for k in range(job.frames)
            )
            facts = replace(record(job), K=tuple(map(tuple, K.tolist())))
            commit_clip(root, facts, frames, fingerprint=fakes.FINGERPRINT)
        finish(root, plan)
    return root


@pytest.fixture(scope="session")
def small(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A dataset that nobody changes."""
    return make(tmp_path_factory.mktemp("small") / "dataset")


@pytest.fixture(scope="session")
def make_dataset() -> Callable[..., Path]:
    """`make`, for tests that need another dataset."""
    return make


@pytest.fixture
def run(small: Path, tmp_path: Path) -> Exporter:
    """Export the small dataset, by default to ``out`` below the test's directory."""

    def call(to: str, out: str = "out", jobs: int = 1, dataset: Path = small, **rest: object) -> Outcome:
        splits, maps = rest.pop("splits", ()), rest.pop("maps", ())
        request = Request(dataset, tmp_path / out, to, Options(**rest), splits, maps)  # type: ignore[arg-type]
        return export(request, jobs)

    return call


@pytest.fixture
def tree() -> Callable[[Path], dict[str, str]]:
    """Path to SHA-256 of all files of an export."""

    def read(root: Path) -> dict[str, str]:
        files = (path for path in sorted(root.rglob("*")) if path.is_file())
        return {str(p.relative_to(root)): hashlib.sha256(p.read_bytes()).hexdigest() for p in files}

    return read
