"""Boats: sizes of real ones, afloat, hulls that look outwards, engines warm when they run."""

from __future__ import annotations

import numpy as np
import pytest

from scenegen.classes import Semantic
from scenegen.foundation.errors import InputError
from scenegen.parts.boats.boat import KINDS, boat
from scenegen.parts.boats.moor import moor, size_m
from scenegen.parts.boats.slots import ENGINE, EXHAUST, HULL, METAL, SAIL


@pytest.mark.parametrize("kind", KINDS)
def test_a_boat_floats_and_has_its_size(kind):
    template, (length, beam, height) = boat(kind), size_m(kind)
    hull = template.vertices[np.unique(template.faces[template.slot == HULL])]
    assert np.ptp(hull[:, 0]) == pytest.approx(length, abs=0.02)
    assert np.ptp(hull[:, 1]) == pytest.approx(beam, rel=0.03)
    assert template.vertices[:, 2].max() == pytest.approx(height, abs=0.15)
    assert -1.0 < hull[:, 2].min() < -0.1
    assert set(np.unique(template.semantic)) == {int(Semantic.BOAT)}
    assert 250 <= len(template.faces) <= 800 and len(template.site_position) <= 16


@pytest.mark.parametrize("kind", KINDS)
def test_hulls_look_outwards(kind, facing_inside):
    assert facing_inside(boat(kind), (HULL,)) < 0.1  # what stands on the deck has its foot in it


def test_the_inside_of_an_open_boat_is_dry():
    template = boat("rowing")
    inside = template.vertices[np.unique(template.faces[template.slot != HULL])]
    assert inside[np.abs(inside[:, 1]) < 0.7, 2].min() > 0.03


def test_stays_are_thin_and_reach_the_masthead():
    template = boat("sailing")
    metal = template.vertices[np.unique(template.faces[template.slot == METAL])]
    bow = metal[metal[:, 0] > 4.5]
    assert len(bow) and metal[:, 2].max() > 12.0
    edge = np.linalg.norm(np.diff(template.vertices[template.faces][:, :2], axis=1)[:, 0], axis=1)
    assert edge.max() > 11.0  # the forestay is one straight piece
    assert 0.005 < edge[template.slot == METAL].min() < 0.02


@pytest.mark.parametrize("kind", KINDS)
def test_engines_are_warm_when_they_run(kind, workshop, row):
    for running in (False, True):
        shop = workshop()
        part = moor(kind, row(3), np.zeros(3), shop, np.random.default_rng(1), running=running)[0]
        template, palette = boat(kind, running), shop.palette.surfaces()
        faces = len(template.faces)
        for slot in (ENGINE, EXHAUST):
            worn = part.surface[:faces][template.slot == slot]
            assert all(np.isfinite(palette[k].interior_K) == running for k in worn)
        assert len(np.unique(part.object)) == 3
        assert part.semantic.min() == part.semantic.max() == Semantic.BOAT
    assert (kind in ("motor", "fishing")) == bool((boat(kind).slot == ENGINE).any())


def test_sails_are_set_under_way():
    furled, set_ = boat("sailing"), boat("sailing", running=True)
    top = [t.vertices[np.unique(t.faces[t.slot == SAIL]), 2].max() for t in (furled, set_)]
    assert top[0] < 3.0 < 11.0 < top[1]


def test_the_same_generator_moors_the_same_boats(workshop, row, same):
    first, second = (
        moor("fishing", row(4), np.zeros(4), workshop(), np.random.default_rng(3)) for _ in range(2)
    )
    assert same(first, second)


def test_unknown_boats_are_refused(workshop, row):
    with pytest.raises(InputError, match="sailing"):
        moor("sailling", row(1), np.zeros(1), workshop(), np.random.default_rng(0))
