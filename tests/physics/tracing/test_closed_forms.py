"""Radiance against closed forms: the isothermal room, a plate under a uniform sky, a window and what it mirrors."""

from __future__ import annotations

import math
from dataclasses import replace

import numpy as np
import pytest

from scenegen.classes import Semantic
from scenegen.climate.season import Season
from scenegen.radiometry.atmosphere import Atmosphere
from scenegen.radiometry.band import mirror_index
from scenegen.radiometry.fresnel import fresnel_reflectance
from scenegen.radiometry.path import path_terms
from scenegen.radiometry.sky import sky_radiance
from scenegen_render import reference_scenes
from scenegen_render.bake import bake
from scenegen_render.camera import Camera
from scenegen_render.exposure.expose import expose
from scenegen_render.knobs import RenderKnobs
from scenegen_render.reference_scenes import looking
from scenegen_render.scene import load
from scenegen_render.trace import Tracer

BAND = (8.0, 14.0)
SEASON = Season(latitude_deg=40.0, month=7, day=15)


@pytest.mark.parametrize("kelvin", [250.0, 300.0, 350.0])
@pytest.mark.parametrize("count", [1, 4, 6])
def test_an_isothermal_room_shines_like_a_blackbody_whatever_it_is_made_of(surface, blackbody, kelvin, count):
    palette = (
        surface("asphalt_aged", 0.6),
        surface("tree_crown", 0.99),
        surface("window_glass"),
        surface("aluminium_bare_weathered"),
        surface("water_fresh_or_sea"),
        surface("brick_red", 0.1),
    )
    room = load(reference_scenes.room(palette))
    air = Atmosphere(air_K=kelvin, vapour_pressure_hPa=9.0, uniform_sky_K=kelvin)
    state = reference_scenes.uniform_state(room.world, kelvin, air)
    tracer = Tracer(Camera.from_fov(64, 48, 100.0), RenderKnobs(sub_samples=count))
    irradiance = np.full(len(room.world.sites.area), math.pi * blackbody(kelvin), np.float32)
    lit = tracer.light(room, state, irradiance)
    for pose in (looking((2.0, 3.0, 4.0), 30.0, 10.0), looking((8.5, 2.0, 1.0), 200.0, -40.0)):
        frame = tracer.frame(lit, pose, pose)
        assert len(np.unique(frame.material)) >= 3
        np.testing.assert_allclose(frame.radiance, blackbody(kelvin), rtol=2e-5)
        np.testing.assert_allclose(frame.temperature, kelvin, rtol=1e-6)


def test_an_isothermal_street_with_its_own_bake_shines_like_a_blackbody(surface, blackbody):
    palette = (
        surface("asphalt_aged", 0.6),
        surface("brick_red", 0.9),
        surface("slate_roof", 0.8),
        surface("window_glass"),
    )
    world = reference_scenes.box_city(palette, np.random.default_rng(5), blocks=2, cell_m=8.0)
    air = Atmosphere(air_K=290.0, vapour_pressure_hPa=9.0, uniform_sky_K=290.0)
    state = reference_scenes.uniform_state(world, 290.0, air)
    loaded = load(world)
    irradiance = bake(loaded, expose(loaded, SEASON, rng=np.random.default_rng(0)), state, BAND)
    tracer = Tracer(Camera.from_fov(96, 64, 90.0), RenderKnobs())
    pose = looking((-40.0, 2.0, 12.0), 20.0, -10.0)
    frame = tracer.frame(tracer.light(loaded, state, irradiance), pose, pose)
    assert set(np.unique(frame.semantic)) >= {Semantic.SKY, Semantic.ROAD, Semantic.WALL, Semantic.WINDOW}
    np.testing.assert_allclose(frame.radiance, blackbody(290.0), rtol=1e-4)


@pytest.mark.parametrize("path", [False, True])
def test_a_grey_plate_reflects_a_uniform_sky_through_the_path(surface, blackbody, path):
    loaded = load(reference_scenes.plate(surface("asphalt_aged", 0.6)))
    air = Atmosphere(air_K=288.0, vapour_pressure_hPa=10.0, uniform_sky_K=240.0, path=path)
    state = reference_scenes.uniform_state(loaded.world, 305.0, air)
    camera = Camera.from_fov(65, 65, 60.0)
    tracer = Tracer(camera, RenderKnobs(sub_samples=1))
    irradiance = np.full(len(loaded.world.sites.area), math.pi * blackbody(240.0), np.float32)
    pose = looking((0.0, 0.0, 40.0), 0.0, -90.0)
    frame = tracer.frame(tracer.light(loaded, state, irradiance), pose, pose)
    y, x = (np.mgrid[0:65, 0:65] + 0.5 - 32.5) / camera.focal_px
    slant = 40.0 * np.sqrt(x**2 + y**2 + 1.0)
    leaving = 0.6 * blackbody(305.0) + 0.4 * blackbody(240.0)
    expected = path_terms(air, BAND).through(np.full_like(slant, leaving), slant)
    np.testing.assert_allclose(frame.radiance, expected, rtol=2e-5)
    np.testing.assert_allclose(frame.depth, 40.0, rtol=1e-7)


def test_a_grey_plate_under_its_baked_sky(surface, blackbody):
    loaded = load(reference_scenes.plate(surface("asphalt_aged", 0.6)))
    air = Atmosphere(air_K=288.0, vapour_pressure_hPa=10.0, uniform_sky_K=240.0, path=False)
    state = reference_scenes.uniform_state(loaded.world, 305.0, air)
    irradiance = bake(loaded, expose(loaded, SEASON, rng=np.random.default_rng(0)), state, BAND)
    tracer = Tracer(Camera.from_fov(32, 32, 60.0), RenderKnobs())
    pose = looking((0.0, 0.0, 40.0), 0.0, -90.0)
    frame = tracer.frame(tracer.light(loaded, state, irradiance), pose, pose)
    np.testing.assert_allclose(frame.radiance, 0.6 * blackbody(305.0) + 0.4 * blackbody(240.0), rtol=1e-4)


def _glass_before(extra: list[reference_scenes.Patch], palette) -> reference_scenes.World:
    glass = reference_scenes.Patch((10, -20, 0), (0, 40, 0), (0, 0, 30), (4, 3), 0, Semantic.WINDOW, 1)
    turned = replace(glass, corner=(10, 20, 0), along=(0, -40, 0))
    return reference_scenes.world_of("window", [turned, *extra], palette)


@pytest.mark.parametrize("path", [False, True])
@pytest.mark.parametrize("clouds", [0.0, 1.0])
def test_a_window_seen_from_2_m_looking_30_degrees_up_mirrors_the_sky(surface, blackbody, path, clouds):
    glass = surface("window_glass")
    loaded = load(_glass_before([], (glass,)))
    air = Atmosphere(air_K=291.0, vapour_pressure_hPa=11.0, cloud_fraction=clouds, cloud_K=279.0, path=path)
    state = reference_scenes.uniform_state(loaded.world, 287.0, air)
    tracer = Tracer(Camera.from_fov(9, 9, 0.5), RenderKnobs())
    lit = tracer.light(loaded, state, np.zeros(len(loaded.world.sites.area), np.float32))
    pose = looking((8.0, 0.0, 5.0), 0.0, 30.0)
    frame = tracer.frame(lit, pose, pose)
    rho = float(
        fresnel_reflectance(np.array(math.cos(math.radians(30.0))), mirror_index(glass.material, BAND))
    )
    sky = float(sky_radiance(np.array(math.sin(math.radians(30.0))), air, BAND))
    leaving = (1 - rho) * blackbody(287.0) + rho * sky
    seen = path_terms(air, BAND).through(np.array(leaving), np.array(2.0 / math.cos(math.radians(30.0))))
    assert 0.1 < rho < 0.2
    np.testing.assert_allclose(frame.radiance[4, 4], seen, rtol=2e-5)


def test_a_window_mirrors_the_wall_across_the_street_through_both_legs_of_air(surface, blackbody):
    glass, brick = surface("window_glass"), surface("brick_red", 0.7)
    wall = reference_scenes.Patch((-30, -40, 0), (0, 80, 0), (0, 0, 60), (4, 4), 1, Semantic.WALL, 2)
    loaded = load(_glass_before([wall], (glass, brick)))
    air = Atmosphere(air_K=270.0, vapour_pressure_hPa=5.0)
    state = reference_scenes.uniform_state(loaded.world, 287.0, air)
    temperature = np.where(loaded.world.sites.surface == 1, 310.0, 287.0).astype(np.float32)
    tracer = Tracer(Camera.from_fov(9, 9, 0.5), RenderKnobs())
    lit = tracer.light(
        loaded, replace(state, temperature_K=temperature), np.full(len(temperature), 50.0, np.float32)
    )
    pose = looking((8.0, 0.0, 5.0), 0.0, 30.0)
    frame = tracer.frame(lit, pose, pose)
    rho = float(
        fresnel_reflectance(np.array(math.cos(math.radians(30.0))), mirror_index(glass.material, BAND))
    )
    across, near = (np.array(d / math.cos(math.radians(30.0))) for d in (40.0, 2.0))
    terms = path_terms(air, BAND)
    mirrored = terms.through(np.array(0.7 * blackbody(310.0) + 0.3 * 50.0 / math.pi), across)
    expected = terms.through(np.asarray((1 - rho) * blackbody(287.0) + rho * mirrored), near)
    np.testing.assert_allclose(frame.radiance[4, 4], expected, rtol=2e-5)


def test_bare_metal_mirrors_with_its_constant_reflectance(surface, blackbody):
    loaded = load(reference_scenes.plate(surface("aluminium_bare_weathered")))
    air = Atmosphere(air_K=280.0, vapour_pressure_hPa=5.0, uniform_sky_K=230.0, path=False)
    state = reference_scenes.uniform_state(loaded.world, 300.0, air)
    tracer = Tracer(Camera.from_fov(16, 16, 60.0), RenderKnobs())
    lit = tracer.light(loaded, state, np.full(len(loaded.world.sites.area), 1e3, np.float32))
    pose = looking((0.0, 0.0, 10.0), 0.0, -80.0)
    frame = tracer.frame(lit, pose, pose)
    np.testing.assert_allclose(frame.radiance, 0.05 * blackbody(300.0) + 0.95 * blackbody(230.0), rtol=2e-5)


def test_the_sky_fills_a_camera_that_looks_up(surface):
    loaded = load(reference_scenes.plate(surface("asphalt_aged")))
    air = Atmosphere(air_K=295.0, vapour_pressure_hPa=14.0)
    state = reference_scenes.uniform_state(loaded.world, 300.0, air)
    camera = Camera.from_fov(64, 64, 90.0)
    tracer = Tracer(camera, RenderKnobs(sub_samples=1))
    lit = tracer.light(loaded, state, np.zeros(len(loaded.world.sites.area), np.float32))
    pose = looking((0.0, 0.0, 1.0), 10.0, 46.0)
    frame = tracer.frame(lit, pose, pose)
    y, x = (np.mgrid[0:64, 0:64] + 0.5 - 32.0) / camera.focal_px
    d = np.stack([x, y, np.ones_like(x)], axis=-1) @ pose[:3, :3].T
    sine = d[..., 2] / np.linalg.norm(d, axis=-1)
    assert sine.min() > 0.0
    assert (frame.semantic == Semantic.SKY).all() and np.isposinf(frame.depth).all()
    assert (frame.temperature == 0).all() and (frame.instance == 0).all() and (frame.material == 0).all()
    np.testing.assert_allclose(frame.radiance, sky_radiance(sine, air, BAND), rtol=2e-5)


def test_patchy_clouds_cover_their_share_and_lie_between_clear_and_overcast(surface):
    loaded = load(reference_scenes.plate(surface("asphalt_aged")))
    tracer = Tracer(Camera.from_fov(96, 96, 100.0), RenderKnobs(sub_samples=1))
    pose = looking((0.0, 0.0, 1.0), 0.0, 90.0)
    dark = np.zeros(len(loaded.world.sites.area), np.float32)

    def sky(fraction: float, hour: float = 12.0) -> np.ndarray:
        air = Atmosphere(air_K=295.0, vapour_pressure_hPa=10.0, cloud_fraction=fraction, cloud_K=280.0)
        state = replace(reference_scenes.uniform_state(loaded.world, 300.0, air), hour=hour)
        return tracer.frame(tracer.light(loaded, state, dark), pose, pose).radiance

    clear, overcast = sky(0.0), sky(1.0)
    for fraction in (0.2, 0.5, 0.8):
        cover = np.stack([(sky(fraction, hour) - clear) / (overcast - clear) for hour in np.arange(12.0)])
        assert -1e-4 <= cover.min() < 0.05 and 0.95 < cover.max() <= 1.0001
        assert abs(cover.mean() - fraction) < 0.05
        assert np.abs(cover[0] - cover[1]).mean() > 0.05  # another hour has other clouds
