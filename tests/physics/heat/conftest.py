"""Tiny worlds made by hand: a few sites that face given ways and see given things; plain surfaces without a world."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
import pytest

from scenegen.climate.season import Season
from scenegen.climate.sun import sun_samples
from scenegen.climate.weather import Weather
from scenegen.exposure import Exposure
from scenegen.heat.balance import SAMPLES, Skins
from scenegen.heat.conduction import admittance, harmonics
from scenegen.heat.construction import Construction, construction
from scenegen.heat.emitters import EMITTER_GROUPS
from scenegen.heat.forcing import Day
from scenegen.materials.material import Surface
from scenegen.materials.table import material
from scenegen.radiometry.planck import STEFAN_BOLTZMANN
from scenegen.world import HeightField, Sites, TriangleMesh, World

JULY_15 = Season(40.0, 7, 15)
CLEAR = Weather(297.65, 6.5, 15.3, 286.15, 3.0, 0.0, 3.0)
"""The clear July day of the reference table: 18-31 C, dew point 13 C, 3 m/s."""


@dataclass(frozen=True)
class Patch:
    """One site: what it is made of, where it faces, what it sees."""

    surface: Surface
    normal: tuple[float, float, float] = (0.0, 0.0, 1.0)
    sky_view: float | None = None
    neighbours: tuple[tuple[int, float], ...] = ()
    sees_sun: Callable[[np.ndarray], np.ndarray] = lambda hour: np.ones(hour.shape, dtype=bool)
    area: float = 1.0


def plain(name: str, **changes: float) -> Surface:
    m = material(name)
    return Surface(m, m.emissivity, m.solar_absorptance, **changes)


def build(patches: list[Patch], season: Season = JULY_15, sun_times: int = 96) -> tuple[World, Exposure]:
    count = len(patches)
    normal = np.array([p.normal for p in patches], dtype=np.float32)
    palette = tuple(dict.fromkeys(p.surface for p in patches))
    sites = Sites(
        position=np.zeros((count, 3), dtype=np.float32),
        normal=normal,
        area=np.array([p.area for p in patches], dtype=np.float32),
        surface=np.array([palette.index(p.surface) for p in patches], dtype=np.uint16),
        object=np.ones(count, dtype=np.uint32),
        standoff=np.zeros(count, dtype=np.float32),
    )
    world = World(
        map="handmade",
        mesh=TriangleMesh(np.eye(3, dtype=np.float32), np.array([[0, 1, 2]], dtype=np.uint32)),
        face_surface=np.zeros(1, dtype=np.uint16),
        face_semantic=np.zeros(1, dtype=np.uint8),
        face_object=np.zeros(1, dtype=np.uint32),
        corner_site=np.zeros((1, 3), dtype=np.uint32),
        sites=sites,
        palette=palette,
        ground=HeightField((0.0, 0.0), 1.0, np.zeros((2, 2), dtype=np.float32)),
        flight_box_m=((0.0, 0.0, 0.0), (1.0, 1.0, 1.0)),
        counts=(),
    )
    hour, direction = sun_samples(season, sun_times)
    visible = np.stack([p.sees_sun(hour) for p in patches]) if hour.size else np.zeros((count, 0))
    share = np.zeros((count, EMITTER_GROUPS), dtype=np.float32)
    for i, p in enumerate(patches):
        for group, value in p.neighbours:
            share[i, group] = value
    sky = [(1.0 + p.normal[2]) / 2 if p.sky_view is None else p.sky_view for p in patches]
    exposure = Exposure(
        season=season,
        sun_hour=hour,
        sun_direction=direction,
        beam=(np.maximum(normal @ direction.T, 0.0) * visible).astype(np.float16),
        sky_view=np.array(sky, dtype=np.float32),
        gather=np.zeros((1, count), dtype=np.uint32),
        neighbour_share=share,
    )
    return world, exposure


@dataclass(frozen=True)
class Problem:
    """Surfaces without a world, ready for `solve_day`."""

    day: Day
    absorbed: np.ndarray
    inner: np.ndarray
    admittance: np.ndarray
    skins: Skins
    built: list[Construction]


def surfaces(
    names: tuple[str, ...],
    weather: Weather,
    normal: tuple[float, float, float] = (0.0, 0.0, 1.0),
    sky_view: float | None = None,
) -> Problem:
    """Materials that face one way under the open sky, over ground of albedo 0.2 that is 2 K above air by day."""
    day = Day.of(JULY_15, weather, 0.0)
    seen = (1.0 + normal[2]) / 2.0 if sky_view is None else sky_view
    beam = day.direct_Wm2 * np.maximum(day.sun @ np.array(normal), 0.0)
    ground_K = day.air.temperature_K + 2.0 * (day.ground_short_Wm2 > 0.0)
    diffuse = seen * day.diffuse_Wm2 + (1.0 - seen) * day.ground_short_Wm2
    long = seen * day.sky_Wm2 + (1.0 - seen) * 0.95 * STEFAN_BOLTZMANN * ground_K**4
    m = [material(n) for n in names]
    sun = [x.solar_absorptance * (x.direct_factor * beam + diffuse) for x in m]
    built = [construction(plain(n)) for n in names]
    pairs = [admittance(b.stack, harmonics(SAMPLES)) for b in built]
    space = [np.full(SAMPLES, b.inner_K) if np.isfinite(b.inner_K) else day.air.temperature_K for b in built]
    return Problem(
        day=day,
        absorbed=np.stack([s + x.emissivity * long for s, x in zip(sun, m, strict=True)]),
        inner=np.stack(
            [np.fft.irfft(B * np.fft.rfft(t), n=SAMPLES) for (_, B), t in zip(pairs, space, strict=True)]
        ),
        admittance=np.stack([Y for Y, _ in pairs]),
        skins=Skins(
            emissivity=np.array([x.emissivity for x in m]),
            cos_tilt=np.full(len(m), float(normal[2])),
            roughness_factor=np.array([x.roughness_factor for x in m]),
            convection_factor=np.array([float(x.convection_factor) for x in m]),
            wetness=np.array([x.wetness for x in m]),
            surface_resistance_sm=np.array([x.stomatal_resistance_sm for x in m]),
        ),
        built=built,
    )


@pytest.fixture
def july() -> Weather:
    return CLEAR


@pytest.fixture
def handmade():
    """The builders above, without importing across test files."""

    class Maker:
        patch = Patch
        surface = staticmethod(plain)
        world = staticmethod(build)
        season = JULY_15
        roofs = staticmethod(surfaces)

    return Maker
