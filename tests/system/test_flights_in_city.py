"""Flights through a real city, judged by the renderer: its rays know nothing of the tree that proved the paths."""

from __future__ import annotations

import numpy as np
import pytest

from scenegen.classes import Semantic
from scenegen.climate.season import Season
from scenegen.foundation.rng import stream
from scenegen.maps.registry import build_world, map_family
from scenegen.world import World
from scenegen_flythrough.airspace import Airspace
from scenegen_flythrough.fly import fly
from scenegen_flythrough.knobs import FlightKnobs
from scenegen_flythrough.trajectory import Trajectory
from scenegen_render import backend
from scenegen_render.scene import LoadedWorld, load

SEASON = Season(40.0, 7, 15)

FLIGHTS = 12
WISHES = (
    FlightKnobs(),
    FlightKnobs(height_m=(3.0, 8.0), speed_mps=(15.0, 22.2)),
    FlightKnobs(height_m=(2.0, 4.0), clearance_m=0.5, speed_mps=(2.0, 5.0)),
)
THIN = (Semantic.TREE, Semantic.SHRUB, Semantic.CAR)
"""What may be modelled by open shells, so that a ray from outside can meet a back side."""


@pytest.fixture(scope="module")
def town() -> World:
    knobs = map_family("city").knobs.model_validate({"extent_m": 400.0})
    return build_world("city", knobs, SEASON, stream(4, "town"))


@pytest.fixture(scope="module")
def flights(town: World) -> list[Trajectory]:
    airspace = Airspace(town)
    return [fly(town, WISHES[k % 3], 33, stream(4, "flight", k), airspace) for k in range(FLIGHTS)]


@pytest.fixture(scope="module")
def loaded(town: World) -> LoadedWorld:
    backend.set_threads(1)
    return load(town)


def cast(loaded: LoadedWorld, origins: np.ndarray, directions: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Distance along each ray (infinite for none) and the face met."""
    mi, _ = backend.modules()
    three = lambda v, kind: kind(*(mi.Float(v[:, k].astype(np.float32)) for k in range(3)))  # noqa: E731
    ray = mi.Ray3f(three(origins, mi.Point3f), three(directions, mi.Vector3f))
    hit = loaded.scene.ray_intersect_preliminary(ray, coherent=False)
    return np.array(hit.t), np.array(hit.prim_index)


def rays_along(path: np.ndarray, count: int, rng: np.random.Generator) -> tuple[np.ndarray, np.ndarray]:
    """Random rays from four points of every chord."""
    share = np.arange(4)[:, None] / 4
    points = (path[:-1, None] + share * (path[1:] - path[:-1])[:, None]).reshape(-1, 3)
    directions = rng.normal(size=(len(points) * count, 3))
    return np.repeat(points, count, axis=0), directions / np.linalg.norm(directions, axis=1, keepdims=True)


def test_no_ray_is_shorter_than_the_clearance(flights: list[Trajectory], loaded: LoadedWorld) -> None:
    shortest = []
    for index, trajectory in enumerate(flights):
        origins, directions = rays_along(trajectory.world_from_camera[:, :3, 3], 128, stream(5, index))
        distance = cast(loaded, origins, directions)[0]
        assert distance.min() >= trajectory.clearance_m - 1e-3
        shortest.append(distance.min() - trajectory.clearance_m)
    # and the clearance is tight, not merely safe: what comes nearest may be a wire or a twig that all rays miss
    assert np.median(shortest) < 0.4


def test_every_view_is_from_outside_and_shows_something(
    town: World, flights: list[Trajectory], loaded: LoadedWorld
) -> None:
    """From inside a house nearly every ray would meet a back side; from outside hardly any does."""
    y, x = (v.ravel() for v in np.mgrid[-1:1:24j, -1:1:24j])
    pixels = np.stack([x, y, np.ones_like(x)], axis=1)
    corners = town.mesh.vertices[town.mesh.faces].astype(np.float64)
    for trajectory in flights:
        for pose in trajectory.world_from_camera[1:-1:8]:
            rays = pixels @ pose[:3, :3].T
            rays /= np.linalg.norm(rays, axis=1, keepdims=True)
            distance, face = cast(loaded, np.repeat(pose[None, :3, 3], len(rays), axis=0), rays)
            seen = np.isfinite(distance)
            assert seen.mean() > 0.3
            a, b, c = (corners[face[seen], k] for k in range(3))
            normal = np.cross(b - a, c - a)
            behind = (normal * rays[seen]).sum(axis=1) > 1e-3 * np.linalg.norm(normal, axis=1)
            solid = ~np.isin(town.face_semantic[face[seen]], THIN)
            assert (behind & solid).mean() < 0.02  # a seam or a dish, never a room


def test_low_flights_are_found_in_streets_without_long_search(flights: list[Trajectory]) -> None:
    assert max(trajectory.rejected for trajectory in flights) < 256
