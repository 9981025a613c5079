"""Vehicles: sizes of real ones, wheels on the ground, faces outwards, warm parts only when driven."""

from __future__ import annotations

import numpy as np
import pytest
import shapely

from scenegen.classes import Semantic
from scenegen.foundation.errors import InputError
from scenegen.geometry.part import face_areas
from scenegen.parts.vehicles.fleet import Fleet
from scenegen.parts.vehicles.park import park, size_m
from scenegen.parts.vehicles.shapes import CARS
from scenegen.parts.vehicles.slots import BONNET, EXHAUST, GLASS, PAINT, TYRE, UNDERSIDE, WHEEL
from scenegen.parts.vehicles.vehicle import KINDS, body_size_m, vehicle

BODIES = (*CARS, "van", "bus", "truck")
LEVEL = np.zeros((6, 2))


@pytest.mark.parametrize("body", BODIES)
def test_a_body_has_the_size_it_says_and_stands_on_its_wheels(body):
    template = vehicle(body)
    low, high = template.vertices.min(axis=0), template.vertices.max(axis=0)
    length, width, height = body_size_m(body)
    assert high[0] - low[0] == pytest.approx(length, abs=0.1)  # the exhaust looks out
    shell = template.vertices[np.unique(template.faces[template.slot == GLASS])]
    assert np.abs(shell[:, 1]).max() <= width / 2
    assert high[2] == pytest.approx(height, abs=0.04)
    tyre = template.vertices[np.unique(template.faces[template.slot == TYRE])]
    assert tyre[:, 2].min() == pytest.approx(-0.01, abs=1e-6)
    assert low[2] >= -0.03


@pytest.mark.parametrize("body", BODIES)
def test_sheet_metal_and_glass_look_outwards(body, facing_inside):
    template = vehicle(body)
    assert facing_inside(template, (GLASS, BONNET)) < 0.01  # roots of mirrors
    assert facing_inside(template, (PAINT,)) < (0.15 if body == "truck" else 0.01)  # and the chassis
    assert face_areas(template.vertices, template.faces).min() > 1e-5


@pytest.mark.parametrize("body", CARS)
def test_a_car_is_cheap_enough_to_drive_in_crowds(body):
    template = vehicle(body)
    assert 250 <= len(template.faces) <= 650
    assert 8 <= len(template.site_position) <= 18
    assert set(np.unique(template.semantic)) == {int(Semantic.CAR)}


def test_a_car_is_left_right_symmetric_but_for_its_exhaust():
    template = vehicle("saloon")
    v = template.vertices[np.unique(template.faces[template.slot != EXHAUST])]
    mirrored = v * [1.0, -1.0, 1.0]
    order = [np.lexsort(np.round(p, 6).T) for p in (v, mirrored)]
    assert np.allclose(v[order[0]], mirrored[order[1]], atol=1e-6)


@pytest.mark.parametrize("kind", KINDS)
def test_parked_and_driven_differ_in_their_warm_parts_only(kind, workshop, row):
    shop = workshop()
    parts = {
        d: park(kind, row(6), np.zeros(6), LEVEL, shop, np.random.default_rng(1), driven=d)
        for d in (False, True)
    }
    palette = shop.palette.surfaces()

    def warm(driven: bool, slot: int) -> list[bool]:
        template = vehicle(kind if kind != "car" else "saloon")
        part = parts[driven][0]
        worn = part.surface[: len(template.slot)][template.slot == slot]
        return [np.isfinite(palette[k].interior_K) or palette[k].released_Wm2 > 0 for k in np.unique(worn)]

    for slot in (BONNET, TYRE, WHEEL, UNDERSIDE, EXHAUST):
        assert warm(True, slot) == [True] and warm(False, slot) == [False]
    assert warm(True, PAINT) == [False]
    owners = [np.unique(p.object) for p in parts[True]]
    assert len(np.unique(np.concatenate(owners))) == 6


def test_temperatures_behind_warm_parts_lie_in_their_ranges(workshop, row):
    for seed in range(5):
        shop = workshop(seed=seed)
        park("car", row(40), np.zeros(40), np.zeros((40, 2)), shop, np.random.default_rng(seed), driven=True)
        for s in shop.palette.surfaces():
            if np.isfinite(s.interior_K):
                assert 305.0 <= s.interior_K <= 450.0
            assert s.released_Wm2 == 0.0 or 200.0 <= s.released_Wm2 <= 320.0


def test_no_material_has_more_than_four_variants(workshop, row):
    shop, rng = workshop(), np.random.default_rng(0)
    for kind in KINDS:
        for driven in (False, True):
            park(kind, row(30), np.zeros(30), np.zeros((30, 2)), shop, rng, driven=driven)
    names = [s.material.name for s in shop.palette.surfaces()]
    assert max(names.count(n) for n in names) <= 4


def test_the_same_generator_parks_the_same_cars(workshop, row, same):
    first, second, third = (
        park("car", row(8), np.zeros(8), np.zeros((8, 2)), workshop(), np.random.default_rng(k))
        for k in (3, 3, 4)
    )
    assert same(first, second)
    assert len(first) != len(third) or not same(first, third)


def test_a_fleet_knows_where_its_cars_will_stand(workshop, row):
    fleet = Fleet.draw("car", 12, np.random.default_rng(5))
    place, turn = row(12), np.linspace(0.0, 3.0, 12)
    outline = fleet.outlines(place[:, :2], turn)
    parts = park("car", place, turn, np.zeros((12, 2)), workshop(), np.random.default_rng(6), fleet=fleet)
    ids = np.concatenate([np.unique(p.object) for p in parts])
    for part in parts:
        for k in np.unique(part.object):
            shape = outline[int(k - ids.min())].buffer(0.3)  # mirrors and exhausts
            used = np.unique(part.faces[part.object == k])
            assert shapely.contains_xy(shape, part.vertices[used, :2]).all()


def test_a_car_on_a_hill_leans_with_it(workshop):
    part = park(
        "bus", np.zeros((1, 3)), np.zeros(1), np.array([[0.1, 0.0]]), workshop(), np.random.default_rng(0)
    )[0]
    low = part.vertices[part.vertices[:, 2] - 0.1 * part.vertices[:, 0] < 0.01]
    assert np.ptp(low[:, 0]) > 5.0 and np.allclose(low[:, 2], 0.1 * low[:, 0], atol=0.02)


def test_unknown_kinds_are_refused_and_none_is_fine(workshop):
    with pytest.raises(InputError, match="truck"):
        size_m("trukc")
    assert (
        park("van", np.zeros((0, 3)), np.zeros(0), np.zeros((0, 2)), workshop(), np.random.default_rng(0))
        == []
    )
