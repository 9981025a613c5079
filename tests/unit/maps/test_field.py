"""The field: three small worlds hold every invariant; one seed gives the same bytes, two seeds two grounds."""

from __future__ import annotations

from functools import cache

import numpy as np
import pytest
import shapely

from scenegen.classes import Semantic
from scenegen.climate.season import Season
from scenegen.foundation.rng import stream
from scenegen.maps.field.field import build_field
from scenegen.maps.field.grounds import lay_out_grounds
from scenegen.maps.field.knobs import FieldKnobs
from scenegen.maps.field.pitch import GOAL_HEIGHT_M, GOAL_WIDTH_M, LINE_M
from worlds import (
    GROUND,
    areas,
    check_apart,
    check_arrays,
    check_one_ground,
    check_palette,
    check_same_bytes,
    corners,
    feet,
    normals,
    plans,
    things,
)

SEASON = Season(48.0, 7, 15)
SEEDS = (0, 1, 2)
SMALL = FieldKnobs(
    extent_m=400.0, farms=6.0, wood_share=0.06, hedge_share=0.1, trees_per_hectare=4.0, stand_occupancy=0.02,
    bystanders=12.0,
)  # fmt: skip


@cache
def build(seed):
    return build_field(SMALL, SEASON, stream(seed, "field"))


@cache
def grounds_of(seed):
    """The plan of a world: it is the second child of its generator."""
    return lay_out_grounds(SMALL, stream(seed, "field").spawn(2)[1])


@pytest.fixture(scope="module", params=SEEDS)
def seed(request):
    return request.param


@pytest.fixture(scope="module")
def world(seed):
    return build(seed)


def test_arrays_are_sound(world):
    check_arrays(world)


def test_size_and_classes(world):
    assert 200_000 < len(world.mesh.faces) <= 1_300_000
    assert 30_000 < len(world.sites.area) <= 150_000
    present = {Semantic(k) for k in np.unique(world.face_semantic)}
    assert len(present) >= 18
    assert {
        Semantic.GOAL,
        Semantic.STAND,
        Semantic.FENCE,
        Semantic.WIRE,
        Semantic.POLE,
        Semantic.TREE,
    } <= present
    counts = dict(world.counts)
    assert 1 <= counts["pitches"] <= 3
    assert counts["stands"] >= 1
    assert counts["people"] > 5 and counts["cars"] > 3
    check_palette(world)
    reach = np.abs(world.mesh.vertices[:, :2]).max()
    assert 1500.0 < reach < 3000.0


def test_movers_have_places_and_ids_of_their_own(world):
    assert len(world.movers) >= 20
    ids = [m.object for m in world.movers]
    assert len(set(ids)) == len(ids)
    assert not set(ids) & set(world.face_object.tolist())
    assert {"player"} <= {m.kind for m in world.movers}
    assert max(int(m.body.surface.max()) for m in world.movers) < len(world.palette)


def test_a_vertical_line_meets_the_ground_once_or_something_built(world):
    assert normals(world, np.isin(world.face_semantic, GROUND))[:, 2].min() > -1e-3
    xy = np.random.default_rng(7).uniform(-190.0, 190.0, (3000, 2))
    xy[:500] *= 10.0
    check_one_ground(world, xy, Semantic.ROOF, Semantic.WALL, Semantic.STAND, Semantic.WINDOW)


def test_pitches_have_the_size_of_the_laws_and_lie_level(world, seed):
    for pitch in grounds_of(seed).pitches:
        assert 100.0 <= pitch.length_m <= 110.0
        assert 64.0 <= pitch.width_m <= 75.0
        ground = np.isin(world.face_semantic, [Semantic.GRASS, Semantic.SPORTS_SURFACE, Semantic.SOIL])
        points = corners(world, ground).reshape(-1, 3)
        inside = np.abs(pitch.frame.local(points[:, :2])) <= [pitch.length_m / 2, pitch.width_m / 2]
        assert inside.all(axis=1).sum() > 2000
        assert np.ptp(points[inside.all(axis=1), 2]) < 0.02


def test_pitches_differ_from_their_lines_and_know_their_turf(world, seed):
    for pitch in grounds_of(seed).pitches:
        middle = corners(world).mean(axis=1)
        local = pitch.frame.local(middle[:, :2])
        spot = (np.abs(local - [0.25 * pitch.length_m, 0.2 * pitch.width_m]).max(axis=1) < 6.0) & np.isin(
            world.face_semantic, GROUND
        )
        names = {world.palette[k].material.name for k in np.unique(world.face_surface[spot])}
        assert ("artificial_turf" in names) == pitch.artificial


def test_goals_have_the_right_size(world, seed):
    """7.32 m between the posts and 2.44 m below the bar, measured on the mesh."""
    pitches = grounds_of(seed).pitches
    goals = things(world, Semantic.GOAL)
    assert len(goals) == 2 * len(pitches)
    for goal in goals:
        middle = goal[:, :2].mean(axis=0)
        pitch = min(pitches, key=lambda p: np.hypot(p.frame.x_m - middle[0], p.frame.y_m - middle[1]))
        local = pitch.frame.local(goal[:, :2])
        line = np.abs(np.abs(local[:, 0]) - (pitch.length_m / 2 - LINE_M / 2)) < LINE_M / 2 + 0.005
        z = goal[:, 2] - world.ground.at(middle[None])[0]
        posts = line & (z < 0.05) & (np.abs(np.abs(local[:, 1]) - GOAL_WIDTH_M / 2) < 0.2)
        inner = 2 * np.abs(local[posts, 1]).min()
        assert inner == pytest.approx(GOAL_WIDTH_M, abs=0.02)
        across = np.ptp(local[:, 1].reshape(-1, 3), axis=1) > 7.0
        bar = across & line.reshape(-1, 3).all(axis=1) & (z.reshape(-1, 3).min(axis=1) > 2.0)
        assert z.reshape(-1, 3)[bar].min() == pytest.approx(GOAL_HEIGHT_M, abs=0.02)


@pytest.mark.parametrize("kind", [Semantic.CAR, Semantic.LARGE_VEHICLE, Semantic.PERSON])
def test_what_stands_touches_the_ground_and_nothing_else_of_its_kind(world, kind):
    found = things(world, kind)
    if kind is Semantic.PERSON:  # those on seats stand on the stand
        seats = corners(world, world.face_semantic == Semantic.STAND)[..., :2]
        stand = shapely.union_all(shapely.convex_hull(shapely.polygons(seats))).buffer(0.3)
        found = [g for g in found if not stand.contains(shapely.Point(g[:, :2].mean(axis=0)))]
    low = feet(found)
    height = low[:, 2] - world.ground.at(low[:, :2])
    assert (height > -0.15).all() and (height < 0.3).all()
    hulls = plans(found)
    assert shapely.STRtree(hulls).query(hulls, predicate="overlaps").shape[1] == 0


def test_masts_and_poles_are_rooted(world):
    high = [g for g in things(world, Semantic.POLE) if np.ptp(g[:, 2]) > 7.0]
    near = [g for g in high if np.abs(g[:, :2]).max() < 190.0]
    stands = [g for g in near if np.ptp(g[:, :2], axis=0).max() > 20.0]
    low = feet([g for g in near if np.ptp(g[:, :2], axis=0).max() <= 20.0])
    assert len(low) + len(stands) >= 4
    sunk = low[:, 2] - world.ground.at(low[:, :2])
    assert (sunk < -0.05).all() and (sunk > -2.2).all()


def test_nets_are_strands_not_sheets(world):
    net = world.face_semantic == Semantic.GOAL
    assert np.median(areas(world, net)) < 0.01
    assert net.sum() > 4000


def test_the_same_seed_gives_the_same_bytes():
    check_same_bytes(build(0), build.__wrapped__(0))


def test_two_seeds_are_two_grounds():
    xy = np.random.default_rng(5).uniform(-190.0, 190.0, (6000, 2))
    hits = []
    for seed in SEEDS[:2]:
        shapes = [s.outline() for s in grounds_of(seed).stands] + [
            p.turf.outline() for p in grounds_of(seed).pitches
        ]
        hits.append(shapely.contains_xy(shapely.union_all(shapes), xy))
    check_apart(*hits)
    one, two = (build(k).mesh.vertices[:, 2] for k in SEEDS[:2])
    assert abs(np.quantile(one, 0.9) - np.quantile(two, 0.9)) > 0.1


def test_knobs_are_honoured():
    knobs = FieldKnobs(
        extent_m=380.0, pitches=1.0, track_share=1.0, artificial_share=1.0, stand_rows=5.0, relief_m=0.0,
        hills_m=0.0, pylon_share=0.0, pond_share=0.0, floodlight_share=0.0, farms=0.0, wood_share=0.0,
        hedge_share=0.0, flight_ceiling_m=80,
    )  # fmt: skip
    world = build_field(knobs, SEASON, stream(4, "field"))
    counts = dict(world.counts)
    assert counts["pitches"] == 1
    assert counts["buildings"] == 4
    assert Semantic.WATER not in world.face_semantic
    assert world.flight_box_m[1] == (178.0, 178.0, 80.0)
    assert np.ptp(world.ground.height_m) < 1e-6
    turf = {s.material.name for s in world.palette if s.material.name == "artificial_turf"}
    assert turf
    with pytest.raises(ValueError, match="outside"):
        FieldKnobs(pitches=(0.0, 9.0))
