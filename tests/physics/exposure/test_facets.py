"""Averaging along facets: exact for planes, quieter for noise, silent across edges."""

from __future__ import annotations

import numpy as np
import pytest

from scenegen.classes import Semantic
from scenegen.foundation.rng import stream
from scenegen.materials.material import Surface
from scenegen.materials.table import material
from scenegen.world import World
from scenegen_render.exposure.facets import FacetAverage
from scenegen_render.reference_scenes import Patch, room, world_of

_ROW = material("concrete_wall")
SURFACE = Surface(_ROW, _ROW.emissivity, _ROW.solar_absorptance)


@pytest.fixture(scope="module")
def sheet() -> World:
    patch = Patch((-20.0, -15.0, 0.0), (40.0, 5.0, 3.0), (-4.0, 30.0, 1.0), (24, 18), 0, Semantic.GRASS, 1)
    return world_of("sheet", [patch], (SURFACE,))


def test_linear_fields_pass_unchanged(sheet: World) -> None:
    value = (sheet.sites.position @ np.array([0.3, -0.7, 0.2], np.float32) + 5.0).astype(np.float32)
    average = FacetAverage.of(sheet)
    # the damping of the slopes leaves a trace at the border, where the neighbours lie to one side
    np.testing.assert_allclose(average(value, 2), value, atol=2e-2)
    np.testing.assert_allclose(average(np.full(len(value), 0.37, np.float32), 4), 0.37, rtol=1e-6)


def test_noise_shrinks(sheet: World) -> None:
    noise = stream(1).standard_normal(len(sheet.sites.area)).astype(np.float32)
    average = FacetAverage.of(sheet)
    spread = [float(average(noise, rounds).std()) for rounds in (0, 1, 2)]
    assert spread[1] < 0.5 * spread[0]
    assert spread[2] < 0.8 * spread[1]


def test_nothing_crosses_an_edge() -> None:
    world = room((SURFACE,))
    side = world.sites.object.astype(np.float32)
    side[world.sites.object == 7] += np.abs(world.sites.normal[world.sites.object == 7]) @ np.array(
        [1, 2, 3], np.float32
    )
    np.testing.assert_allclose(FacetAverage.of(world)(side, 3), side, rtol=1e-6)


def test_rows_never_amplify(sheet: World) -> None:
    weights = FacetAverage.of(sheet).weights
    np.testing.assert_allclose(weights.sum(axis=1), 1.0, rtol=1e-5)
    assert float((weights * weights).sum(axis=1).max()) <= 1.0 + 1e-6


def test_columns_are_averaged_independently(sheet: World) -> None:
    values = stream(2).random((len(sheet.sites.area), 3)).astype(np.float32)
    average = FacetAverage.of(sheet)
    np.testing.assert_array_equal(average(values, 2)[:, 1], average(values[:, 1].copy(), 2))
