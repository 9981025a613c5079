"""Fixtures: wires that hang as wires do, nets of strands, fences that follow the ground, posts with a foot in it."""

from __future__ import annotations

import numpy as np
import pytest

from scenegen.classes import Semantic
from scenegen.foundation.errors import InputError
from scenegen.geometry.part import face_areas
from scenegen.parts.fixtures.erect import FIXTURES, erect
from scenegen.parts.fixtures.fences import STYLES, fence
from scenegen.parts.fixtures.nets import net, wire_mesh
from scenegen.parts.fixtures.utility import INSULATORS_M, TELEPHONE_M, fastenings, utility_pole
from scenegen.parts.fixtures.wires import wires

PANEL = np.array([[[0, 0, 0], [7.2, 0, 0], [7.2, 0, 2.4], [0, 0, 2.4]]], np.float64)
ONE = np.ones(1, np.int64)
LINE = np.array([[0, 0], [13, 0], [13, 9]], np.float64)


def middle_line(part, chords):
    """Centres of the rings of the first wire."""
    return part.vertices[: 3 * (chords + 1)].reshape(-1, 3, 3).mean(axis=1)


def hung(start, end, sag, radius=0.008, chords=64):
    wire = (np.array([start], np.float64), np.array([end], np.float64), np.array([sag], np.float64))
    return wires(*wire, radius, 5, int(Semantic.WIRE), 7 * ONE, chords)


def test_a_wire_hangs_as_a_parabola():
    line = middle_line(hung([0, 0, 9], [40, 9, 11], 0.8, chords=64), 64)
    t = np.linspace(0.0, 1.0, 65)
    straight = np.array([0, 0, 9]) + t[:, None] * np.array([40, 9, 2])
    assert np.allclose(line[:, :2], straight[:, :2])
    assert np.allclose(straight[:, 2] - line[:, 2], 4 * 0.8 * t * (1 - t))
    assert (straight[:, 2] - line[:, 2]).max() == pytest.approx(0.8)


@pytest.mark.parametrize("share", [0.01, 0.02, 0.03])
def test_a_parabola_is_a_catenary_to_a_hundredth_of_the_sag(share):
    span, sag = 40.0, 40.0 * share
    line = middle_line(hung([0, 0, 10], [span, 0, 10], sag, chords=64), 64)
    a = span**2 / (8 * sag)
    for _ in range(50):  # the parameter of the catenary with this sag
        a = span / 2 / np.arccosh(1 + sag / a)
    catenary = 10 - sag + a * (np.cosh((line[:, 0] - span / 2) / a) - 1)
    assert np.abs(line[:, 2] - catenary).max() < 0.01 * sag


def test_a_wire_is_a_closed_tube_of_its_radius():
    part = hung([0, 0, 9], [30, 0, 9], 0.5, radius=0.01, chords=8)
    rings = part.vertices.reshape(-1, 3, 3)
    assert np.allclose(np.linalg.norm(rings - rings.mean(axis=1, keepdims=True), axis=2), 0.01)
    assert len(part.faces) == 8 * 6 and len(part.site_position) == 2
    assert np.allclose(part.site_normal[0], [0, 0, 1]) and np.allclose(part.site_normal[1], [0, 0, -1])
    edges = np.sort(
        np.concatenate([part.faces[:, [0, 1]], part.faces[:, [1, 2]], part.faces[:, [2, 0]]]), axis=1
    )
    _, uses = np.unique(edges, axis=0, return_counts=True)
    assert (uses == 1).sum() == 6 and set(uses) == {1, 2}  # open only at both ends


def test_every_wire_has_its_own_id():
    start = np.array([[0, 0, 9], [0, 1, 9], [0, 2, 9]], np.float64)
    part = wires(
        start,
        start + np.array([30, 0, 0]),
        np.full(3, 0.4),
        0.008,
        2,
        int(Semantic.WIRE),
        np.array([4, 5, 6]),
    )
    assert [int((part.object == k).sum()) for k in (4, 5, 6)] == [48, 48, 48]
    for k in (4, 5, 6):
        y = part.vertices[np.unique(part.faces[part.object == k]), 1]
        assert np.abs(y - (k - 4)).max() < 0.01


def test_a_steep_wire_is_still_a_tube():
    part = hung([0, 0, 0], [0, 0, 5], 0.0, chords=2)
    assert np.isfinite(part.vertices).all() and face_areas(part.vertices, part.faces).min() > 1e-4


def test_a_net_has_a_strand_per_mesh():
    part = net(PANEL, 0.12, 0.002, 3, int(Semantic.GOAL), 9 * ONE)
    assert len(part.faces) == 6 * (61 + 21)
    assert len(part.site_position) == 2
    assert np.abs(part.vertices[:, 1]).max() < 0.003
    low, high = part.vertices.min(axis=0), part.vertices.max(axis=0)
    assert np.allclose(low[[0, 2]], 0, atol=0.003) and np.allclose(high[[0, 2]], [7.2, 2.4], atol=0.003)
    assert set(np.unique(part.object)) == {9}


def test_slack_lets_a_net_belly_out_backwards():
    part = net(PANEL, 0.4, 0.002, 3, int(Semantic.GOAL), ONE, slack_m=0.5, chords=8)
    front = np.array([0.0, -1.0, 0.0])  # counter-clockwise seen from the south
    assert (part.vertices @ front).min() == pytest.approx(-0.5, abs=0.03)
    assert (part.vertices @ front).max() < 0.01


def test_chain_link_is_real_wire_of_bounded_count():
    part = wire_mesh(PANEL, 0.06, 0.002, 3, int(Semantic.FENCE), ONE)
    assert len(part.faces) < 1.1 * 8.5 * (7.2 + 2.4) / 0.06
    inside = (part.vertices[:, [0, 2]] > -0.01) & (part.vertices[:, [0, 2]] < np.array([7.21, 2.41]))
    assert inside.all()
    start, end = part.vertices[part.faces[::6]][:, 0], part.vertices[part.faces[::6]][:, 2]
    rise = np.abs(end - start)
    assert np.allclose(rise[:, 0], rise[:, 2], atol=0.01)  # diagonal


@pytest.mark.parametrize("style", STYLES)
def test_a_fence_follows_the_ground_with_its_feet_in_it(style, workshop):
    def relief(xy):
        return 0.15 * xy[:, 0] - 0.1 * xy[:, 1]

    shop = workshop(relief)
    parts = fence(LINE, style, 1.6, shop, np.random.default_rng(0))
    points = np.concatenate([p.vertices for p in parts])
    above = points[:, 2] - relief(points[:, :2])
    assert -0.45 < above.min() < -0.1
    assert 1.5 < above.max() < 1.85
    assert len(np.unique(np.concatenate([p.object for p in parts]))) == 1
    label = Semantic.BARRIER if style == "wall" else Semantic.FENCE
    assert all((p.semantic == label).all() for p in parts)
    along = points[:, 0] + points[:, 1]
    assert along.min() < 0.1 and along.max() > 21.9


@pytest.mark.parametrize(("style", "most"), [("picket", 140), ("board", 140), ("rail", 40), ("wall", 20)])
def test_fences_are_cheap(style, most, workshop):
    parts = fence(LINE, style, 1.6, workshop(), np.random.default_rng(0))
    assert sum(len(p.faces) for p in parts) < most * 22.0
    assert sum(len(p.site_position) for p in parts) <= 2 * 10


def test_a_picket_fence_has_gaps_and_a_board_fence_none(workshop):
    cover = {}
    for style in ("picket", "board"):
        part = fence(np.array([[0.0, 0.0], [2.5, 0.0]]), style, 1.6, workshop(), np.random.default_rng(0))[0]
        x = np.linspace(0.2, 2.3, 400)
        corner = part.vertices[part.faces]
        low, high = corner[..., 0].min(axis=1), corner[..., 0].max(axis=1)
        mid = (corner[..., 2].min(axis=1) < 0.7) & (corner[..., 2].max(axis=1) > 0.9)
        cover[style] = np.mean([(mid & (low <= a) & (high >= a)).any() for a in x])
    assert cover["board"] == 1.0 and 0.45 < cover["picket"] < 0.75


@pytest.mark.parametrize("kind", FIXTURES)
def test_fixtures_have_a_foot_in_the_ground_and_few_sites(kind, workshop, row):
    shop = workshop()
    part = erect(kind, row(3), np.zeros(3), shop, np.random.default_rng(0))[0]
    assert -0.2 <= part.vertices[:, 2].min() <= -0.04
    assert len(part.site_position) <= 3 * 9 and len(part.faces) <= 3 * 300
    assert len(np.unique(part.object)) == 3
    assert face_areas(part.vertices, part.faces).min() > 1e-6
    worn = {shop.palette.surfaces()[k].material.name for k in np.unique(part.surface)}
    assert worn <= set(FIXTURES[kind][1])


@pytest.mark.parametrize(
    ("kind", "low", "high"),
    [("lamp", 6.0, 10.0), ("floodlight_mast", 18.0, 25.0), ("utility_pole", 8.0, 12.0), ("sign", 2.2, 3.2),
     ("traffic_light", 3.0, 4.0), ("bench", 0.7, 1.0), ("litter_bin", 0.8, 1.1), ("bus_shelter", 2.2, 2.8)],
)  # fmt: skip
def test_fixtures_have_real_heights(kind, low, high):
    assert low < FIXTURES[kind][0]().vertices[:, 2].max() < high


def test_wires_meet_the_insulators():
    place, turn = np.array([[5.0, 2.0, 1.0], [30.0, 4.0, 2.0]]), np.array([0.3, 2.0])
    insulators, telephone = fastenings(place, turn)
    tips = utility_pole().vertices
    for k in range(2):
        c, s = np.cos(turn[k]), np.sin(turn[k])
        world = tips @ np.array([[c, s, 0], [-s, c, 0], [0, 0, 1]]) + place[k]
        for point in (*insulators[k], telephone[k]):
            assert np.linalg.norm(world - point, axis=1).min() < 0.12
    assert len(INSULATORS_M) == 4 and TELEPHONE_M[2] < min(p[2] for p in INSULATORS_M)


def test_the_same_generator_puts_up_the_same_fence(workshop, same):
    first, second = (fence(LINE, "picket", 1.0, workshop(), np.random.default_rng(3)) for _ in range(2))
    assert same(first, second)


def test_unknown_styles_are_refused(workshop):
    with pytest.raises(InputError, match="picket"):
        fence(LINE, "pickett", 1.0, workshop(), np.random.default_rng(0))
