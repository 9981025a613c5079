"""A closer look along a flight: nearer to the closed form where the frames look, unchanged elsewhere, exact in a room.

Geometry: a street 20 m wide between walls 15 m high; sky view of its floor is half the sum of the cosines of the
elevations of both upper edges.
"""

from __future__ import annotations

import math

import numpy as np
import pytest

from scenegen.classes import Semantic
from scenegen.climate.season import Season
from scenegen.exposure import Exposure
from scenegen.foundation.rng import stream
from scenegen.materials.material import Surface
from scenegen.materials.table import material
from scenegen.radiometry.atmosphere import Atmosphere
from scenegen.radiometry.planck import band_radiance
from scenegen_render.bake import bake
from scenegen_render.camera import Camera
from scenegen_render.exposure.closer import look_closer
from scenegen_render.exposure.expose import expose
from scenegen_render.exposure.hemisphere import gather_list
from scenegen_render.exposure.knobs import ExposureKnobs
from scenegen_render.exposure.rays import SiteRays
from scenegen_render.reference_scenes import Patch, looking, room, uniform_state, world_of
from scenegen_render.scene import LoadedWorld, load

SEASON = Season(latitude_deg=40.0, month=7, day=15)
CAMERA = Camera.from_fov(64, 48, 90.0)
WIDTH, HEIGHT, LONG = 20.0, 15.0, 2000.0
DOWN = np.stack([looking((10.0, y, 12.0), 0.0, -60.0) for y in (-3.0, 0.0, 3.0)]).astype(np.float64)
UP = np.stack([looking((10.0, 0.0, 12.0), 0.0, 89.0)] * 2).astype(np.float64)


def _surface(name: str) -> Surface:
    row = material(name)
    return Surface(row, row.emissivity, row.solar_absorptance)


@pytest.fixture(scope="module")
def street() -> LoadedWorld:
    east = Patch((0.0, -LONG, 0.0), (0.0, 2 * LONG, 0.0), (0.0, 0.0, HEIGHT), (1, 1), 0, Semantic.WALL, 1)
    west = Patch((WIDTH, LONG, 0.0), (0.0, -2 * LONG, 0.0), (0.0, 0.0, HEIGHT), (1, 1), 0, Semantic.WALL, 2)
    floor = Patch((0.0, -40.0, 0.0), (WIDTH, 0.0, 0.0), (0.0, 80.0, 0.0), (10, 40), 1, Semantic.ROAD, 3)
    palette = (_surface("concrete_wall"), _surface("asphalt_aged"))
    return load(world_of("street", [east, west, floor], palette))


@pytest.fixture(scope="module")
def coarse(street: LoadedWorld) -> Exposure:
    return expose(street, SEASON, stream(1, "exposure"), ExposureKnobs(sun_step_min=120.0, smoothing=False))


def _closer(street: LoadedWorld, coarse: Exposure, poses: np.ndarray, rays: int = 60_000) -> Exposure:
    return look_closer(street, coarse, CAMERA, poses, stream(2, "closer"), ExposureKnobs(closer_rays=rays))


def _sky_view_error(street: LoadedWorld, exposure: Exposure, sites: np.ndarray) -> np.ndarray:
    x = street.world.sites.position[sites, 0].astype(np.float64)
    exact = 0.5 * (x / np.hypot(x, HEIGHT) + (WIDTH - x) / np.hypot(WIDTH - x, HEIGHT))
    return np.asarray(exposure.sky_view[sites] - exact)


def test_what_the_frames_show_comes_nearer_to_the_closed_form(street: LoadedWorld, coarse: Exposure) -> None:
    closer = _closer(street, coarse, DOWN)
    seen = np.concatenate([some.site for some in closer.closer])
    x = street.world.sites.position[seen, 0]
    inner = seen[(street.world.sites.surface[seen] == 1) & (x > 1.0) & (x < WIDTH - 1.0)]
    assert len(inner) > 30
    before, after = (_sky_view_error(street, e, inner) for e in (coarse, closer))
    assert np.sqrt(np.mean(after**2)) < 0.3 * np.sqrt(np.mean(before**2))
    rest = np.setdiff1d(np.arange(len(coarse.sky_view)), seen)
    np.testing.assert_array_equal(closer.sky_view[rest], coarse.sky_view[rest])
    np.testing.assert_array_equal(closer.neighbour_share[rest], coarse.neighbour_share[rest])
    total = closer.sky_view[inner] + closer.neighbour_share[inner].sum(axis=1)
    np.testing.assert_allclose(total, 1.0, atol=1e-2)  # what is missing leaves through the far ends


def test_budget_is_kept_and_no_site_looks_twice(street: LoadedWorld, coarse: Exposure) -> None:
    closer = _closer(street, coarse, DOWN, rays=9_000)
    seen = np.concatenate([some.site for some in closer.closer])
    assert 0 < sum(some.gather.size for some in closer.closer) <= 9_000 * len(DOWN)
    assert len(np.unique(seen)) == len(seen)


@pytest.mark.parametrize(("poses", "rays"), [(DOWN, 0), (UP, 60_000)], ids=["no rays", "only sky"])
def test_nothing_to_look_at_changes_nothing(
    street: LoadedWorld, coarse: Exposure, poses: np.ndarray, rays: int
) -> None:
    closer = _closer(street, coarse, poses, rays)
    assert closer.closer == ()
    np.testing.assert_array_equal(closer.sky_view, coarse.sky_view)


def test_repeats_to_the_bit(street: LoadedWorld, coarse: Exposure) -> None:
    a, b = (_closer(street, coarse, DOWN) for _ in range(2))
    np.testing.assert_array_equal(a.neighbour_share, b.neighbour_share)
    for one, other in zip(a.closer, b.closer, strict=True):
        np.testing.assert_array_equal(one.gather, other.gather)


def test_rays_of_some_sites_are_those_of_all(street: LoadedWorld) -> None:
    turn = stream(3).random(len(street.world.sites.area), dtype=np.float32)
    _, everybody = SiteRays.of(street.world)
    whole = gather_list(street, everybody, 64, turn)
    chosen = np.arange(7, len(turn), 13)
    (some,) = SiteRays.of_some(street.world, chosen)
    np.testing.assert_array_equal(gather_list(street, some, 64, turn), whole[:, some.order])


def test_isothermal_room_stays_exact() -> None:
    row = material("concrete_wall")
    loaded = load(room(tuple(Surface(row, e, row.solar_absorptance) for e in (0.95, 0.6, 0.25))))
    exposure = expose(loaded, SEASON, stream(1, "exposure"), ExposureKnobs(sun_step_min=120.0))
    middle = loaded.world.sites.position.astype(np.float64).mean(axis=0)
    place = (float(middle[0]), float(middle[1]), float(middle[2]))
    poses = np.stack([looking(place, heading, 0.0) for heading in (0.0, 120.0, 240.0)]).astype(np.float64)
    closer = look_closer(loaded, exposure, CAMERA, poses, stream(2, "closer"))
    assert closer.closer
    state = uniform_state(loaded.world, 291.37, Atmosphere(air_K=290.0, vapour_pressure_hPa=10.0))
    E = bake(loaded, closer, state, (8.0, 14.0))
    B = float(band_radiance(np.array([291.37]), (8.0, 14.0))[0])
    np.testing.assert_allclose(E, math.pi * B, rtol=1e-6)
