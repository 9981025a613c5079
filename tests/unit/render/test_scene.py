from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from scenegen.foundation.errors import InputError
from scenegen.materials.material import Surface
from scenegen.materials.table import material
from scenegen.radiometry.atmosphere import Atmosphere
from scenegen.world import TriangleMesh, World
from scenegen_render import reference_scenes
from scenegen_render.camera import Camera
from scenegen_render.knobs import RenderKnobs
from scenegen_render.scene import load
from scenegen_render.trace import Tracer
from scenegen_render.trace.lit import light
from scenegen_render.trace.surface import unpack_normal
from scenegen_render.trace.tracer import check_finite

ASPHALT = Surface(material("asphalt_aged"), 0.96, 0.9)


@pytest.fixture
def plate() -> World:
    return reference_scenes.plate(ASPHALT)


def _with_vertex(world: World, value: float) -> World:
    vertices = world.mesh.vertices.copy()
    vertices[3, 1] = value
    return replace(world, mesh=TriangleMesh(vertices, world.mesh.faces))


def _with_face(world: World, index: int) -> World:
    faces = world.mesh.faces.copy()
    faces[2, 0] = index
    return replace(world, mesh=TriangleMesh(world.mesh.vertices, faces))


@pytest.mark.parametrize(
    ("spoil", "told"),
    [
        (lambda w: _with_vertex(w, np.nan), "non-finite"),
        (lambda w: _with_vertex(w, 2e5), "100 km"),
        (lambda w: _with_face(w, 10_000), "vertex index out of range"),
        (lambda w: replace(w, corner_site=w.corner_site + np.uint32(1)), "site does not exist"),
        (lambda w: replace(w, face_surface=w.face_surface + np.uint16(1)), "surface does not exist"),
        (lambda w: replace(w, face_object=w.face_object - np.uint32(1)), "reserved for the sky"),
        (lambda w: replace(w, mesh=TriangleMesh(w.mesh.vertices, w.mesh.faces[:0])), "no triangles"),
    ],
)
def test_a_mesh_that_would_crash_the_renderer_is_refused(plate, spoil, told):
    with pytest.raises(InputError, match=told):
        load(spoil(plate))


def test_states_that_do_not_fit_the_world_are_refused(plate):
    loaded = load(plate)
    state = reference_scenes.uniform_state(plate, 300.0, Atmosphere(290.0, 10.0))
    dark = np.zeros(len(plate.sites.area), np.float32)
    with pytest.raises(InputError, match="temperature has 3 values"):
        light(loaded, replace(state, temperature_K=state.temperature_K[:3]), dark, (8.0, 14.0))
    with pytest.raises(InputError, match=r"irradiance .* finite"):
        light(loaded, state, np.full_like(dark, np.inf), (8.0, 14.0))
    with pytest.raises(InputError, match="band"):
        light(loaded, state, dark, (3.0, 5.0))


def test_the_nearest_site_is_the_corner_with_the_largest_weight(plate):
    from scenegen_render import backend

    mi, _ = backend.modules()
    loaded = load(plate)
    u, v = np.array([0.1, 0.8, 0.15, 0.3, 0.5]), np.array([0.1, 0.1, 0.75, 0.4, 0.2])
    face = np.array([0, 5, 9, 20, 31])
    found = loaded.nearest_site(
        mi.UInt(face.astype(np.uint32)), mi.Point2f(u.astype(np.float32), v.astype(np.float32))
    )
    expected = plate.corner_site[face, [0, 1, 2, 2, 1]]
    np.testing.assert_array_equal(np.asarray(found), expected)


def test_packed_normals_lose_less_than_a_ten_thousandth_of_a_radian():
    from scenegen_render import backend

    mi, _ = backend.modules()
    rng = np.random.default_rng(1)
    normal = np.concatenate([np.eye(3), -np.eye(3), rng.standard_normal((500, 3))])
    normal /= np.linalg.norm(normal, axis=1, keepdims=True)
    along = np.cross(normal, np.roll(normal, 1, axis=1) + 0.1)
    triangles = np.stack([normal * 0, along, np.cross(normal, along)], axis=1).astype(np.float32)
    count = len(triangles)
    patch = reference_scenes.plate(ASPHALT)
    world = replace(
        patch,
        mesh=TriangleMesh(triangles.reshape(-1, 3), np.arange(3 * count, dtype=np.uint32).reshape(-1, 3)),
        face_surface=np.zeros(count, np.uint16),
        face_semantic=np.ones(count, np.uint8),
        face_object=np.ones(count, np.uint32),
        corner_site=np.zeros((count, 3), np.uint32),
    )
    unpacked = np.asarray(unpack_normal(load(world).face_normal)).T
    np.testing.assert_allclose(unpacked, normal, atol=1e-4)
    np.testing.assert_allclose(unpacked[:6], normal[:6], atol=1e-7)
    del mi


@pytest.mark.parametrize(
    ("layer", "value", "stage"),
    [
        ("radiance", np.nan, "radiance"),
        ("radiance", np.inf, "radiance"),
        ("temperature", np.nan, "temperature"),
        ("depth", np.inf, "depth"),
        ("depth", np.nan, "depth"),
        ("flow", np.nan, "flow"),
        ("flow", -np.inf, "flow"),
    ],
)
def test_nothing_non_finite_leaves_the_tracer(plate, layer, value, stage):
    tracer = Tracer(Camera.from_fov(8, 8, 60.0), RenderKnobs(sub_samples=1))
    state = reference_scenes.uniform_state(plate, 300.0, Atmosphere(290.0, 10.0))
    lit = tracer.light(load(plate), state, np.zeros(len(plate.sites.area), np.float32))
    pose = reference_scenes.looking((0.0, 0.0, 20.0), 0.0, -90.0)
    frame = tracer.frame(lit, pose, pose)
    check_finite(frame)
    spoiled = getattr(frame, layer).copy()
    spoiled[3, 4] = value
    with pytest.raises(FloatingPointError, match=stage):
        check_finite(replace(frame, **{layer: spoiled}))


@pytest.mark.slow
def test_releasing_worlds_gives_their_memory_back():
    """Six worlds that are kept cost 84 MiB; whatever else the process holds may come and go a little."""
    glass = Surface(material("window_glass"), 0.86, 0.15)
    world = reference_scenes.box_city((ASPHALT, ASPHALT, ASPHALT, glass), np.random.default_rng(2), 8, 2.4)
    state = reference_scenes.uniform_state(world, 300.0, Atmosphere(290.0, 10.0))
    dark = np.zeros(len(world.sites.area), np.float32)
    tracer = Tracer(Camera.from_fov(64, 64, 90.0), RenderKnobs())
    pose = reference_scenes.looking((0.0, 0.0, 50.0), 0.0, -20.0)
    held = []
    for _ in range(8):
        loaded = load(world)
        lit = tracer.light(loaded, state, dark)
        tracer.frame(lit, pose, pose)
        del lit
        loaded.release()
        held.append(_resident_mib())
    assert max(held[2:]) <= held[1] + 30.0


def _resident_mib() -> float:
    lines = Path("/proc/self/status").read_text().splitlines()
    return next(float(line.split()[1]) / 1024 for line in lines if line.startswith("VmRSS"))
