"""The palette: few variants, inside the measured ranges, the same for the same generator."""

from __future__ import annotations

import numpy as np
import pytest

from scenegen.foundation.errors import InputError
from scenegen.materials.palette import ABSORPTANCE_SPREAD, PaletteBuilder
from scenegen.materials.table import materials


def build(seed):
    palette = PaletteBuilder(np.random.default_rng(seed))
    for name in materials():
        palette.variants(name)
    return palette.surfaces()


def test_variants_stay_inside_the_measured_ranges():
    surfaces = build(0)
    assert len(surfaces) == 4 * len(materials())
    for surface in surfaces:
        low, high = surface.material.emissivity_range
        assert low <= surface.emissivity <= high
        assert (
            abs(surface.solar_absorptance - surface.material.solar_absorptance) <= ABSORPTANCE_SPREAD + 1e-12
        )
        heated = surface.material.build.value in ("wall_ins", "roof_ins", "roof_vent", "window")
        assert np.isfinite(surface.interior_K) == heated


def test_the_generator_decides():
    assert repr(build(1)) == repr(build(1))
    assert repr(build(1)) != repr(build(2))


def test_a_material_is_drawn_once_and_picked_among_its_variants():
    palette = PaletteBuilder(np.random.default_rng(0))
    first = palette.variants("brick_red", 3)
    assert palette.variants("brick_red", 4) == first
    picks = {palette.pick("brick_red", np.random.default_rng(k)) for k in range(40)}
    assert picks == set(first)


def test_special_variants_keep_what_they_are_given():
    palette = PaletteBuilder(np.random.default_rng(0))
    pond = palette.special("water_fresh_or_sea", "pond", prescribed_K=288.0)
    assert palette.special("water_fresh_or_sea", "pond", prescribed_K=300.0) == pond
    assert palette.surfaces()[pond].prescribed_K == 288.0
    rolling = palette.special("tyre_rubber", "rolling", released_Wm2=250.0)
    tyre = palette.surfaces()[rolling]
    assert tyre.released_Wm2 == 250.0 and np.isnan(tyre.interior_K)


def test_drawn_and_special_variants_are_bounded_whoever_comes_first():
    palette = PaletteBuilder(np.random.default_rng(0))
    palette.variants("car_paint_white", 4)
    keys = [palette.special("car_paint_white", str(k), interior_K=330.0 + k) for k in range(4)]
    assert len(set(keys)) == 4
    with pytest.raises(AssertionError):
        palette.special("car_paint_white", "one too many", interior_K=350.0)


def test_an_unknown_material_names_the_nearest():
    with pytest.raises(InputError, match="brick_red"):
        PaletteBuilder(np.random.default_rng(0)).only("brick_rd")
