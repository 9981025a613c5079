"""Eyes for the city of boxes: rays against boxes and ground by the slab test, no mesh, no renderer."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
import pytest

from scenegen_flythrough.loop.contact import Obstacles
from scenegen_render.camera import Camera

Look = Callable[[np.ndarray, Camera, np.ndarray], np.ndarray]


def box_depth(boxes: np.ndarray, camera: Camera, poses: np.ndarray) -> np.ndarray:
    """Planar depth of boxes (boxes, 2, 3) on flat ground; +inf for sky, and what lies 90 m away."""
    v, u = np.mgrid[0 : camera.height_px, 0 : camera.width_px] + 0.5
    rays = np.stack(
        [
            (u - camera.centre_px[0]) / camera.focal_px,
            (v - camera.centre_px[1]) / camera.focal_px,
            np.ones_like(u),
        ],
        axis=-1,
    ).reshape(-1, 3)
    images = []
    for pose in poses:
        boxes_near = boxes[np.abs(boxes[:, :, :2].mean(axis=1) - pose[:2, 3]).max(axis=1) < 90.0]
        way, eye = rays @ pose[:3, :3].T, pose[:3, 3]
        with np.errstate(divide="ignore", invalid="ignore"):
            best = np.where(way[:, 2] < 0.0, -eye[2] / way[:, 2], np.inf)
            for low, high in boxes_near:
                near, far = (low - eye) / way, (high - eye) / way
                enter, leave = np.minimum(near, far).max(axis=1), np.maximum(near, far).min(axis=1)
                best = np.where((enter <= leave) & (enter > 0.0), np.minimum(best, enter), best)
        images.append(best.reshape(camera.height_px, camera.width_px))
    return np.array(images, np.float32)


@pytest.fixture(scope="session")
def look() -> Look:
    return box_depth


@pytest.fixture(scope="session")
def camera() -> Camera:
    return Camera.from_fov(64, 36, 90.0)


@pytest.fixture(scope="session")
def city_obstacles(city, city_air) -> Obstacles:
    return Obstacles(city.world, city_air.proximity)
