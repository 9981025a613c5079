"""A small dataset a network can learn from: ground planes seen from various heights, warmer where they are near."""

from __future__ import annotations

import dataclasses
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import numpy as np
import pytest

import fakes
from scenegen.foundation.lock import DirectoryLock
from scenegen_datasets.commit import commit_clip
from scenegen_datasets.encode import EncodedFrame, encode_frame
from scenegen_datasets.finish import finish
from scenegen_datasets.job import ClipJob
from scenegen_datasets.layers import DEFAULT_LAYERS
from scenegen_datasets.lock import make_lock
from scenegen_datasets.store import create_or_open
from scenegen_render.sensor.knobs import SensorKnobs
from scenegen_render.sensor.reading import Reading

SHAPE = (32, 32)
PAIRS = 4
CLIPS = 12
LAYERS = (*DEFAULT_LAYERS, "flow_back", "covisible_back")


def depth_of(height_m: float) -> np.ndarray:
    """Ground below a horizon in the upper third, sky above it."""
    rows, columns = SHAPE
    below = np.arange(rows) + 0.5 - rows / 3.0
    depth = np.where(below > 0.0, height_m * 14.0 / np.maximum(below, 1e-3), np.inf)
    return np.repeat(depth[:, None], columns, axis=1).astype(np.float32)


def encoded(job: ClipJob, layers: tuple[str, ...], zoom: float = 1.0) -> Iterator[EncodedFrame]:
    rng = np.random.default_rng(job.ordinal)
    depth = depth_of(4.0 + 2.0 * (job.ordinal % 4))
    sky = np.isinf(depth)
    for k in range(job.frames):
        frame = fakes.frame(rng, SHAPE, extra=True)
        warmth = np.where(sky, 0.0, np.exp(-np.where(sky, 0.0, depth) / 30.0))
        ids = np.where(sky, 0, 1 + (np.arange(SHAPE[1]) // 16))
        frame = dataclasses.replace(
            frame,
            depth=depth,
            radiance=(20.0 + 30.0 * warmth).astype(np.float32),
            temperature=np.where(sky, 0.0, 270.0 + 40.0 * warmth).astype(np.float32),
            semantic=ids.astype(np.uint8),
            instance=ids.astype(np.uint32),
            material=ids.astype(np.uint16),
            normal=np.where(sky[..., None], 0.0, [0.0, 0.6, -0.8]).astype(np.float32),
        )
        counts = 2000.0 + 9000.0 * warmth + rng.normal(0.0, 60.0, SHAPE)
        reading = Reading(counts.astype(np.uint16), saturated=0)
        meta = fakes.meta(k)
        lens = dataclasses.replace(meta, K=np.diag([zoom, zoom, 1.0]) @ meta.K)
        yield encode_frame(job.key(k), frame, reading, lens, layers)


def make(root: Path, *, clips: int = CLIPS, layers: tuple[str, ...] = LAYERS, zooms: bool = False) -> Path:
    root.mkdir(parents=True)
    plan = fakes.jobs(clips, PAIRS)
    recipe: dict[str, Any] = {
        "pairs": clips * PAIRS,
        "map": "city",
        "camera": {"width_px": SHAPE[1]},
        "sensor": SensorKnobs().model_dump(mode="json"),
    }
    lock = make_lock(recipe, name="toy", scene_semantics=1, render=fakes.RENDER)
    with DirectoryLock(root):
        create_or_open(root, "map: city\n", lock)
        for job in plan:
            record = fakes.record(job, SHAPE)
            zoom = 1.5 if zooms and job.ordinal % 2 else 1.0
            commit_clip(root, record, encoded(job, layers, zoom), fingerprint=fakes.FINGERPRINT)
        finish(root, plan)
    return root


@pytest.fixture(scope="session")
def toy(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """Twelve clips of four pairs: worlds 0 and 3 to 5 train, 1 validates, 2 tests."""
    return make(tmp_path_factory.mktemp("toy") / "data")


@pytest.fixture(scope="session")
def bare(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """The same without true flow towards the previous frame, and without any split but train."""
    return make(tmp_path_factory.mktemp("bare") / "data", clips=2, layers=("thermal", "depth"))


@pytest.fixture(scope="session")
def zooming(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """Every other clip through a longer lens."""
    return make(tmp_path_factory.mktemp("zooming") / "data", layers=("thermal", "depth"), zooms=True)
