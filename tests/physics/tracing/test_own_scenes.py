"""Scenes of the user's own with prescribed temperatures, through the real reader and tracer, against closed forms."""

from __future__ import annotations

import math
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
import trimesh

from scenegen.climate.season import Season
from scenegen.climate.weather import Weather
from scenegen.heat.solve import HeatModel
from scenegen.maps.own_scene.knobs import OwnScene
from scenegen.maps.own_scene.own_scene import build_own_scene
from scenegen.radiometry.atmosphere import Atmosphere
from scenegen_render.bake import bake
from scenegen_render.camera import Camera
from scenegen_render.exposure.expose import expose
from scenegen_render.exposure.knobs import ExposureKnobs
from scenegen_render.frame import Frame
from scenegen_render.knobs import RenderKnobs
from scenegen_render.reference_scenes import looking
from scenegen_render.scene import load
from scenegen_render.trace import Tracer

BAND = (8.0, 14.0)
SEASON = Season(latitude_deg=40.0, month=7, day=15)
WEATHER = Weather(290.0, 6.0, 15.0, 280.0, 2.0, 0.3, 3.0, 30.0)
FINE = ExposureKnobs(directions=1024, sun_step_min=120.0)


def photograph(
    path: Path, sidecar: str, sky_K: float, pose: np.ndarray, fov_deg: float = 50.0, px: int = 65
) -> Frame:
    """Read, build, expose, solve, bake and trace a scene under a uniform sky, without air in between."""
    path.with_suffix(".yaml").write_text(sidecar)
    world = build_own_scene("trial", OwnScene(file=str(path)), SEASON, np.random.default_rng(0))
    loaded = load(world)
    exposure = expose(loaded, SEASON, np.random.default_rng(1), FINE)
    state = HeatModel.of(world, exposure).solve(WEATHER, 13.0)
    air = Atmosphere(air_K=sky_K, vapour_pressure_hPa=9.0, uniform_sky_K=sky_K, path=False)
    state = replace(state, atmosphere=air)
    irradiance = bake(loaded, exposure, state, BAND)
    tracer = Tracer(Camera.from_fov(px, px, fov_deg), RenderKnobs())
    return tracer.frame(tracer.light(loaded, state, irradiance), pose, pose)


def square(size_m: float, height_m: float, up: bool) -> trimesh.Trimesh:
    h = size_m / 2
    vertices = [[-h, -h, height_m], [h, -h, height_m], [h, h, height_m], [-h, h, height_m]]
    faces = [[0, 1, 2], [0, 2, 3]] if up else [[0, 2, 1], [0, 3, 2]]
    return trimesh.Trimesh(vertices, faces, process=False)


def test_a_closed_isothermal_room_shines_like_a_blackbody(tmp_path: Path, blackbody) -> None:
    room = trimesh.creation.box(extents=(12, 10, 6))
    room.invert()  # its inside is what counts
    pillar = trimesh.creation.cylinder(radius=0.6, height=6.0, sections=24)
    pillar.apply_translation((3.0, 1.0, 0.0))
    path = tmp_path / "room.glb"
    path.write_bytes(trimesh.Scene({"room": room, "pillar": pillar}).export(file_type="glb"))
    sidecar = (
        "up_axis: z\nmaterials:\n  room: {temperature_K: 305, emissivity: 0.6}\n"
        "  pillar: {temperature_K: 305, emissivity: 0.15}\n"
    )
    for pose in (looking((-4.0, -3.0, 0.5), 30.0, -5.0), looking((1.0, 3.0, 2.0), 290.0, -30.0)):
        frame = photograph(path, sidecar, 240.0, pose, fov_deg=90.0)
        assert set(np.unique(frame.material)) <= {1000, 1001}
        np.testing.assert_allclose(frame.radiance, blackbody(305.0), rtol=2e-5)
        np.testing.assert_allclose(frame.temperature, 305.0, rtol=1e-6)


def test_a_plate_of_emissivity_six_tenths_reflects_the_sky(tmp_path: Path, blackbody) -> None:
    path = tmp_path / "plate.obj"
    path.write_text("v -50 -50 0\nv 50 -50 0\nv 50 50 0\nv -50 50 0\nf 1 2 3 4\n")
    sidecar = "default_material: {temperature_K: 310, emissivity: 0.6}\n"
    frame = photograph(path, sidecar, 250.0, looking((0.0, 0.0, 40.0), 0.0, -90.0))
    np.testing.assert_allclose(frame.depth, 40.0, rtol=1e-7)
    np.testing.assert_allclose(frame.radiance, 0.6 * blackbody(310.0) + 0.4 * blackbody(250.0), rtol=1e-4)


def test_a_warm_ball_has_its_radiance_its_size_and_its_distance(tmp_path: Path, blackbody) -> None:
    radius, distance, fov_deg, px = 5.0, 30.0, 30.0, 129
    ball = trimesh.creation.icosphere(subdivisions=5, radius=radius)
    path = tmp_path / "ball.ply"
    path.write_bytes(ball.export(file_type="ply"))
    sidecar = "default_material: {temperature_K: 330, emissivity: 0.6}\n"
    pose = looking((-distance, 0.0, 0.0), 0.0, 0.0)
    frame = photograph(path, sidecar, 260.0, pose, fov_deg, px)
    ball_seen = frame.instance > 0
    focal = px / 2 / math.tan(math.radians(fov_deg) / 2)
    disc = math.pi * (focal * radius) ** 2 / (distance**2 - radius**2)
    assert ball_seen.sum() == pytest.approx(disc, rel=0.01)
    y, x = (np.mgrid[0:px, 0:px] + 0.5 - px / 2) / focal
    ray2 = x**2 + y**2 + 1.0
    inside = distance**2 - ray2 * (distance**2 - radius**2)
    depth = (distance - np.sqrt(np.maximum(inside, 0.0))) / ray2
    well = inside > 2.0
    np.testing.assert_allclose(frame.depth[well], depth[well], atol=0.02)
    np.testing.assert_allclose(
        frame.radiance[well], 0.6 * blackbody(330.0) + 0.4 * blackbody(260.0), rtol=1e-4
    )


def test_a_plate_below_a_hot_plate_reflects_as_much_of_it_as_it_sees(tmp_path: Path, blackbody) -> None:
    """View factor from a point to a parallel square above it, corner formula (Howell, catalogue B-3)."""
    size, gap = 12.0, 5.0
    a = (size / 2) / gap
    quarter = a / math.sqrt(1 + a * a) * math.atan(a / math.sqrt(1 + a * a)) / math.pi
    view = 4.0 * quarter
    path = tmp_path / "plates.glb"
    scene = trimesh.Scene({"low": square(40.0, 0.0, up=True), "high": square(size, gap, up=False)})
    path.write_bytes(scene.export(file_type="glb"))
    sidecar = (
        "up_axis: z\nmaterials:\n  low: {temperature_K: 300, emissivity: 0.6}\n"
        "  high: {temperature_K: 380, emissivity: 1.0}\n"
    )
    pose = looking((-4.0, 0.0, 2.0), 0.0, -math.degrees(math.atan2(2.0, 4.0)))
    frame = photograph(path, sidecar, 250.0, pose, fov_deg=2.0, px=33)
    sky = view * blackbody(380.0) + (1 - view) * blackbody(250.0)
    expected = 0.6 * blackbody(300.0) + 0.4 * sky
    assert set(np.unique(frame.instance)) == {1}
    assert float(frame.radiance.mean()) == pytest.approx(expected, rel=3e-3)
    without = 0.6 * blackbody(300.0) + 0.4 * blackbody(250.0)
    assert expected > 1.4 * without  # what is tested is not small
