"""Small random but valid frames, clips and datasets; importable by tests and by the child processes they start."""

from __future__ import annotations

from collections.abc import Iterator
from pathlib import Path
from typing import Any

import numpy as np

from scenegen.foundation.lock import DirectoryLock
from scenegen_datasets.clip import ClipRecord
from scenegen_datasets.commit import commit_clip
from scenegen_datasets.encode import EncodedFrame, FrameMeta, encode_frame
from scenegen_datasets.finish import finish
from scenegen_datasets.job import ClipJob
from scenegen_datasets.layers import DEFAULT_LAYERS
from scenegen_datasets.lock import fingerprint, fingerprint_id, make_lock
from scenegen_datasets.store import create_or_open, finished
from scenegen_render.frame import Frame
from scenegen_render.sensor.reading import Reading

SHAPE = (12, 16)
PAIRS = 3
K = np.array([[14.0, 0.0, 8.0], [0.0, 14.0, 6.0], [0.0, 0.0, 1.0]])
RENDER = {"mitsuba": "3.9.1", "variant": "llvm_ad_mono"}
FINGERPRINT = fingerprint_id(fingerprint(RENDER))


def jobs(clips: int, pairs: int = PAIRS) -> list[ClipJob]:
    """Two clips a world; world 1 validates, world 2 tests."""
    splits = {1: "val", 2: "test"}
    return [ClipJob(k, "city", k // 2, k % 2, splits.get(k // 2, "train"), pairs) for k in range(clips)]


def frame(rng: np.random.Generator, shape: tuple[int, int] = SHAPE, extra: bool = False) -> Frame:
    rows, columns = shape
    sky = np.arange(rows)[:, None] + np.zeros(columns) < rows // 4
    depth = np.where(sky, np.inf, rng.uniform(2, 300, shape)).astype(np.float32)
    temperature = np.where(sky, 0, rng.uniform(260, 320, shape)).astype(np.float32)
    ids = np.where(sky, 0, rng.integers(1, 30, shape))
    covisible = rng.uniform(size=shape) < 0.9
    covisible[[0, -1]] = covisible[:, [0, -1]] = False
    flow = rng.uniform(-0.4, 0.4, (*shape, 2)).astype(np.float32)
    flow[-1, -1] = np.nan
    normal = np.where(sky[..., None], 0, [0.0, 0.6, -0.8]).astype(np.float32)
    return Frame(
        radiance=rng.uniform(10, 60, shape).astype(np.float32),
        depth=depth,
        temperature=temperature,
        semantic=ids.astype(np.uint8),
        instance=(ids * 70_001).astype(np.uint32),
        material=ids.astype(np.uint16),
        flow=flow,
        covisible=covisible,
        flow_back=-flow if extra else None,
        covisible_back=covisible.copy() if extra else None,
        normal=normal if extra else None,
    )


def reading(rng: np.random.Generator, shape: tuple[int, int] = SHAPE) -> Reading:
    return Reading(rng.integers(0, 16384, shape).astype(np.uint16), saturated=int(rng.integers(0, 5)))


def meta(k: int) -> FrameMeta:
    pose = np.eye(4)
    pose[:3, 3] = (0.1 * k, 1.0, 20.0)
    motion = {"style": "survey", "velocity_mps": [2.0, 0.0, 0.1 * k]}
    return FrameMeta(0.05 * k, pose, K, {"fpa_temperature_K": 303.25, "frame_of_unit": k}, motion, imu(k))


def imu(k: int, columns: int = 7) -> np.ndarray:
    """Samples of 200 Hz until the next frame, of which there are ten, or nine, or eleven ..."""
    table = np.random.default_rng(k).normal(size=(10 + (k % 3 - 1), columns))
    table[:, 0] = 0.05 * k + 0.005 * np.arange(len(table))
    return table


def encoded(
    job: ClipJob, layers: tuple[str, ...] = DEFAULT_LAYERS, shape: tuple[int, int] = SHAPE
) -> Iterator[EncodedFrame]:
    rng = np.random.default_rng(job.ordinal)
    extra = bool({"flow_back", "normal"} & set(layers))
    for k in range(job.frames):
        yield encode_frame(job.key(k), frame(rng, shape, extra), reading(rng, shape), meta(k), layers)


def truth(clip: int) -> list[tuple[Frame, Reading]]:
    """Frames and readings of one clip, drawn again as `encoded` drew them."""
    rng = np.random.default_rng(clip)
    return [(frame(rng), reading(rng)) for _ in range(PAIRS + 1)]


def record(job: ClipJob, shape: tuple[int, int] = SHAPE) -> ClipRecord:
    return ClipRecord(
        job=job,
        latitude_deg=40.0 + job.world,
        month=7,
        day=15,
        hour=(5.5 * job.ordinal) % 24,
        sun_elevation_deg=-12.5 + job.ordinal,
        weather={"air_mean_K": 290.0 + job.ordinal, "wind_mps": 3.0},
        width_px=shape[1],
        height_px=shape[0],
        K=tuple(map(tuple, K.tolist())),
        band_um=(8.0, 14.0),
        sensor={"low_radiance": 11.2, "high_radiance": 160.5, "counts": 16383},
        speed_mps=10.0,
        spacing_m=1.0,
        clearance_m=3.25,
        rejected=job.ordinal,
        extra={"style": "street"},
    )


def lock(pairs: int, **changes: Any) -> dict[str, Any]:
    recipe = {
        "pairs": pairs,
        "out": "x",
        "jobs": 2,
        "map": "city",
        "camera": {"width_px": 16, "netd_mk": 50.0},
    }
    recipe["camera"] |= changes.pop("camera", {})
    return make_lock(recipe, name="city-16", scene_semantics=1, render=changes.pop("render", RENDER))


def make(
    root: Path, clips: int, order: int = 1, layers: tuple[str, ...] = DEFAULT_LAYERS, done: bool = True
) -> Path:
    """Make or continue a dataset; `order` -1 commits the clips last first."""
    root.mkdir(exist_ok=True)
    plan = jobs(clips)
    with DirectoryLock(root):
        create_or_open(root, f"map: city\npairs: {clips * PAIRS}\n", lock(clips * PAIRS))
        have = finished(root)
        for job in plan[::order]:
            if job.name not in have:
                commit_clip(root, record(job), encoded(job, layers), fingerprint=FINGERPRINT)
        if done:
            finish(root, plan)
    return root


def tree(root: Path) -> dict[str, bytes]:
    """All files but the log, by path."""
    return {
        str(p.relative_to(root)): p.read_bytes()
        for p in sorted(root.rglob("*"))
        if p.is_file() and p.name != "run.log.jsonl"
    }
