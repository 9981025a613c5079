"""A small city of boxes whose solid parts are known exactly, so that flights can be judged without the mesh queries."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import pytest

from scenegen.world import HeightField, Sites, TriangleMesh, World
from scenegen_flythrough.airspace import Airspace

_BOX = np.array([[x, y, z] for z in (0, 1) for y in (0, 1) for x in (0, 1)], np.float64)
_BOX_FACES = np.array(
    [
        [0, 2, 3], [0, 3, 1], [4, 5, 7], [4, 7, 6], [0, 1, 5], [0, 5, 4],
        [2, 6, 7], [2, 7, 3], [0, 4, 6], [0, 6, 2], [1, 3, 7], [1, 7, 5],
    ]
)  # fmt: skip


@dataclass(frozen=True, eq=False)
class BoxCity:
    """A world and the axis-aligned boxes that stand in it: (boxes, 2, 3) lower and upper corners."""

    world: World
    boxes: np.ndarray


def box_city(
    boxes: np.ndarray,
    extent_m: float = 300.0,
    ceiling_m: float = 90.0,
    hill_m: float = 0.0,
    cell_m: float = 4.0,
) -> BoxCity:
    """Ground (flat, or a long hill) with closed boxes, wound counter-clockwise seen from outside."""
    n = round(extent_m / cell_m)
    axis = np.arange(n + 1) * cell_m - extent_m / 2
    x, y = np.meshgrid(axis, axis)
    height = (hill_m * np.sin(x / 60.0) * np.cos(y / 75.0)).astype(np.float32)
    ground = np.stack([x.ravel(), y.ravel(), height.ravel().astype(np.float64)], axis=1)
    k = (np.arange(n)[:, None] * (n + 1) + np.arange(n)).ravel()
    cells = np.concatenate(
        [np.stack([k, k + 1, k + n + 2], axis=1), np.stack([k, k + n + 2, k + n + 1], axis=1)]
    )
    vertices, faces = [ground], [cells]
    for index, (low, high) in enumerate(boxes):
        vertices.append(low + _BOX * (high - low))
        faces.append(_BOX_FACES + len(ground) + 8 * index)
    mesh = TriangleMesh(np.concatenate(vertices).astype(np.float32), np.concatenate(faces).astype(np.uint32))
    count = len(mesh.faces)
    none = np.zeros(0, np.float32)
    sites = Sites(
        np.zeros((0, 3), np.float32), np.zeros((0, 3), np.float32), none,
        np.zeros(0, np.uint16), np.zeros(0, np.uint32), none,
    )  # fmt: skip
    edge = extent_m / 2 - 10.0
    world = World(
        map="boxes",
        mesh=mesh,
        face_surface=np.zeros(count, np.uint16),
        face_semantic=np.zeros(count, np.uint8),
        face_object=np.zeros(count, np.uint32),
        corner_site=np.zeros((count, 3), np.uint32),
        sites=sites,
        palette=(),
        ground=HeightField((-extent_m / 2, -extent_m / 2), cell_m, height),
        flight_box_m=((-edge, -edge, -hill_m), (edge, edge, ceiling_m)),
        counts=(),
    )
    return BoxCity(world, boxes)


def street_boxes(seed: int = 5, extent_m: float = 300.0, hill_m: float = 0.0) -> np.ndarray:
    """Blocks on a jittered raster with streets 12-18 m wide, houses of 8-60 m, and thin poles in the streets."""
    rng = np.random.default_rng(seed)
    boxes = []
    for x in np.arange(-extent_m / 2 + 15, extent_m / 2 - 30, 42.0):
        for y in np.arange(-extent_m / 2 + 15, extent_m / 2 - 30, 36.0):
            corner = np.array([x, y]) + rng.uniform(0, 3, 2)
            size = np.array([26.0, 20.0]) + rng.uniform(-3, 3, 2)
            top = rng.choice([8.0, 14.0, 22.0, 35.0, 60.0])
            boxes.append([[*corner, -hill_m - 1.0], [*(corner + size), top]])
            pole = corner + np.array([size[0] + 1.2, rng.uniform(0, 20)])
            boxes.append([[*pole, -hill_m - 1.0], [*(pole + 0.12), 7.0]])
    return np.array(boxes)


@pytest.fixture(scope="session")
def city() -> BoxCity:
    return box_city(street_boxes())


@pytest.fixture(scope="session")
def hills() -> BoxCity:
    return box_city(street_boxes(8, hill_m=9.0)[::7], hill_m=9.0)


@pytest.fixture(scope="session")
def city_air(city: BoxCity) -> Airspace:
    return Airspace(city.world)


@pytest.fixture(scope="session")
def hills_air(hills: BoxCity) -> Airspace:
    return Airspace(hills.world)


@pytest.fixture(scope="session")
def build_city():
    """The builder itself, for tests that need a world of their own."""
    return box_city
