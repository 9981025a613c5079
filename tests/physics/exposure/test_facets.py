"""Averaging along facets: exact for planes, quieter for noise, silent across edges."""

from __future__ import annotations

import numpy as np
import pytest

from scenegen.classes import Semantic
from scenegen.exposure import SKY_BINS
from scenegen.foundation.rng import stream
from scenegen.materials.material import Surface
from scenegen.materials.table import material
from scenegen.world import World
from scenegen_render.exposure.facets import FacetAverage
from scenegen_render.reference_scenes import Patch, room, world_of

_ROW = material("concrete_wall")
SURFACE = Surface(_ROW, _ROW.emissivity, _ROW.solar_absorptance)


def _seeing(sky: np.ndarray, directions: int = 64) -> np.ndarray:
    """A gather list in which each site sees the sky in a given share of the directions, itself in the rest."""
    sites = len(sky)
    place = (np.arange(directions) + 0.5)[:, None] / directions
    return np.where(place < sky, sites + SKY_BINS - 1, np.arange(sites)).astype(np.uint32)


@pytest.fixture(scope="module")
def sheet() -> World:
    patch = Patch((-20.0, -15.0, 0.0), (40.0, 5.0, 3.0), (-4.0, 30.0, 1.0), (24, 18), 0, Semantic.GRASS, 1)
    return world_of("sheet", [patch], (SURFACE,))


@pytest.fixture(scope="module")
def average(sheet: World) -> FacetAverage:
    return FacetAverage.of(sheet, _seeing(np.full(len(sheet.sites.area), 0.5)))


def test_linear_fields_pass_unchanged(sheet: World, average: FacetAverage) -> None:
    value = (sheet.sites.position @ np.array([0.3, -0.7, 0.2], np.float32) + 5.0).astype(np.float32)
    # the damping of the slopes leaves a trace at the border, where the neighbours lie to one side
    np.testing.assert_allclose(average(average(value)), value, atol=2e-2)
    np.testing.assert_allclose(average(np.full(len(value), 0.37, np.float32)), 0.37, rtol=1e-6)


def test_noise_shrinks_by_half(sheet: World, average: FacetAverage) -> None:
    noise = stream(1).standard_normal(len(sheet.sites.area)).astype(np.float32)
    assert float(average(noise).std()) < 0.5 * float(noise.std())


def test_sites_that_see_something_else_are_left_alone(sheet: World) -> None:
    """One half of the sheet lies under a roof: the step in sky view survives, and so does any quantity along it."""
    roofed = sheet.sites.position[:, 0] < 0.0
    average = FacetAverage.of(sheet, _seeing(np.where(roofed, 0.2, 0.8)))
    value = np.where(roofed, 1.0, 3.0).astype(np.float32)
    np.testing.assert_allclose(average(value), value, rtol=1e-6)


def test_nothing_crosses_an_edge() -> None:
    world = room((SURFACE,))
    side = world.sites.object.astype(np.float32)
    pillar = world.sites.object == 7
    side[pillar] += np.abs(world.sites.normal[pillar]) @ np.array([1, 2, 3], np.float32)
    average = FacetAverage.of(world, _seeing(np.zeros(len(side))))
    np.testing.assert_allclose(average(side), side, rtol=1e-6)


def test_rows_never_amplify(average: FacetAverage) -> None:
    weights = average.weights
    np.testing.assert_allclose(weights.sum(axis=1), 1.0, rtol=1e-5)
    assert float((weights * weights).sum(axis=1).max()) <= 1.0 + 1e-6


def test_columns_are_averaged_independently(sheet: World, average: FacetAverage) -> None:
    values = stream(2).random((len(sheet.sites.area), 3)).astype(np.float32)
    np.testing.assert_array_equal(average(values)[:, 1], average(values[:, 1].copy()))
