from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace

import numpy as np
import pytest

from scenegen.climate.season import Season
from scenegen.foundation.rng import stream
from scenegen.geometry.builder import GeometryBuilder
from scenegen.materials.material import Surface
from scenegen.materials.palette import PaletteBuilder
from scenegen.materials.table import material
from scenegen.movers.company import Company
from scenegen.movers.drive import drive
from scenegen.movers.stroll import stroll
from scenegen.parts.workshop import Workshop
from scenegen.radiometry.atmosphere import Atmosphere
from scenegen.radiometry.planck import band_radiance
from scenegen.thermal_state import ThermalState
from scenegen.world import World
from scenegen_render import reference_scenes
from scenegen_render.scene import LoadedWorld, load

BAND = (8.0, 14.0)
FIRST_MOVING_ID = 10_000


@pytest.fixture(scope="session")
def surface() -> Callable[[str], Surface]:
    """A material as a palette entry, with its typical emissivity or another."""

    def make(name: str, emissivity: float | None = None) -> Surface:
        row = material(name)
        return Surface(row, row.emissivity if emissivity is None else emissivity, row.solar_absorptance)

    return make


@pytest.fixture(scope="session")
def blackbody() -> Callable[[float], float]:
    return lambda T: float(band_radiance(np.array(T), BAND))


@pytest.fixture(scope="session")
def city() -> World:
    names = ("asphalt_aged", "brick_red", "bitumen_felt_roof", "window_glass")
    ground, wall, roof, glass = (Surface(material(n), material(n).emissivity, 0.8) for n in names)
    return reference_scenes.box_city((ground, wall, roof, glass), stream(7, "tracing"), blocks=6, cell_m=6.0)


@pytest.fixture(scope="session")
def loaded_city(city: World) -> LoadedWorld:
    return load(city)


@pytest.fixture(scope="session")
def warm_city(city: World) -> ThermalState:
    """Surfaces of four temperatures, texture on, a third of the sky clouded."""
    air = Atmosphere(air_K=293.0, vapour_pressure_hPa=12.0, cloud_fraction=0.3, cloud_K=281.0)
    state = reference_scenes.uniform_state(city, 295.0, air)
    by_surface = np.array([300.0, 296.0, 305.0, 297.0], np.float32)
    texture = np.array([s.material.texture_K for s in city.palette], np.float32)
    return replace(state, temperature_K=by_surface[city.sites.surface], texture_K=texture)


@pytest.fixture(scope="session")
def sky_light(city: World) -> np.ndarray:
    return np.full(len(city.sites.area), 110.0, np.float32)


@pytest.fixture(scope="session")
def peopled(city: World) -> World:
    """The city of boxes with traffic around its middle block: streets are 12 to 32 m wide."""
    rng = stream(9, "movers")
    builder = GeometryBuilder()
    builder.new_objects(FIRST_MOVING_ID - 1)
    palette = PaletteBuilder(rng)
    shop = Workshop(lambda xy: np.zeros(len(xy)), palette, builder, Season(50.0, 7, 1))
    lane = np.array([[-2.0, -2.0], [-2.0, 52.0], [52.0, 52.0], [52.0, -2.0]])
    way = np.array([[2.5, 2.5], [47.5, 2.5], [47.5, 47.5], [2.5, 47.5]])
    mix = {"car": 0.6, "van": 0.2, "bus": 0.2}
    movers = [*drive([lane], 5.0, shop, rng, mix=mix), *stroll([way], 4.0, shop, rng)]
    first = len(city.palette)
    shifted = [replace(m, body=replace(m.body, surface=m.body.surface + first)) for m in movers]
    assert len(shifted) > 10 and {m.kind for m in shifted} >= {"car", "person"}
    return replace(city, palette=city.palette + palette.surfaces(), movers=tuple(shifted))


@pytest.fixture(scope="session")
def peopled_loaded(peopled: World) -> LoadedWorld:
    return load(peopled)


@pytest.fixture(scope="session")
def peopled_state(peopled: World, warm_city: ThermalState) -> ThermalState:
    """The warm city with movers of 310 K."""
    texture = np.array([s.material.texture_K for s in peopled.palette], np.float32)
    warm = np.full(len(Company.of(peopled.movers).site_surface), 310.0, np.float32)
    return replace(warm_city, texture_K=texture, moving_K=warm)
