"""Sun visibility against float64 geometry: the moving shadow of a box on flat ground.

Rationale: the exposure asks a float32 ray tracer at the ends of 15-minute steps and halves in between; the oracle asks
an analytic ray-box test in float64 at 96 moments of each step. Expected: the lit share of a step agrees to the
resolution of the search, except where the shadow's corner grazes the site (two changes within one step).
"""

from __future__ import annotations

import numpy as np
import pytest

from scenegen.classes import Semantic
from scenegen.climate.season import Season
from scenegen.climate.sun import daylight, sun_direction
from scenegen.foundation.rng import stream
from scenegen.materials.material import Surface
from scenegen.materials.table import material
from scenegen_render.exposure.expose import expose
from scenegen_render.exposure.rays import SiteRays
from scenegen_render.exposure.sun import SunSteps, sun_beam
from scenegen_render.reference_scenes import Patch, box, plate, world_of
from scenegen_render.scene import load

_ROW = material("asphalt_aged")
PALETTE = (Surface(_ROW, _ROW.emissivity, _ROW.solar_absorptance),)
LOW, HIGH = np.array([-4.0, -3.0, 0.0]), np.array([4.0, 3.0, 9.0])
MOMENTS = 96


def _rectangle(corner: tuple, along: tuple, up: tuple, *rest: object) -> Patch:
    """Patch from corners written as whole numbers."""
    return Patch(*(tuple(float(v) for v in vector) for vector in (corner, along, up)), *rest)


def _lit(position: np.ndarray, direction: np.ndarray) -> np.ndarray:
    """Slab test: whether the ray from each position (sites, 3) towards each direction (moments, 3) misses the box."""
    with np.errstate(divide="ignore", invalid="ignore"):
        a = (LOW - position)[:, None] / direction[None]
        b = (HIGH - position)[:, None] / direction[None]
    near, far = np.minimum(a, b).max(axis=2), np.maximum(a, b).min(axis=2)
    return ~((near < far) & (far > 0.0))


def _lit_cosine(position: np.ndarray, direction: np.ndarray) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Mean of cosine times visibility over a step: least and largest within 5 mm of each position, and changes.

    An edge that creeps along its own direction needs minutes for a millimetre, hence the neighbourhood.
    """
    cosine = np.maximum(direction[:, 2], 0.0)
    shifts = np.concatenate([np.zeros((1, 3)), 0.005 * np.eye(3), -0.005 * np.eye(3)])
    lit = [_lit(position + shift, direction) for shift in shifts]
    means = np.stack([(seen * cosine).mean(axis=1) for seen in lit])
    changes = np.abs(np.diff(lit[0].astype(np.int8), axis=1)).sum(axis=1)
    return means.min(axis=0), means.max(axis=0), changes


@pytest.mark.parametrize(
    "season",
    [Season(40.0, 7, 15), Season(-33.0, 6, 21), Season(62.0, 3, 20)],
    ids=["summer", "southern winter", "northern equinox"],
)
def test_shadow_of_a_box(season: Season) -> None:
    ground = _rectangle((-30, -30, 0), (60, 0, 0), (0, 60, 0), (22, 24), 0, Semantic.ROAD, 1)
    world = world_of(
        "shadow",
        [ground, *box(tuple(map(float, LOW)), tuple(map(float, HIGH)), 3.0, 0, Semantic.WALL, 2)],
        PALETTE,
    )
    (rays, _), steps = SiteRays.of(world), SunSteps.of(season, 15.0)
    beam = sun_beam(load(world), rays, steps).astype(np.float64)

    on_ground = np.zeros(len(world.sites.area), bool)
    on_ground[: 23 * 25] = True
    position = world.sites.position.astype(np.float64)
    on_ground &= (np.abs(position[:, 0]) > 4.05) | (np.abs(position[:, 1]) > 3.05)
    rise, sunset = daylight(season)
    length = (sunset - rise) / len(steps.hour)
    agreed = wrong = grazed = steady = 0
    for k in range(len(steps.hour)):
        direction = sun_direction(season, rise + length * (k + (np.arange(MOMENTS) + 0.5) / MOMENTS))
        low, high, changes = _lit_cosine(position[on_ground], direction)
        seen = beam[on_ground, k]
        allowed = (1 / 16 + 0.01) * direction[:, 2].max() + 1e-3
        simple = changes <= 1
        right = (seen >= low - allowed) & (seen <= high + allowed)
        agreed += int((simple & right).sum())
        wrong += int((simple & ~right).sum())
        grazed += int((~simple).sum())
        steady += int(((changes == 0) & (np.abs(seen - low) < 2e-3)).sum())
    assert wrong == 0
    assert grazed < 0.01 * agreed
    assert agreed > 15_000
    assert steady > 0.9 * agreed


def test_beam_of_an_open_plate_is_the_cosine() -> None:
    season = Season(48.0, 9, 1)
    exposure = expose(load(plate(PALETTE[0])), season, stream(1))
    np.testing.assert_allclose(exposure.sun_direction, sun_direction(season, exposure.sun_hour), atol=1e-12)
    expected = np.broadcast_to(exposure.sun_direction[:, 2], exposure.beam.shape)
    np.testing.assert_allclose(exposure.beam.astype(np.float64), expected, rtol=1e-3, atol=1e-4)


def test_steps_cover_the_daylight_evenly() -> None:
    season = Season(40.0, 7, 15)
    steps = SunSteps.of(season, 15.0)
    rise, sunset = daylight(season)
    length = np.diff(steps.hour)
    np.testing.assert_allclose(length, length[0], rtol=1e-9)
    assert length[0] <= 0.25
    assert steps.hour[0] - rise == pytest.approx(length[0] / 2, rel=1e-6)
    assert sunset - steps.hour[-1] == pytest.approx(length[0] / 2, rel=1e-6)


def test_polar_night_has_no_sun_and_polar_day_has_a_whole_day() -> None:
    night = expose(load(plate(PALETTE[0])), Season(78.0, 12, 21), stream(1))
    assert night.beam.shape == (25, 0)
    assert night.sun_hour.shape == (0,)
    np.testing.assert_allclose(night.sky_view, 1.0, atol=1e-6)
    day = SunSteps.of(Season(78.0, 6, 21), 15.0)
    assert len(day.hour) == 96
    assert day.direction[:, 2].min() > 0


def test_walls_see_the_sun_on_their_own_side_only() -> None:
    world = world_of(
        "box", box(tuple(map(float, LOW)), tuple(map(float, HIGH)), 3.0, 0, Semantic.WALL, 1), PALETTE
    )
    season = Season(40.0, 3, 21)
    exposure = expose(load(world), season, stream(1))
    facing = {name: (world.sites.normal @ np.array(axis, np.float32)) > 0.9 for name, axis in
              {"east": (1, 0, 0), "west": (-1, 0, 0), "north": (0, 1, 0), "south": (0, -1, 0)}.items()}  # fmt: skip
    morning, evening = exposure.sun_hour < 11.5, exposure.sun_hour > 12.6
    assert exposure.beam[facing["east"]][:, morning].min() > 0.05
    assert not exposure.beam[facing["east"]][:, evening].any()
    assert not exposure.beam[facing["west"]][:, morning].any()
    noon = np.argmin(np.abs(exposure.sun_hour - 12.0))
    assert exposure.beam[facing["south"], noon].min() > 0.5
    assert not exposure.beam[facing["north"], noon].any()
