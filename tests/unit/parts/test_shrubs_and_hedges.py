"""Shrubs fill their boxes and know the season; hedges follow their line and the ground, without gaps."""

from __future__ import annotations

import numpy as np
import pytest

from scenegen.classes import Semantic
from scenegen.climate.season import Season
from scenegen.parts.vegetation.grove import grove
from scenegen.parts.vegetation.hedges import hedge_piece, hedges
from scenegen.parts.vegetation.shrubs import LEAVES, shrub, shrubs

JANUARY = Season(52.0, 1, 10)


def test_shrubs_stay_in_their_boxes_and_root_in_the_ground(workshop, row):
    size = np.random.default_rng(1).uniform(0.6, 2.4, (20, 3))
    heading = np.zeros(20)
    parts = shrubs(row(20), size, heading, workshop(), np.random.default_rng(2))
    ids = np.concatenate([np.unique(p.object) for p in parts])
    assert np.array_equal(np.sort(ids), np.arange(1, 21))
    for part in parts:
        for k in np.unique(part.object):
            vertices = part.vertices[part.faces[part.object == k]].reshape(-1, 3) - row(20)[k - 1]
            assert (np.abs(vertices[:, :2]) <= 0.5 * size[k - 1, :2] + 1e-9).all()
            assert vertices[:, 2].max() == pytest.approx(size[k - 1, 2], rel=1e-6)
            assert -0.1 * size[k - 1, 2] < vertices[:, 2].min() < 0.0


def test_half_of_the_kinds_of_shrubs_are_bare_in_winter(workshop, row):
    count = 60
    shop = workshop(season=JANUARY)
    parts = shrubs(row(count), np.ones((count, 3)), np.zeros(count), shop, np.random.default_rng(2))
    twigs = set(shop.palette.variants("twigs_bare"))
    bare = [set(np.unique(p.surface)) <= twigs for p in parts]
    assert sum(bare) == 2 and len(bare) == 4
    assert all((p.semantic == int(Semantic.SHRUB)).all() for p in parts)


def test_no_leaf_of_a_shrub_or_hedge_is_above_its_sites():
    for made, slot in (
        (shrub(1.0, np.random.default_rng(0)), LEAVES),
        (hedge_piece(np.random.default_rng(0)), 0),
    ):
        leaf = made.slot == slot
        corners = made.vertices[made.faces[leaf]].reshape(-1, 3)
        for k in np.unique(made.corner_site[leaf]):
            assert ((corners - made.site_position[k]) @ made.site_normal[k]).max() < 0.09
        assert 3 <= len(np.unique(made.corner_site)) <= 7


def test_a_hedge_follows_line_and_ground_without_gaps(workshop):
    def relief(xy):
        return 0.08 * xy[:, 0] + 3.0

    line = np.array([[0.0, 0.0], [11.0, 0.0], [11.0, 8.0]])
    parts = hedges([line, line[:2] + 40.0], 1.5, 0.8, workshop(relief), np.random.default_rng(0), lift_m=0.1)
    vertices = np.concatenate([p.vertices[p.faces[p.object == 1]].reshape(-1, 3) for p in parts])
    above = vertices[:, 2] - relief(vertices[:, :2]) - 0.1
    assert -0.12 < above.min() < 0.0 and above.max() == pytest.approx(1.5, abs=0.03)
    first = vertices[vertices[:, 1] < 0.41]
    for x in np.arange(0.0, 11.0, 0.5):
        near = (np.abs(first[:, 0] - x) < 0.6) & (above[vertices[:, 1] < 0.41] > 1.2)
        assert near.sum() > 10
    off = np.minimum(np.abs(vertices[:, 1]), np.abs(vertices[:, 0] - 11.0))
    assert off.max() <= 0.4 + 1e-9
    assert {int(k) for p in parts for k in np.unique(p.object)} == {1, 2}


def test_hedges_are_deterministic_and_empty_lines_are_nothing(workshop, same):
    line = [np.array([[0.0, 0.0], [9.0, 2.0]])]
    first, again = (hedges(line, 1.2, 0.7, workshop(), np.random.default_rng(4)) for _ in range(2))
    assert same(first, again)
    assert hedges([], 1.0, 0.7, workshop(), np.random.default_rng(4)) == []


def test_a_grove_fills_its_cylinder_and_differs_from_the_next():
    first, second = (grove(np.random.default_rng(k)) for k in (0, 1))
    assert first.vertices[:, 2].max() == 1.0 and -0.2 < first.vertices[:, 2].min() < 0.0
    assert np.hypot(first.vertices[:, 0], first.vertices[:, 1]).max() == pytest.approx(0.5)
    assert 100 < len(first.faces) < 260
    assert set(first.slot) == {0} and len(np.unique(first.corner_site)) == 4
    assert not np.allclose(first.vertices, second.vertices)
