"""Sites of the ground keep out of what stands on it."""

from __future__ import annotations

import numpy as np
import pytest
import shapely

from scenegen.classes import Semantic
from scenegen.geometry.beside import beside_things
from scenegen.geometry.boxes import boxes
from scenegen.geometry.part import Part, concatenate
from scenegen.geometry.patch import patches

SLOPE = 0.2
HEDGE = shapely.box(-4.0, -0.4, 4.0, 0.4)


def ground(semantic: Semantic = Semantic.GRASS) -> Part:
    """A sloping lawn of 20 m with sites every metre."""
    square = np.array([[[-10, -10], [10, -10], [10, 10], [-10, 10]]], np.float64)
    corners = np.concatenate([square, SLOPE * square[..., :1]], axis=-1)
    zero = np.zeros(1, np.int64)
    return patches(corners, 1.0, zero, zero + int(semantic), zero + 1)


def thing(size_m: tuple[float, float, float], semantic: Semantic, lift_m: float = -0.6) -> Part:
    size, one = np.array([size_m]), np.ones(1, np.int64)
    return boxes(np.array([[0.0, 0.0, lift_m]]), size, np.zeros(1), one, one * int(semantic), one + 1)


@pytest.mark.parametrize("semantic", [Semantic.SHRUB, Semantic.STREET_FURNITURE, Semantic.FENCE])
def test_sites_leave_a_bin_the_shortest_way_and_stay_on_the_slope(semantic):
    lawn = ground()
    moved = beside_things(concatenate([lawn, thing((0.6, 0.6, 1.6), semantic)])).site_position
    count = len(lawn.site_position)
    before, after = lawn.site_position, moved[:count]
    changed = np.flatnonzero((before != after).any(axis=1))
    assert 1 <= len(changed) <= 4
    bin_ = shapely.box(-0.3, -0.3, 0.3, 0.3)
    away = shapely.distance(bin_, shapely.points(after[changed, :2]))
    assert ((away > 0.2) & (away < 1.2)).all()
    np.testing.assert_allclose(after[changed, 2], SLOPE * after[changed, 0], atol=1e-9)
    np.testing.assert_array_equal(
        moved[count:], concatenate([lawn, thing((0.6, 0.6, 1.6), semantic)]).site_position[count:]
    )


def test_no_site_stays_under_a_hedge_and_none_far_away_moves():
    lawn = ground()
    whole = concatenate([lawn, *(_bush(x) for x in np.arange(-3.8, 4.0, 0.3))])
    under = shapely.contains_xy(HEDGE, lawn.site_position[:, :2])
    assert np.count_nonzero(under) > 5
    after = beside_things(whole).site_position[: len(lawn.site_position)]
    assert not shapely.contains_xy(HEDGE, after[:, :2]).any()
    far = shapely.distance(HEDGE, shapely.points(lawn.site_position[:, :2])) > 1.0
    np.testing.assert_array_equal(after[far], lawn.site_position[far])


@pytest.mark.parametrize(
    ("what", "lawn"),
    [
        (thing((0.6, 0.6, 1.6), Semantic.WALL), ground()),  # walls have contact lines of their own
        (thing((0.6, 0.6, 1.6), Semantic.SHRUB), ground(Semantic.ROOF)),
        (thing((9.0, 9.0, 1.6), Semantic.STREET_FURNITURE), ground()),  # nowhere to go
    ],
)
def test_what_stays_as_it_is(what, lawn):
    whole = concatenate([lawn, what])
    centre = np.argmin(np.linalg.norm(lawn.site_position, axis=1))
    np.testing.assert_array_equal(beside_things(whole).site_position[centre], lawn.site_position[centre])


def _bush(x: float) -> Part:
    one = np.ones(1, np.int64)
    size = np.array([[0.3, 0.8, 1.8]])
    return boxes(np.array([[x, 0.0, -0.9]]), size, np.zeros(1), one, one * int(Semantic.SHRUB), one + 1)
