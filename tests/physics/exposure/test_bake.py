"""Baked irradiance against closed forms: isothermal room, open sites under the real sky, a wall, two grey plates."""

from __future__ import annotations

import math
from dataclasses import replace

import numpy as np
import pytest
from scipy.integrate import quad

from scenegen.classes import Semantic
from scenegen.climate.season import Season
from scenegen.foundation.rng import stream
from scenegen.materials.material import Surface
from scenegen.materials.table import material
from scenegen.radiometry.atmosphere import Atmosphere
from scenegen.radiometry.planck import band_radiance
from scenegen.radiometry.sky import sky_radiance
from scenegen.world import World
from scenegen_render.bake import bake
from scenegen_render.exposure.expose import expose
from scenegen_render.exposure.knobs import ExposureKnobs
from scenegen_render.reference_scenes import Patch, plate, room, uniform_state, world_of
from scenegen_render.scene import load

BANDS = [(8.0, 14.0), (7.5, 13.5)]
BAND = BANDS[0]
KNOBS = ExposureKnobs(sun_step_min=120.0)
SEASON = Season(latitude_deg=40.0, month=7, day=15)
DRY = Atmosphere(air_K=255.0, vapour_pressure_hPa=1.0)
MIDDLING = Atmosphere(air_K=290.0, vapour_pressure_hPa=10.0)
HUMID = Atmosphere(air_K=300.0, vapour_pressure_hPa=28.0, cloud_fraction=0.4, cloud_K=285.0)


def _surface(emissivity: float) -> Surface:
    row = material("concrete_wall")
    return Surface(row, emissivity, row.solar_absorptance)


def _rectangle(corner: tuple, along: tuple, up: tuple, *rest: object) -> Patch:
    return Patch(*(tuple(float(v) for v in vector) for vector in (corner, along, up)), *rest)


def _baked(
    world: World, temperature_K: np.ndarray | float, air: Atmosphere, band: tuple[float, float] = BAND,
    knobs: ExposureKnobs = KNOBS, seed: int = 1,
) -> np.ndarray:  # fmt: skip
    loaded = load(world)
    exposure = expose(loaded, SEASON, stream(seed, "exposure"), knobs)
    state = uniform_state(world, 280.0, air)
    temperatures = np.broadcast_to(np.asarray(temperature_K, np.float32), state.temperature_K.shape).copy()
    state = replace(state, temperature_K=temperatures)
    return bake(loaded, exposure, state, band).astype(np.float64)


def _planck(temperature_K: float, band: tuple[float, float] = BAND) -> float:
    return float(band_radiance(np.array([temperature_K]), band)[0])


@pytest.mark.parametrize("temperature_K", [233.0, 291.37, 340.0])
@pytest.mark.parametrize("band", BANDS)
def test_isothermal_room_is_exact(temperature_K: float, band: tuple[float, float]) -> None:
    world = room((_surface(0.95), _surface(0.6), _surface(0.25)))
    E = _baked(world, temperature_K, MIDDLING, band)
    np.testing.assert_allclose(E, math.pi * _planck(temperature_K, band), rtol=1e-6)


def test_uniform_sky_at_the_temperature_of_the_ground_is_exact() -> None:
    air = replace(MIDDLING, uniform_sky_K=287.0)
    E = _baked(plate(_surface(0.5)), 287.0, air)
    np.testing.assert_allclose(E, math.pi * _planck(287.0), rtol=1e-6)


def test_uniform_sky_over_warmer_ground() -> None:
    E = _baked(plate(_surface(0.5)), 320.0, replace(MIDDLING, uniform_sky_K=250.0))
    np.testing.assert_allclose(E, math.pi * _planck(250.0), rtol=5e-6)


@pytest.mark.parametrize("air", [DRY, MIDDLING, HUMID], ids=["dry", "middling", "humid"])
@pytest.mark.parametrize("band", BANDS)
def test_open_horizontal_site_under_the_real_sky(air: Atmosphere, band: tuple[float, float]) -> None:
    """2 pi times the integral of L(s) s ds over the sine of the elevation, by adaptive quadrature."""
    integral = quad(
        lambda s: s * float(sky_radiance(np.array([s]), air, band)[0]),
        0.0,
        1.0,
        epsabs=0.0,
        epsrel=1e-10,
        limit=500,
    )[0]
    E = _baked(plate(_surface(0.95)), 300.0, air, band)
    np.testing.assert_allclose(E, 2.0 * math.pi * integral, rtol=1e-4)


@pytest.mark.parametrize("tilt_deg", [30.0, 60.0, 90.0])
@pytest.mark.parametrize("air", [DRY, MIDDLING, HUMID], ids=["dry", "middling", "humid"])
def test_open_tilted_site(tilt_deg: float, air: Atmosphere) -> None:
    """Over the edge of the world lies ground at air temperature; oracle: 400,000 equal-weight directions.

    A single site carries the error of its 64 directions; what it may cost is stated in the image: at an emissivity of
    0.95 it must stay below 20 mK.
    """
    tilt = math.radians(tilt_deg)
    up = (0.0, 8.0 * math.cos(tilt), 8.0 * math.sin(tilt))
    world = world_of(
        "tilted", [_rectangle((0, 0, 0), (8, 0, 0), up, (8, 8), 0, Semantic.ROOF, 1)], (_surface(0.95),)
    )
    E = _baked(world, 290.0, air)
    count = 400_000
    height = np.sqrt((np.arange(count) + 0.5) / count)
    azimuth = 2 * np.pi * ((np.arange(count) * 0.6180339887498949) % 1.0)
    normal = world.sites.normal[0].astype(np.float64)
    sideways = np.array([1.0, 0.0, 0.0])
    radius = np.sqrt(1 - height**2)
    sine = radius * np.sin(azimuth) * np.cross(normal, sideways)[2] + height * normal[2]
    expected = math.pi * sky_radiance(sine, air, BAND).mean()
    slope = float((band_radiance(np.array([290.5]), BAND) - band_radiance(np.array([289.5]), BAND))[0])
    error_mk = 0.05 * (E - expected) / math.pi / slope * 1e3
    assert float(np.sqrt(np.mean(error_mk**2))) < 20.0
    assert abs(float(np.mean(error_mk))) < 5.0


def test_ground_half_shut_in_by_a_black_wall() -> None:
    """Site at distance d from a long wall of height h: F = (1 - cos(atan(h/d))) / 2 of the wall, the rest sky."""
    height, distance = 12.0, 5.0
    wall = _rectangle((distance, 2000, 0), (0, -4000, 0), (0, 0, height), (1, 1), 0, Semantic.WALL, 1)
    probe = _rectangle((-0.05, -0.05, 0), (0.1, 0, 0), (0, 0.1, 0), (1, 1), 1, Semantic.ROAD, 2)
    world = world_of("wall", [wall, probe], (_surface(1.0), _surface(0.7)))
    temperature = np.where(world.sites.surface == 0, 310.0, 280.0)
    knobs = ExposureKnobs(directions=1024, smoothing=False, sun_step_min=120.0)
    E = _baked(world, temperature, replace(MIDDLING, uniform_sky_K=240.0), knobs=knobs)[-4:]
    share = 0.5 * (1 - distance / math.hypot(distance, height))
    expected = math.pi * (share * _planck(310.0) + (1 - share) * _planck(240.0))
    assert float(E.mean()) == pytest.approx(expected, rel=3e-3)


@pytest.mark.parametrize(("lower", "upper"), [(0.95, 0.9), (0.9, 0.6)])
def test_two_grey_plates_reflect_each_other(lower: float, upper: float) -> None:
    """Wide parallel plates: J1 = e1 B1 + (1-e1) J2 and the like; the irradiance on each is pi J of the other."""
    size = 1000.0
    floor = _rectangle((-size, -size, 0), (2 * size, 0, 0), (0, 2 * size, 0), (4, 4), 0, Semantic.ROAD, 1)
    ceiling = _rectangle((-size, -size, 0.5), (0, 2 * size, 0), (2 * size, 0, 0), (4, 4), 1, Semantic.ROOF, 2)
    world = world_of("plates", [floor, ceiling], (_surface(lower), _surface(upper)))
    B1, B2 = _planck(300.0), _planck(280.0)
    temperature = np.where(world.sites.surface == 0, 300.0, 280.0)
    J1 = (lower * B1 + (1 - lower) * upper * B2) / (1 - (1 - lower) * (1 - upper))
    J2 = (upper * B2 + (1 - upper) * lower * B1) / (1 - (1 - lower) * (1 - upper))
    E = (
        _baked(world, temperature, MIDDLING, knobs=ExposureKnobs(smoothing=False, sun_step_min=120.0))
        / math.pi
    )
    inner = np.abs(world.sites.position[:, :2]).max(axis=1) < size / 2 + 1
    on_floor = world.sites.surface == 0
    tolerance = 2 * ((1 - lower) * (1 - upper)) ** 1.5 * (B1 - B2) + 1e-4 * B1
    np.testing.assert_allclose(E[inner & on_floor], J2, atol=tolerance)
    np.testing.assert_allclose(E[inner & ~on_floor], J1, atol=tolerance)
