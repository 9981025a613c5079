"""Flow and covisibility: follow every pixel into the other frame and look what is there."""

from __future__ import annotations

import math
from dataclasses import replace

import numpy as np
import pytest

from scenegen.classes import Semantic
from scenegen.foundation.rng import stream
from scenegen_render import backend
from scenegen_render.camera import Camera
from scenegen_render.knobs import RenderKnobs
from scenegen_render.reference_scenes import looking
from scenegen_render.trace import Tracer

CAMERA = Camera.from_fov(160, 128, 90.0)


def directions(camera: Camera, pose: np.ndarray, place: np.ndarray) -> np.ndarray:
    """World rays (z = 1 in the camera frame) through image places [px]."""
    plane = (place - camera.centre_px) / camera.focal_px
    return np.concatenate([plane, np.ones_like(plane[..., :1])], axis=-1) @ pose[:3, :3].T


def centres(camera: Camera) -> np.ndarray:
    rows, columns = np.mgrid[0 : camera.height_px, 0 : camera.width_px] + 0.5
    return np.stack([columns, rows], axis=-1)


def cast(loaded, pose: np.ndarray, d: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Planar depth and instance along rays, straight from the scene."""
    mi, _ = backend.modules()
    ray = mi.Ray3f(mi.Point3f(*map(float, pose[:3, 3])), mi.Vector3f(d.reshape(-1, 3).T.astype(np.float32)))
    pi = loaded.scene.ray_intersect_preliminary(ray)
    hit = np.asarray(pi.is_valid())
    face = np.where(hit, np.asarray(pi.prim_index), 0)
    return np.asarray(pi.t).reshape(d.shape[:-1]), np.where(hit, loaded.world.face_object[face], 0).reshape(
        d.shape[:-1]
    )


def pose_pairs(count: int) -> list[tuple[np.ndarray, np.ndarray]]:
    rng = stream(5, "flow")
    pairs = []
    for _ in range(count):
        x, y, z = (float(v) for v in (*rng.uniform(-90, 90, 2), rng.uniform(62, 80)))
        heading, pitch = float(rng.uniform(0, 360)), float(rng.uniform(-50, -15))
        step = rng.uniform(-1.5, 1.5, 3)
        ahead = looking((x + step[0], y + step[1], z + step[2]), heading + rng.uniform(-3, 3), pitch + 1.0)
        pairs.append((looking((x, y, z), heading, pitch), ahead))
    return pairs


@pytest.fixture(scope="module")
def lit_and_tracer(loaded_city, warm_city, sky_light):
    tracer = Tracer(CAMERA, RenderKnobs(sub_samples=1, backward_flow=True))
    return tracer.light(loaded_city, warm_city, sky_light), tracer


def test_a_covisible_pixel_shows_the_same_point_of_the_same_object_in_the_next_frame(
    lit_and_tracer, loaded_city
):
    lit, tracer = lit_and_tracer
    agreed = total = 0
    for pose, ahead in pose_pairs(6):
        frame = tracer.frame(lit, pose, ahead, pose)
        place = centres(CAMERA)
        d = directions(CAMERA, ahead, place + frame.flow)
        t, instance = cast(loaded_city, ahead, d)
        here = directions(CAMERA, pose, place) * frame.depth[..., None] + pose[:3, 3]
        there = d * t[..., None] + ahead[:3, 3]
        seen = frame.covisible & np.isfinite(frame.depth)
        with np.errstate(invalid="ignore"):
            near = np.linalg.norm(there - here, axis=-1) <= 1e-3 * frame.depth
        agreed += int((near & (instance == frame.instance))[seen].sum())
        total += int(seen.sum())
    assert total > 6 * 5_000
    assert agreed / total >= 0.999


def test_a_pixel_inside_the_next_frame_that_is_not_covisible_is_hidden_there(lit_and_tracer, loaded_city):
    lit, tracer = lit_and_tracer
    hidden = 0
    for pose, _ in pose_pairs(3):
        aside = pose.copy()
        aside[:3, 3] += 12.0 * pose[:3, 0]
        frame = tracer.frame(lit, pose, aside, pose)
        place = centres(CAMERA) + frame.flow
        inside = ((place > 0) & (place < (CAMERA.width_px, CAMERA.height_px))).all(axis=-1)
        lost = inside & ~frame.covisible & np.isfinite(frame.depth)
        t, _ = cast(loaded_city, aside, directions(CAMERA, aside, place))
        reach = np.where(np.isfinite(frame.depth), frame.depth, 1.0)[..., None]
        expected = _depth_from(aside, directions(CAMERA, pose, centres(CAMERA)) * reach + pose[:3, 3])
        assert (t[lost] < expected[lost] * (1.0 - 0.9e-3)).all()
        hidden += int(lost.sum())
        assert not (frame.covisible & ~inside).any()
    assert hidden > 300


def test_sky_flows_as_a_point_at_infinity(lit_and_tracer):
    lit, tracer = lit_and_tracer
    pose, ahead = looking((0, 0, 70), 20.0, 5.0), looking((3, 1, 70.5), 24.0, 3.0)
    frame = tracer.frame(lit, pose, ahead, pose)
    sky = frame.semantic == Semantic.SKY
    assert 0.2 < sky.mean() < 0.9
    d = directions(CAMERA, pose, centres(CAMERA)) @ ahead[:3, :3]
    expected = d[..., :2] / d[..., 2:] * CAMERA.focal_px + CAMERA.centre_px - centres(CAMERA)
    np.testing.assert_allclose(frame.flow[sky], expected[sky], atol=2e-4)
    shifted = pose.copy()
    shifted[:3, 3] += (1.0, -2.0, 0.3)
    still = tracer.frame(lit, pose, shifted, pose)
    np.testing.assert_allclose(still.flow[sky], 0.0, atol=2e-4)
    assert still.covisible[sky].mean() > 0.98  # a building's edge may move in front of it


def test_backward_flow_is_the_forward_flow_of_the_reversed_flight(lit_and_tracer):
    lit, tracer = lit_and_tracer
    (pose, ahead), *_ = pose_pairs(1)
    frame = tracer.frame(lit, pose, pose, ahead)
    reverse = tracer.frame(lit, pose, ahead, pose)
    assert frame.flow_back is not None and frame.covisible_back is not None
    np.testing.assert_array_equal(frame.flow_back, reverse.flow)
    np.testing.assert_array_equal(frame.covisible_back, reverse.covisible)
    np.testing.assert_allclose(frame.flow, 0.0, atol=2e-4)


def test_flow_is_nan_only_behind_the_other_camera(lit_and_tracer):
    lit, tracer = lit_and_tracer
    pose = looking((0.0, 0.0, 70.0), 0.0, -20.0)
    turned = looking((0.0, 0.0, 70.0), 180.0, -20.0)
    frame = tracer.frame(lit, pose, turned, pose)
    z = _depth_from(turned, directions(CAMERA, pose, centres(CAMERA)) + turned[:3, 3])
    behind = z < -1e-5
    assert np.isnan(frame.flow[behind]).all() and behind.any()
    assert np.isfinite(frame.flow[z > 1e-5]).all()
    assert not frame.covisible[behind].any()


def test_warped_temperatures_agree_because_the_texture_is_fixed_to_the_world(
    loaded_city, warm_city, sky_light, city
):
    """Shifted by whole pixels parallel to a flat ground, the next frame repeats this one, texture included."""
    tracer = Tracer(CAMERA, RenderKnobs(sub_samples=1))
    lit = tracer.light(loaded_city, warm_city, sky_light)
    height, pixels = 12.0, 5
    corner = (-150.0 + 2.0, -150.0 + 25.0, height)  # over the outer street
    pose = looking(corner, 90.0, -90.0)
    ahead = pose.copy()
    ahead[:3, 3] += pose[:3, 0] * height / CAMERA.focal_px * pixels
    here, there = tracer.frame(lit, pose, ahead), tracer.frame(lit, ahead, ahead)
    ground = (here.semantic == Semantic.ROAD) & (np.roll(there.semantic, pixels, axis=1) == Semantic.ROAD)
    ground[:, :pixels] = False
    assert ground.sum() > 2_000
    warped = np.roll(there.temperature, pixels, axis=1)
    # rounded positions (2e-5 m) in the finest octave, 6 cm of 1 K, leave up to 10 mK
    np.testing.assert_allclose(here.temperature[ground], warped[ground], atol=1.2e-2)
    np.testing.assert_allclose(here.flow[ground], np.broadcast_to((-pixels, 0), (ground.sum(), 2)), atol=1e-3)
    assert 0.6 < here.temperature[ground].std() < 1.4  # amplitude of aged asphalt: 1 K


def test_texture_has_its_amplitude_and_vanishes_with_it_and_with_distance(loaded_city, warm_city, sky_light):
    tracer = Tracer(Camera.from_fov(128, 128, 90.0), RenderKnobs(sub_samples=1))
    lit = tracer.light(loaded_city, warm_city, sky_light)
    plain = tracer.light(
        loaded_city, replace(warm_city, texture_K=np.zeros_like(warm_city.texture_K)), sky_light
    )

    def spread(height: float, lit) -> float:
        below = looking((-148.0, -148.0, height), 0.0, -90.0)
        frame = tracer.frame(lit, below, below)
        return float(frame.temperature[frame.semantic == Semantic.ROAD].std())

    assert spread(8.0, plain) == 0.0
    assert spread(8.0, lit) > 0.5
    assert spread(60.0, lit) < spread(8.0, lit)
    assert spread(2000.0, lit) == 0.0  # a pixel of 31 m: every octave would alias


def test_axes_and_pixel_origin(lit_and_tracer):
    """Heading east: south is right, up is up; the first row is the upper one and pixel (0, 0) is its left end."""
    lit, tracer = lit_and_tracer
    pose = looking((0.0, 0.0, 70.0), 0.0, 0.0)
    right = pose.copy()
    right[:3, 3] += (0.0, -0.5, 0.0)
    frame = tracer.frame(lit, pose, right, pose)
    assert (frame.semantic[0] == Semantic.SKY).all() and (frame.semantic[-1] != Semantic.SKY).all()
    seen = np.isfinite(frame.depth)
    assert (frame.flow[seen][:, 0] < 0).all()  # moving right, everything moves left
    first = directions(CAMERA, pose, np.array([0.5, 0.5]))
    assert first[1] > 0 and first[2] > 0 and math.isclose(first[0], 1.0)  # north-east, upwards
    last = frame.depth[-1, 0]
    point = pose[:3, 3] + last * directions(CAMERA, pose, np.array([0.5, 127.5]))
    assert point[1] > 0 and point[2] < 70


def _depth_from(pose: np.ndarray, point: np.ndarray) -> np.ndarray:
    return (point - pose[:3, 3]) @ pose[:3, 2]
