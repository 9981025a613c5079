"""Movers in the image: every label right, everything else untouched.

Geometry: the city of boxes, with cars, a bus and people that cross in front of hovering and flying cameras.
Expected: a point of a mover, given by face and barycentric coordinates, is found in the next frame where the flow
says; its texture stays on it; what shows no mover does not change by a bit.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from typing import Any

import numpy as np
import pytest

from scenegen.classes import Semantic
from scenegen.movers.company import Company
from scenegen.radiometry.atmosphere import Atmosphere
from scenegen.thermal_state import ThermalState
from scenegen.world import World
from scenegen_render import backend
from scenegen_render.camera import Camera
from scenegen_render.frame import Frame
from scenegen_render.knobs import RenderKnobs
from scenegen_render.reference_scenes import looking, uniform_state
from scenegen_render.scene import LoadedWorld
from scenegen_render.trace import Tracer
from scenegen_render.trace.casting import MAX_TRIANGLES, around, choose
from scenegen_render.trace.lit import Lit

CAMERA = Camera.from_fov(160, 128, 90.0)
STEP_S = 0.25
FIRST_ID = 10_000


@pytest.fixture(scope="module")
def tracer() -> Tracer:
    return Tracer(CAMERA, RenderKnobs(sub_samples=3, backward_flow=True, normals=True))


@pytest.fixture(scope="module")
def lit(
    tracer: Tracer, peopled_loaded: LoadedWorld, peopled_state: ThermalState, sky_light: np.ndarray
) -> Lit:
    return tracer.light(peopled_loaded, peopled_state, sky_light, range(len(peopled_loaded.world.movers)))


def shots() -> Iterator[tuple[list[np.ndarray], tuple[float, float, float]]]:
    """Poses (now, next, previous) of cameras that look at the traffic, and their times."""
    for k, (x, y, heading) in enumerate([(-5, -6, 80.0), (54, 20, 100.0), (20, -7, 20.0), (25, 55, -170.0)]):
        step = np.array([0.4, 0.5, 0.1])
        poses = [
            looking(tuple(np.array([x, y, 4.0 + k]) + n * step), heading + 2.0 * n, -20.0) for n in (0, 1, -1)
        ]
        time = 7.0 * k
        yield poses, (time, time + STEP_S, time - STEP_S)


def centres() -> np.ndarray:
    rows, columns = np.mgrid[0 : CAMERA.height_px, 0 : CAMERA.width_px] + 0.5
    return np.stack([columns, rows], axis=-1)


def rays(pose: np.ndarray, place: np.ndarray) -> np.ndarray:
    plane = (place - CAMERA.centre_px) / CAMERA.focal_px
    d = np.concatenate([plane, np.ones_like(plane[..., :1])], axis=-1)
    return np.asarray(d @ pose[:3, :3].T)


def merged(world: World, time_s: float) -> tuple[Any, np.ndarray, Company]:
    """World and movers as one mesh in a scene of its own, built independently of the tracer's two."""
    mi, _ = backend.modules()
    company = Company.of(world.movers)
    vertices = np.concatenate([world.mesh.vertices, company.vertices(time_s).astype(np.float32)])
    faces = np.concatenate([world.mesh.faces, company.body.faces + len(world.mesh.vertices)])
    mesh = mi.Mesh("all", vertex_count=len(vertices), face_count=len(faces))
    parameters = mi.traverse(mesh)
    parameters["vertex_positions"] = backend.upload(vertices)
    parameters["faces"] = backend.upload(faces.astype(np.uint32))
    parameters.update()
    scene = {"type": "scene", "embree_use_robust_intersections": True, "all": mesh}
    return mi.load_dict(scene, optimize=False, parallel=False), vertices[faces], company


def hits(scene: Any, pose: np.ndarray, d: np.ndarray) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Distance, face and barycentric coordinates along rays; face -1 where there is nothing."""
    mi, _ = backend.modules()
    ray = mi.Ray3f(mi.Point3f(*map(float, pose[:3, 3])), mi.Vector3f(d.reshape(-1, 3).T.astype(np.float32)))
    pi = scene.ray_intersect_preliminary(ray)
    face = np.where(np.asarray(pi.is_valid()), np.asarray(pi.prim_index).astype(np.int64), -1)
    return np.asarray(pi.t), face, np.asarray(pi.prim_uv).T


def on_movers(frame: Frame) -> np.ndarray:
    return np.asarray(frame.instance >= FIRST_ID)


def test_labels_are_those_of_one_merged_mesh(lit: Lit, tracer: Tracer, peopled: World) -> None:
    seen = 0
    instance = np.concatenate([[0], peopled.face_object, *(m.body.object for m in peopled.movers)])
    semantic = np.concatenate([[0], peopled.face_semantic, *(m.body.semantic for m in peopled.movers)])
    for (pose, ahead, behind), times in shots():
        frame = tracer.frame(lit, pose, ahead, behind, times)
        scene, _, _ = merged(peopled, times[0])
        t, face, _ = hits(scene, pose, rays(pose, centres()))
        np.testing.assert_array_equal(frame.instance.ravel(), instance[face + 1])
        np.testing.assert_array_equal(frame.semantic.ravel(), semantic[face + 1])
        np.testing.assert_allclose(frame.depth.ravel(), t, rtol=2e-5)
        seen += int(on_movers(frame).sum())
    assert seen > 1_500


@pytest.mark.parametrize("backward", [False, True])
def test_flow_finds_the_same_rest_point_again(
    lit: Lit, tracer: Tracer, peopled: World, backward: bool
) -> None:
    agreed = total = 0
    for (pose, ahead, behind), times in shots():
        frame = tracer.frame(lit, pose, ahead, behind, times)
        other, time = (behind, times[2]) if backward else (ahead, times[1])
        flow, covisible = (
            (frame.flow_back, frame.covisible_back) if backward else (frame.flow, frame.covisible)
        )
        assert flow is not None and covisible is not None
        (now, _, _), (then, corners, _) = merged(peopled, times[0]), merged(peopled, time)
        _, face, uv = hits(now, pose, rays(pose, centres()))
        a, b, c = np.moveaxis(corners[face], 1, 0).astype(np.float64)
        expected = a + uv[:, :1] * (b - a) + uv[:, 1:] * (c - a)
        d = rays(other, centres() + np.nan_to_num(flow)).reshape(-1, 3)
        t, met, _ = hits(then, other, d)
        there = other[:3, 3] + d * np.where(met < 0, 0.0, t)[:, None]
        near = np.linalg.norm(there - expected, axis=1) <= 1e-3 * frame.depth.ravel()
        mine = (on_movers(frame) & covisible).ravel()
        objects = np.concatenate([peopled.face_object, *(m.body.object for m in peopled.movers)])
        same = objects[met] == frame.instance.ravel()
        agreed += int((near & same)[mine].sum())
        total += int(mine.sum())
    assert total > 1_000
    assert agreed / total >= 0.999


def test_what_is_hidden_in_the_other_frame_is_hidden_by_something_nearer(
    lit: Lit, tracer: Tracer, peopled: World
) -> None:
    """Static points behind a mover that comes, and points of movers that pass behind a house or each other."""
    covered = 0
    for (pose, ahead, behind), times in shots():
        frame = tracer.frame(lit, pose, ahead, behind, times)
        place = centres() + np.nan_to_num(frame.flow)
        inside = ((place > 0) & (place < (CAMERA.width_px, CAMERA.height_px))).all(axis=-1)
        lost = (inside & ~frame.covisible & np.isfinite(frame.depth)).ravel()
        then, _, _ = merged(peopled, times[1])
        (now, _, _), (_, corners, _) = merged(peopled, times[0]), merged(peopled, times[1])
        _, face, uv = hits(now, pose, rays(pose, centres()))
        a, b, c = np.moveaxis(corners[face], 1, 0).astype(np.float64)
        expected = (a + uv[:, :1] * (b - a) + uv[:, 1:] * (c - a) - ahead[:3, 3]) @ ahead[:3, 2]
        t, _, _ = hits(then, ahead, rays(ahead, place))
        assert (t[lost] < expected[lost] * (1.0 - 0.9e-3)).mean() > 0.999
        objects = np.concatenate([peopled.face_object, *(m.body.object for m in peopled.movers)])
        _, met, _ = hits(then, ahead, rays(ahead, place))
        covered += int(((objects[met] >= FIRST_ID) & (frame.instance.ravel() < FIRST_ID))[lost].sum())
    assert covered > 30


def test_pixels_without_movers_are_those_of_an_empty_street(
    lit: Lit, tracer: Tracer, peopled_loaded: LoadedWorld, peopled_state: ThermalState, sky_light: np.ndarray
) -> None:
    empty = tracer.light(peopled_loaded, peopled_state, sky_light)
    for (pose, ahead, behind), times in shots():
        with_movers = tracer.frame(lit, pose, ahead, behind, times)
        without = tracer.frame(empty, pose, ahead, behind, times)
        still = ~on_movers(with_movers)
        assert 0.001 < 1.0 - still.mean() < 0.6
        for name in (
            "depth",
            "temperature",
            "semantic",
            "instance",
            "material",
            "flow",
            "flow_back",
            "normal",
        ):
            ours, theirs = getattr(with_movers, name)[still], getattr(without, name)[still]
            assert ours.tobytes() == theirs.tobytes(), name
        # A sub-sample may meet what the centre misses, and mirrors show movers.
        company, mirrors = (
            Company.of(peopled_loaded.world.movers),
            _grown(with_movers.semantic == Semantic.WINDOW),
        )
        far = ~around(company, times[0], CAMERA, pose[None])[0][0] & ~mirrors
        same = with_movers.radiance == without.radiance
        assert far.sum() > 2_000 and same[far].all()
        assert same[~_grown(~still) & ~mirrors].mean() > 0.999


def _grown(mask: np.ndarray) -> np.ndarray:
    padded = np.pad(mask, 1)
    shifts = [padded[1 + i : padded.shape[0] - 1 + i, 1 + j : padded.shape[1] - 1 + j]
              for i in (-1, 0, 1) for j in (-1, 0, 1)]  # fmt: skip
    return np.asarray(np.any(shifts, axis=0))


def test_texture_stays_on_a_mover(lit: Lit, tracer: Tracer, peopled: World) -> None:
    """A camera that rides along sees the same temperatures; one over which the world passes does not."""
    car = next(k for k, m in enumerate(peopled.movers) if m.kind == "car")
    route = peopled.movers[car].route
    local = looking((-0.5, 0.0, 4.5), 0.0, -80.0)
    times = 3.0, 3.6
    there, later = (route.pose(t) @ local for t in times)
    assert np.linalg.norm(there[:3, 3] - later[:3, 3]) > 1.0
    a = tracer.frame(lit, there, there, there, (times[0],) * 3)
    b = tracer.frame(lit, later, later, later, (times[1],) * 3)
    same = (a.instance == peopled.movers[car].object) & (b.instance == a.instance)
    assert same.sum() > 500
    assert a.temperature[same].std() > 0.05
    difference = (a.temperature - b.temperature)[same]
    assert np.sqrt(np.mean(difference**2)) < 0.1 * a.temperature[same].std()


def test_the_company_of_a_clip_is_what_comes_into_view_nearest_first(peopled: World) -> None:
    poses = np.stack([looking((-5.0, -30.0 + k, 5.0), 110.0, -10.0) for k in range(4)])
    times = STEP_S * np.arange(4)
    chosen = choose(peopled.movers, CAMERA, poses, times)
    assert chosen == tuple(sorted(set(chosen))) and 3 <= len(chosen) < len(peopled.movers)
    assert sum(len(peopled.movers[k].body.faces) for k in chosen) <= MAX_TRIANGLES
    away = np.stack([looking((-200.0, -200.0, 5.0), 225.0, 0.0)] * 4)
    assert choose(peopled.movers, CAMERA, away, times) == ()
    few = choose(peopled.movers, CAMERA, poses, times, max_triangles=1_500)
    assert set(few) < set(chosen) and sum(len(peopled.movers[k].body.faces) for k in few) <= 1_500


def test_movers_that_stand_flow_like_the_world(lit: Lit, tracer: Tracer) -> None:
    (pose, ahead, behind), (time, _, _) = next(shots())
    frozen = tracer.frame(lit, pose, ahead, behind, (time, time, time))
    place = centres()
    point = (
        pose[:3, 3] + rays(pose, place) * np.where(np.isfinite(frozen.depth), frozen.depth, 1.0)[..., None]
    )
    local = (point - ahead[:3, 3]) @ ahead[:3, :3]
    expected = local[..., :2] / local[..., 2:] * CAMERA.focal_px + CAMERA.centre_px - place
    seen = on_movers(frozen)
    np.testing.assert_allclose(frozen.flow[seen], expected[seen], atol=2e-3)


def test_frames_with_and_without_movers_run_the_same_kernels(
    peopled_loaded: LoadedWorld, peopled_state: ThermalState, sky_light: np.ndarray
) -> None:
    _, dr = backend.modules()
    tracer = Tracer(CAMERA, RenderKnobs(sub_samples=3, backward_flow=True))

    def kernels(cast: Sequence[int], count: int) -> set[object]:
        dr.kernel_history_clear()
        with dr.scoped_set_flag(dr.JitFlag.KernelHistory):
            lit = tracer.light(peopled_loaded, peopled_state, sky_light, cast)
            for (pose, ahead, behind), times in list(shots())[:count]:
                tracer.frame(lit, pose, ahead, behind, times)
            history = [entry for entry in dr.kernel_history() if entry["type"] == dr.KernelType.JIT]
        return {entry["hash"] for entry in history}

    empty, one, all_ = kernels((), 1), kernels((3,), 2), kernels(range(len(peopled_loaded.world.movers)), 4)
    assert len(empty) >= 2
    assert empty == one == all_


def test_an_instant_is_the_same_however_it_was_reached(
    peopled_loaded: LoadedWorld, peopled_state: ThermalState, sky_light: np.ndarray, tracer: Tracer
) -> None:
    """Scenes are used again for other times: order must not show."""
    cast = range(len(peopled_loaded.world.movers))
    in_order = tracer.light(peopled_loaded, peopled_state, sky_light, cast)
    wanted = list(shots())
    first = [tracer.frame(in_order, *poses, times) for poses, times in wanted]
    backwards = tracer.light(peopled_loaded, peopled_state, sky_light, cast)
    second = [tracer.frame(backwards, *poses, times) for poses, times in wanted[::-1]][::-1]
    for a, b in zip(first, second, strict=True):
        for name, layer in vars(a).items():
            assert (
                np.ascontiguousarray(layer).tobytes() == np.ascontiguousarray(getattr(b, name)).tobytes()
            ), name


def test_in_a_world_of_one_temperature_movers_cannot_be_seen(
    peopled: World, peopled_loaded: LoadedWorld, tracer: Tracer, blackbody: Callable[[float], float]
) -> None:
    """Emission and reflection of movers add up to the blackbody whatever their emissivity, mirrors included."""
    T = 300.0
    air = Atmosphere(air_K=T, vapour_pressure_hPa=12.0, uniform_sky_K=T)
    light = np.full(len(peopled.sites.area), np.pi * blackbody(T), np.float32)
    state = uniform_state(peopled, T, air)
    lit = tracer.light(peopled_loaded, state, light, range(len(peopled.movers)))
    for poses, times in shots():
        frame = tracer.frame(lit, *poses, times)
        assert on_movers(frame).any()
        np.testing.assert_allclose(frame.radiance, blackbody(T), rtol=2e-4)
