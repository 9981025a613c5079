"""Frames to measure codecs and loaders on: a street canyon in closed form, or what a dataset holds."""

from __future__ import annotations

import platform
from collections.abc import Iterator
from importlib.metadata import version
from pathlib import Path

import numpy as np
from scipy.ndimage import gaussian_filter

from scenegen_datasets import PairDataset
from scenegen_datasets.encode import FrameMeta
from scenegen_datasets.layers import DEFAULT_LAYERS
from scenegen_render.frame import Frame
from scenegen_render.sensor.reading import Reading

FOCAL = 0.5  # of the width: 90 degrees


def street(size: int, seed: int) -> tuple[Frame, Reading, FrameMeta]:
    """Facades, ground and sky seen along a street, with windows, textured temperature and camera noise."""
    rng = np.random.default_rng(seed)
    v, u = np.mgrid[0:size, 0:size] + 0.5
    f = FOCAL * size
    x, y = (u - size / 2) / f, (v - size / 2) / f
    depth = np.where(y > 0.01, 18.0 / np.maximum(y, 1e-6), np.inf)
    ids = np.where(np.isfinite(depth), 1, 0)
    for k in range(60):
        side, near = rng.choice([-1.0, 1.0]) * rng.uniform(8, 60), rng.uniform(10, 500)
        z = side / np.where(x * side > 0, x, np.nan)
        facade = (
            (z > near) & (z < near + rng.uniform(8, 30)) & (-y * z + 18 < rng.uniform(6, 70)) & (y * z < 18)
        )
        facade &= np.nan_to_num(z, nan=np.inf) < depth
        depth, ids = np.where(facade, z, depth), np.where(facade, k + 2, ids)
    sky = ids == 0
    finite = np.where(sky, 0, depth)
    window = (ids > 1) & (np.floor(finite * 0.7) % 2 == 0) & (np.floor(y * finite * 0.6) % 2 == 0)
    texture = gaussian_filter(rng.normal(size=(size, size)), 1.0) + 0.3 * rng.normal(size=(size, size))
    kelvin = 280 + rng.uniform(-8, 8, 100)[ids] + 3 * window + 0.8 * texture
    radiance = np.where(sky, 14 + 20 * np.abs(y + 1), 9.4e-9 * kelvin**4).astype(np.float32)
    counts = (radiance - 10) / 150 * 16383 + rng.normal(0, 3, radiance.shape)
    far = np.where(sky, 1e9, depth)
    moved = np.stack(
        [(x * far - 0.1) / (far - 1) * f - x * f, (y * far - 0.02) / (far - 1) * f - y * f], axis=-1
    )
    to = moved + np.stack([u, v], axis=-1)
    frame = Frame(
        radiance=radiance,
        depth=depth.astype(np.float32),
        temperature=np.where(sky, 0, kelvin).astype(np.float32),
        semantic=np.where(sky, 0, np.where(window, 12, np.where(ids == 1, 1, 10))).astype(np.uint8),
        instance=(ids * 37).astype(np.uint32),
        material=np.where(sky, 0, np.where(window, 20, 1 + ids % 15)).astype(np.uint16),
        flow=moved.astype(np.float32),
        covisible=((to > 0) & (to < size)).all(axis=-1) & (rng.uniform(size=sky.shape) > 0.005),
    )
    reading = Reading(np.clip(np.round(counts), 0, 16383).astype(np.uint16), saturated=0)
    pose = np.eye(4)
    pose[2, 3] = 18.0
    K = np.array([[f, 0, size / 2], [0, f, size / 2], [0, 0, 1.0]])
    return frame, reading, FrameMeta(0.05 * seed, pose, K, {"saturated": 0})


def stored(dataset: Path, count: int) -> Iterator[tuple[Frame, Reading, FrameMeta]]:
    """Frames spread over a dataset."""
    pairs = PairDataset(dataset, layers=DEFAULT_LAYERS, allow_partial=True)
    for i in np.linspace(0, len(pairs) - 1, count).astype(int):
        s = pairs[i]
        layers = {name: s[name] for name in DEFAULT_LAYERS if name != "thermal"}
        meta = FrameMeta(s["time_s"], s["world_from_camera"], s["K"], {"saturated": 0})
        yield Frame(**layers), Reading(s["thermal"], 0), meta


def machine() -> str:
    """Processor and versions, in one line."""
    text = Path("/proc/cpuinfo").read_text(encoding="utf-8") if Path("/proc/cpuinfo").exists() else ""
    names = [line.partition(":")[2].strip() for line in text.splitlines() if line.startswith("model name")]
    packages = ("numpy", "opencv-python-headless", "OpenEXR", "pillow")
    versions = ", ".join(f"{p} {version(p)}" for p in packages)
    return f"{(names or [platform.machine()])[0]}; Python {platform.python_version()}, {versions}"
