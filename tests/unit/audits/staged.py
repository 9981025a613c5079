"""Steps of worlds one can work out by hand: a plane before a camera that moves, painted with a known picture."""

from __future__ import annotations

from dataclasses import replace
from typing import Any

import numpy as np

from scenegen_datasets.audits.steps import Step, Still
from scenegen_render.sensor.scale import CountScale, counts_to_radiance

SHAPE = (96, 128)
K = np.array([[64.0, 0.0, 64.0], [0.0, 64.0, 48.0], [0.0, 0.0, 1.0]])
SCALE = CountScale(233.0, 423.0)
FACTS: dict[str, Any] = {"sun_elevation_deg": 20.0, "sensor": {"netd_mk": 50.0}}


def pose(right_m: float = 0.0, ahead_m: float = 0.0) -> np.ndarray:
    """A camera that looks along +y, moved to the right and ahead."""
    matrix = np.eye(4)
    matrix[:3, :3] = [[1.0, 0.0, 0.0], [0.0, 0.0, 1.0], [0.0, -1.0, 0.0]]
    matrix[:3, 3] = (right_m, ahead_m, 10.0)
    return matrix


def texture(x: np.ndarray, y: np.ndarray) -> np.ndarray:
    """A smooth picture in counts, as a function of places on the wall [m]."""
    waves = np.sin(1.3 * x + 0.4 * y) + np.cos(0.9 * y - 0.5 * x) + 0.7 * np.sin(2.9 * x) * np.cos(2.3 * y)
    return np.asarray(4500.0 + 120.0 * waves)


def wall(depth_m: float = 20.0, right_m: float = 0.5, ahead_m: float = 0.0) -> Step:
    """A step past a textured wall; flow, depth and pictures follow from the pinhole alone."""
    v, u = np.mgrid[0 : SHAPE[0], 0 : SHAPE[1]] + 0.5
    then_m = depth_m - ahead_m
    now = Still(
        pose(),
        _counts(u, v, depth_m, 0.0),
        np.full(SHAPE, depth_m, np.float32),
        flow=_flow(u, v, depth_m, right_m, ahead_m),
        covisible=np.ones(SHAPE, bool),
        semantic=np.full(SHAPE, 10, np.uint8),
        instance=np.ones(SHAPE, np.uint32),
    )
    back = Still(
        pose(right_m, ahead_m),
        _counts(u, v, then_m, right_m),
        np.full(SHAPE, then_m, np.float32),
        flow=_flow(u, v, then_m, -right_m, -ahead_m),
        covisible=np.ones(SHAPE, bool),
    )
    shown = [replace(still, radiance=counts_to_radiance(still.counts, SCALE)) for still in (now, back)]
    return step(*shown)


def step(now: Still, next: Still, world: str = "wall-00000", **facts: Any) -> Step:
    """A step of a world."""
    return Step(f"{world}-000-0000", world, f"{world}-000", "train", FACTS | facts, K, SCALE, now, next)


def _counts(u: np.ndarray, v: np.ndarray, depth_m: float, right_m: float) -> np.ndarray:
    x, y = (u - K[0, 2]) / K[0, 0] * depth_m + right_m, (v - K[1, 2]) / K[1, 1] * depth_m
    return np.asarray(np.rint(texture(x, y)), np.uint16)


def _flow(u: np.ndarray, v: np.ndarray, depth_m: float, right_m: float, ahead_m: float) -> np.ndarray:
    """u' - u of the point behind a pixel, by hand."""
    x, y = (u - K[0, 2]) / K[0, 0] * depth_m, (v - K[1, 2]) / K[1, 1] * depth_m
    there = depth_m - ahead_m
    moved = K[0, 0] * (x - right_m) / there + K[0, 2], K[1, 1] * y / there + K[1, 2]
    return np.stack([moved[0] - u, moved[1] - v], axis=-1).astype(np.float32)
