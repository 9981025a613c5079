"""Sky view and neighbour shares against closed-form view factors.

Geometry: small horizontal or vertical probes in front of long walls, in a street canyon, in a courtyard. Expected: the
view factor of a differential element to a rectangle or an infinite strip (Howell, A Catalog of Radiation Heat Transfer
Configuration Factors, B-3, B-4, B-5).
"""

from __future__ import annotations

import math

import numpy as np
import pytest

from scenegen.classes import Semantic
from scenegen.climate.season import Season
from scenegen.exposure import SKY_BINS, Exposure
from scenegen.foundation.rng import stream
from scenegen.materials.material import Surface
from scenegen.materials.table import material
from scenegen.world import World
from scenegen_render.exposure.expose import expose
from scenegen_render.exposure.knobs import ExposureKnobs
from scenegen_render.reference_scenes import Patch, box, plate, room, world_of
from scenegen_render.scene import load

FINE = ExposureKnobs(directions=1024, smoothing=False, sun_step_min=120.0)
SEASON = Season(latitude_deg=40.0, month=7, day=15)
LONG = 4000.0


def _surface(name: str = "concrete_wall") -> Surface:
    row = material(name)
    return Surface(row, row.emissivity, row.solar_absorptance)


PALETTE = (_surface("concrete_wall"), _surface("asphalt_aged"))


def _rectangle(corner: tuple, along: tuple, up: tuple, *rest: object) -> Patch:
    """Patch from corners written as whole numbers."""
    return Patch(*(tuple(float(v) for v in vector) for vector in (corner, along, up)), *rest)


def _probe(x: float, y: float = 0.0, z: float = 0.0) -> Patch:
    """A square decimetre of ground, facing up."""
    return _rectangle((x - 0.05, y - 0.05, z), (0.1, 0, 0), (0, 0.1, 0), (1, 1), 1, Semantic.ROAD, 99)


def _wall_facing_west(x: float, height: float) -> Patch:
    return _rectangle((x, LONG / 2, 0), (0, -LONG, 0), (0, 0, height), (1, 1), 0, Semantic.WALL, 1)


def _wall_facing_east(x: float, height: float) -> Patch:
    return _rectangle((x, -LONG / 2, 0), (0, LONG, 0), (0, 0, height), (1, 1), 0, Semantic.WALL, 2)


def _exposed(world: World, knobs: ExposureKnobs = FINE, seed: int = 1) -> Exposure:
    return expose(load(world), SEASON, stream(seed, "exposure"), knobs)


def _probe_view(patches: list[Patch]) -> float:
    """Mean sky view of the probe, which is the last patch."""
    exposure = _exposed(world_of("probe", patches, PALETTE))
    return float(exposure.sky_view[-4:].mean())


@pytest.mark.parametrize("distance", [1.0, 5.0, 10.0, 40.0])
def test_ground_in_front_of_a_long_wall(distance: float) -> None:
    """Sky view (1 + cos(elevation of the upper edge)) / 2."""
    height = 12.0
    seen = _probe_view([_wall_facing_west(distance, height), _probe(0.0)])
    assert seen == pytest.approx(0.5 * (1 + distance / math.hypot(distance, height)), abs=3e-3)


@pytest.mark.parametrize("x", [0.5, 5.0, 10.0])
def test_floor_of_a_street_canyon(x: float) -> None:
    """20 m wide, 15 m high: half the sum of the cosines of both edges' elevations."""
    width, height = 20.0, 15.0
    seen = _probe_view([_wall_facing_east(0.0, height), _wall_facing_west(width, height), _probe(x)])
    expected = 0.5 * (x / math.hypot(x, height) + (width - x) / math.hypot(width - x, height))
    assert seen == pytest.approx(expected, abs=3e-3)


def test_middle_of_a_courtyard() -> None:
    """The open top seen from the middle of the floor: four parallel rectangles with a corner above the element."""
    a, b, height = 12.0, 20.0, 9.0
    walls = [
        _rectangle((-a / 2, b / 2, 0), (a, 0, 0), (0, 0, height), (1, 1), 0, Semantic.WALL, 1),
        _rectangle((a / 2, -b / 2, 0), (-a, 0, 0), (0, 0, height), (1, 1), 0, Semantic.WALL, 2),
        _rectangle((-a / 2, -b / 2, 0), (0, b, 0), (0, 0, height), (1, 1), 0, Semantic.WALL, 3),
        _rectangle((a / 2, b / 2, 0), (0, -b, 0), (0, 0, height), (1, 1), 0, Semantic.WALL, 4),
    ]
    X, Y = 0.5 * a / height, 0.5 * b / height
    p, q = math.hypot(1, X), math.hypot(1, Y)
    quarter = (X / p * math.atan(Y / p) + Y / q * math.atan(X / q)) / (2 * math.pi)
    assert _probe_view([*walls, _probe(0.0)]) == pytest.approx(4 * quarter, abs=3e-3)


def test_wall_over_wide_ground_sees_half_sky_half_ground() -> None:
    ground = _rectangle((-LONG, -LONG, 0), (2 * LONG, 0, 0), (0, 2 * LONG, 0), (2, 2), 1, Semantic.ROAD, 1)
    wall = _rectangle((-0.05, 0, 1.0), (0.1, 0, 0), (0, 0, 0.1), (1, 1), 0, Semantic.WALL, 2)
    exposure = _exposed(world_of("wall", [ground, wall], PALETTE), ExposureKnobs(smoothing=False))
    np.testing.assert_allclose(exposure.sky_view[-4:], 0.5, atol=1e-6)
    np.testing.assert_allclose(exposure.neighbour_share[-4:].sum(axis=1), 0.5, atol=1e-6)
    np.testing.assert_array_equal(exposure.neighbour_share[-4:].max(axis=1) > 0.49, True)  # all in one group


def test_open_plate_sees_nothing_but_sky() -> None:
    exposure = _exposed(plate(_surface()))
    np.testing.assert_array_equal(exposure.sky_view, 1.0)
    np.testing.assert_array_equal(exposure.neighbour_share, 0.0)
    assert exposure.gather.min() > exposure.gather.shape[1]  # sky bins above the horizon only


@pytest.mark.parametrize("smoothing", [False, True])
def test_closed_room_sees_no_sky_and_shares_sum_to_one(smoothing: bool) -> None:
    world = room(PALETTE)
    exposure = _exposed(world, ExposureKnobs(smoothing=smoothing))
    np.testing.assert_array_equal(exposure.sky_view, 0.0)
    np.testing.assert_allclose(exposure.neighbour_share.sum(axis=1), 1.0, atol=1e-5)
    assert exposure.gather.max() < exposure.gather.shape[1]
    assert not exposure.beam.any()


def test_shares_sum_to_one_with_what_lies_below_the_horizon() -> None:
    """A tower on a small island of ground: walls look past the edge of the world."""
    island = _rectangle((-20, -20, 0), (40, 0, 0), (0, 40, 0), (8, 8), 1, Semantic.ROAD, 1)
    tower = box((-4.0, -4.0, 0.0), (4.0, 4.0, 30.0), 4.0, 0, Semantic.WALL, 2)
    exposure = _exposed(world_of("island", [island, *tower], PALETTE), ExposureKnobs(smoothing=False))
    sites = exposure.gather.shape[1]
    assert exposure.gather.max() < sites + SKY_BINS
    beyond = np.mean(exposure.gather == sites, axis=0)
    total = exposure.sky_view + exposure.neighbour_share.sum(axis=1) + beyond
    np.testing.assert_allclose(total, 1.0, atol=1e-6)
    assert beyond[81:].max() > 0.1  # walls
    np.testing.assert_array_equal(beyond[:81], 0.0)  # ground


def test_gather_list_names_the_site_nearest_to_the_hit() -> None:
    """A floor of four distinct corner sites under a low ceiling: straight up-going rays meet the corner above."""
    floor = _rectangle((0, 0, 0), (10, 0, 0), (0, 10, 0), (1, 1), 1, Semantic.ROAD, 1)
    ceiling = _rectangle((0, 0, 0.05), (0, 10, 0), (10, 0, 0), (1, 1), 0, Semantic.ROOF, 2)
    world = world_of("gap", [floor, ceiling], PALETTE)
    exposure = _exposed(world)
    above = [int(np.argmin(np.linalg.norm(world.sites.position[4:, :2] - p[:2], axis=1))) + 4
             for p in world.sites.position[:4]]  # fmt: skip
    met = np.stack([np.bincount(exposure.gather[:, k], minlength=8 + SKY_BINS)[:8] for k in range(4)])
    for k in range(4):
        hits = met[k, 4:]
        assert met[k, :4].sum() == 0  # nothing meets its own plane
        assert int(np.argmax(hits)) + 4 == above[k]
        assert hits[above[k] - 4] > 0.95 * hits.sum()
