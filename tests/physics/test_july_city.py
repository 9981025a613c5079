"""A clear summer day in a real city, end to end: world, exposure, heat.

Geometry: the smallest city the knobs allow, seed 3.
Illumination: 15 July, 40 N, clear, 3 m/s, air 18-31 C, dew point 13 C.
Expected: what every thermal camera user knows. Flat roofs swing most (light, insulated, open to the sky): hottest at
noon, coldest before sunrise. Asphalt stores the day, grass evaporates it. A shadow that has moved on leaves its trace.
"""

from __future__ import annotations

import numpy as np
import pytest

from scenegen.classes import Semantic
from scenegen.climate.season import Season
from scenegen.climate.weather import Weather
from scenegen.exposure import Exposure
from scenegen.foundation.rng import stream
from scenegen.heat.solve import HeatModel
from scenegen.maps.city.knobs import CityKnobs
from scenegen.maps.registry import build_world
from scenegen.world import World
from scenegen_render.exposure.expose import expose
from scenegen_render.exposure.knobs import ExposureKnobs
from scenegen_render.scene import load

JULY = Season(latitude_deg=40.0, month=7, day=15)
CLEAR = Weather(
    air_mean_K=297.65, air_amplitude_K=6.5, air_peak_hour=15.0, dew_point_K=286.15, wind_mps=3.0,
    cloud_fraction=0.0, linke_turbidity=3.0,
)  # fmt: skip
OPEN_SKY = 0.8


class Scene:
    """The exposed city and what its sites are."""

    def __init__(self) -> None:
        knobs = CityKnobs(extent_m=(400.0, 400.0))
        self.world: World = build_world("city", knobs, JULY, stream(3, "city"))
        loaded = load(self.world)
        self.exposure: Exposure = expose(loaded, JULY, stream(3, "exposure"), ExposureKnobs(directions=32))
        loaded.release()
        self.model = HeatModel.of(self.world, self.exposure)
        self.semantic = np.zeros(len(self.world.sites.area), np.uint8)
        self.semantic[self.world.corner_site] = self.world.face_semantic[:, None]
        self.material = np.array([s.material.name for s in self.world.palette])[self.world.sites.surface]
        self.up = self.world.sites.normal[:, 2] > 0.9

    def temperature(self, hour: float) -> np.ndarray:
        return np.asarray(self.model.solve(CLEAR, hour).temperature_K)

    def of(self, what: Semantic) -> np.ndarray:
        return np.asarray(self.semantic == what)

    def beam_at(self, hour: float) -> np.ndarray:
        nearest = int(np.abs(self.exposure.sun_hour - hour).argmin())
        return np.asarray(self.exposure.beam[:, nearest].astype(np.float64))


@pytest.fixture(scope="module")
def city() -> Scene:
    return Scene()


def test_roofs_are_hotter_than_walls_at_noon(city: Scene) -> None:
    T = city.temperature(12.0)
    roofs = city.of(Semantic.ROOF) & city.up & (city.exposure.sky_view > OPEN_SKY)
    assert np.median(T[roofs]) > np.median(T[city.of(Semantic.WALL)]) + 8.0


def test_roofs_are_coldest_before_sunrise(city: Scene) -> None:
    T = city.temperature(4.4)
    roofs = city.of(Semantic.ROOF) & city.up & (city.exposure.sky_view > OPEN_SKY)
    ground = city.of(Semantic.ROAD)
    assert np.median(T[roofs]) < np.median(T[city.of(Semantic.WALL)]) - 1.0
    assert np.median(T[roofs]) < np.median(T[ground]) - 3.0


def test_asphalt_is_warmer_than_grass_at_dusk(city: Scene) -> None:
    T = city.temperature(19.8)
    open_sky = city.exposure.sky_view > 0.6
    asphalt = (city.material == "asphalt_aged") & city.up & open_sky
    grass = np.char.startswith(city.material, "grass") & city.up & open_sky
    assert np.median(T[asphalt]) > np.median(T[grass]) + 4.0


def test_a_shadow_that_moved_on_leaves_its_trace(city: Scene) -> None:
    """Asphalt in full sun at 14:30: what lay in shadow until 14:00 is colder than what was lit all day."""
    T = city.temperature(14.5)
    asphalt = (city.material == "asphalt_aged") & city.up & (city.exposure.sky_view > 0.4)
    lit_now = asphalt & (city.beam_at(14.5) > 0.6)
    before = np.stack([city.beam_at(h) for h in np.arange(10.0, 14.01, 0.25)])
    was_shaded = lit_now & (before[-5:] < 0.05).all(0)
    was_lit = lit_now & (before > 0.5).all(0)
    assert was_shaded.sum() > 10 and was_lit.sum() > 100
    assert np.median(T[was_shaded]) < np.median(T[was_lit]) - 3.0


def test_a_shadow_of_the_present_is_colder_than_its_trace(city: Scene) -> None:
    T = city.temperature(14.5)
    asphalt = (city.material == "asphalt_aged") & city.up
    shaded = asphalt & (np.stack([city.beam_at(h) for h in (12.5, 13.0, 13.5, 14.0, 14.5)]) < 0.05).all(0)
    lit = asphalt & (np.stack([city.beam_at(h) for h in (10.0, 11.0, 12.0, 13.0, 14.0, 14.5)]) > 0.5).all(0)
    assert np.median(T[shaded]) < np.median(T[lit]) - 8.0


def test_temperatures_stay_in_the_world_of_the_living(city: Scene) -> None:
    """Exhaust pipes and brakes of buses that wait with running engines apart: those stay below their gases."""
    inside = np.array([s.interior_K for s in city.world.palette])[city.world.sites.surface]
    engine = inside > 309.0
    for hour in (0.0, 6.0, 13.0, 18.0):
        T = city.temperature(hour)
        assert np.isfinite(T).all()
        assert T.min() > 278.0 and T[~engine].max() < 355.0
        assert (T[engine] < np.maximum(inside[engine], 355.0)).all()
