"""Depth and visibility against a float64 ray-triangle oracle on the same mesh."""

from __future__ import annotations

import math

import numpy as np
import pytest

from scenegen.foundation.rng import stream
from scenegen.radiometry.atmosphere import Atmosphere
from scenegen_render import reference_scenes
from scenegen_render.camera import Camera
from scenegen_render.knobs import RenderKnobs
from scenegen_render.reference_depth import reference_depth
from scenegen_render.reference_scenes import looking
from scenegen_render.scene import load
from scenegen_render.trace import Tracer

ONE_RAY = RenderKnobs(sub_samples=1)


def test_depth_of_a_city_agrees_with_float64_ray_triangle_tests(city, loaded_city, warm_city, sky_light):
    camera = Camera.from_fov(256, 256, 90.0)
    tracer = Tracer(camera, ONE_RAY)
    lit = tracer.light(loaded_city, warm_city, sky_light)
    rng = stream(3, "depth")
    doubtful = 0
    for _ in range(4):
        place = (*(float(v) for v in rng.uniform(-100, 100, 2)), float(rng.uniform(62, 90)))
        pose = looking(place, float(rng.uniform(0, 360)), float(rng.uniform(-60, -10)))
        depth = tracer.frame(lit, pose, pose).depth.astype(np.float64)
        truth = reference_depth(city.mesh, camera, pose)
        near, far = truth.near, truth.far
        sure, unsure = near == far, near != far
        assert (np.isinf(depth) == np.isinf(near))[sure].all()
        hit = sure & np.isfinite(near)
        assert hit.mean() > 0.3
        assert np.abs(depth[hit] / near[hit] - 1.0).max() <= 2e-7
        inside = (depth >= near * (1 - 1e-6)) & ((depth <= far * (1 + 1e-6)) | np.isinf(far))
        assert inside[unsure].all()
        doubtful += int(unsure.sum())
    assert doubtful < 0.02 * 4 * 256 * 256


@pytest.mark.parametrize("heading", [0.0, 77.0, 151.0, 240.0, 313.0])
def test_no_ray_escapes_a_closed_room_and_depth_is_the_walls(surface, heading):
    room = load(reference_scenes.room((surface("brick_red"),), cell_m=0.5))
    camera = Camera.from_fov(448, 448, 110.0)
    tracer = Tracer(camera, ONE_RAY)
    air = Atmosphere(air_K=290.0, vapour_pressure_hPa=5.0)
    dark = np.zeros(len(room.world.sites.area), np.float32)
    lit = tracer.light(room, reference_scenes.uniform_state(room.world, 290.0, air), dark)
    rng = stream(11, "room", int(heading))
    pose = looking(
        (3.1, float(rng.uniform(1, 5)), float(rng.uniform(5.5, 9))), heading, float(rng.uniform(-80, 80))
    )
    frame = tracer.frame(lit, pose, pose)
    assert np.isfinite(frame.depth).all()
    point = _world_points(camera, pose, frame.depth)
    on_wall = np.minimum(np.abs(point), np.abs(point - 10.0)).min(axis=-1)
    on_wall = np.where(frame.instance == 7, 0.0, on_wall)
    assert on_wall.max() < 2e-6 * frame.depth.max()


@pytest.mark.parametrize("offset_m", [0.0, 1e3, 9e4])
def test_depth_holds_far_from_the_origin(surface, offset_m):
    sheet = reference_scenes.Patch(
        (offset_m - 100, -100, 0), (200, 0, 0), (0, 200, 0), (100, 100), 0, reference_scenes.Semantic.ROAD, 1
    )
    loaded = load(reference_scenes.world_of("far", [sheet], (surface("asphalt_aged"),)))
    camera = Camera.from_fov(128, 128, 90.0)
    tracer = Tracer(camera, ONE_RAY)
    air = Atmosphere(air_K=290.0, vapour_pressure_hPa=5.0)
    dark = np.zeros(len(loaded.world.sites.area), np.float32)
    lit = tracer.light(loaded, reference_scenes.uniform_state(loaded.world, 290.0, air), dark)
    pose = looking((offset_m + 1.5, 0.25, 30.0), 33.0, -90.0)
    depth = tracer.frame(lit, pose, pose).depth
    assert np.isfinite(depth).all()  # robust intersections: without them a fifth of the rays falls through
    np.testing.assert_allclose(depth, 30.0, rtol=1e-6)


def test_normals_face_the_camera_in_its_frame(surface):
    loaded = load(reference_scenes.plate(surface("asphalt_aged")))
    tracer = Tracer(Camera.from_fov(32, 32, 60.0), RenderKnobs(sub_samples=1, normals=True))
    air = Atmosphere(air_K=290.0, vapour_pressure_hPa=5.0)
    dark = np.zeros(len(loaded.world.sites.area), np.float32)
    lit = tracer.light(loaded, reference_scenes.uniform_state(loaded.world, 290.0, air), dark)
    pose = looking((0.0, 0.0, 10.0), 50.0, -30.0)
    frame = tracer.frame(lit, pose, pose)
    assert frame.normal is not None
    up_in_camera = np.array([0.0, -math.cos(math.radians(30)), -math.sin(math.radians(30))])
    ground = np.isfinite(frame.depth)
    np.testing.assert_allclose(
        frame.normal[ground], np.broadcast_to(up_in_camera, (ground.sum(), 3)), atol=1e-6
    )
    assert (frame.normal[~ground] == 0).all() and (~ground).any()
    below = looking((0.0, 0.0, -10.0), 50.0, 30.0)
    under = tracer.frame(lit, below, below)
    assert under.normal is not None
    assert (under.normal[np.isfinite(under.depth)][:, 2] < 0).all()


def _world_points(camera: Camera, pose: np.ndarray, depth: np.ndarray) -> np.ndarray:
    rows, columns = np.mgrid[0 : camera.height_px, 0 : camera.width_px] + 0.5
    x = (columns - camera.centre_px[0]) / camera.focal_px
    y = (rows - camera.centre_px[1]) / camera.focal_px
    return (np.stack([x, y, np.ones_like(x)], axis=-1) * depth[..., None]) @ pose[:3, :3].T + pose[:3, 3]
