"""The coastline: three worlds hold every invariant; one seed gives the same bytes, two seeds two coasts."""

from __future__ import annotations

from functools import cache

import numpy as np
import pytest
import shapely
from scipy.spatial import cKDTree

from scenegen.classes import Semantic
from scenegen.climate.sea import sea_surface_K
from scenegen.climate.season import Season
from scenegen.foundation.rng import stream
from scenegen.maps.coastline.coastline import build_coastline
from scenegen.maps.coastline.knobs import CoastlineKnobs
from worlds import areas, check_arrays, check_palette, check_same_bytes, corners, feet, normals, plans, things

SEASON = Season(40.0, 7, 15)
SEEDS = (0, 1, 2)
SMALL = CoastlineKnobs(extent_m=440.0, pier_length_m=60.0, breakwater_length_m=80.0)
SOLID = [
    Semantic.ROAD, Semantic.SIDEWALK, Semantic.ROAD_MARKING, Semantic.SOIL, Semantic.GRASS, Semantic.SAND,
]  # fmt: skip


@cache
def build(seed):
    return build_coastline(SMALL, SEASON, stream(seed, "coast"))


@pytest.fixture(scope="module", params=SEEDS)
def world(request):
    return build(request.param)


def inner(world, xy):
    return np.abs(xy).max(axis=1) < world.flight_box_m[1][0]


def test_arrays_are_sound(world):
    check_arrays(world, smallest_face_m2=1e-7)


def test_budget_classes_and_palette(world):
    assert 300_000 < len(world.mesh.faces) <= 1_300_000
    assert 20_000 < len(world.sites.area) <= 150_000
    present = {Semantic(int(k)) for k in np.unique(world.face_semantic)}
    assert len(present) >= 18
    assert {
        Semantic.SAND,
        Semantic.ROCK,
        Semantic.WATER,
        Semantic.PIER,
        Semantic.BOAT,
        Semantic.PERSON,
    } <= present
    check_palette(world)
    counts = dict(world.counts)
    assert counts["houses"] >= 1 and counts["rocks"] >= 10 and counts["people"] >= 10 and counts["cars"] >= 4


def test_land_and_sea_leave_no_gap(world):
    reach = world.flight_box_m[1][0]
    xy = (
        np.random.default_rng(3).uniform(-1.0, 1.0, (3000, 2))
        * np.where(np.arange(3000) % 4 == 0, 6000.0, reach)[:, None]
    )
    known = np.isin(
        world.face_semantic,
        [*SOLID, Semantic.ROCK, Semantic.BARRIER, Semantic.WATER, Semantic.ROOF, Semantic.WALL],
    )
    tree = shapely.STRtree(shapely.polygons(corners(world, known)[..., :2]))
    met = np.zeros(len(xy), bool)
    met[tree.query(shapely.points(xy), predicate="intersects")[0]] = True
    assert met.all()


def test_the_horizon_is_far(world):
    water = corners(world, world.face_semantic == Semantic.WATER)
    assert np.abs(water[..., :2]).max() == pytest.approx(9000.0)
    assert np.linalg.norm(corners(world)[..., :2], axis=2).max() > 9000.0


def test_solid_ground_agrees_with_its_height_field(world):
    ground = np.isin(world.face_semantic, SOLID)
    middle = corners(world, ground).mean(axis=1)
    near = inner(world, middle[:, :2]) & (middle[:, 2] > 0.0)
    error = middle[near, 2] - world.ground.at(middle[near, :2])
    assert np.median(np.abs(error)) < 0.06
    assert np.quantile(np.abs(error), 0.99) < 1.0
    assert world.ground.height_m.min() == 0.0
    assert world.ground.height_m.max() > 8.0


def test_cliffs_are_steep_and_hold_sites(world):
    rock = world.face_semantic == Semantic.ROCK
    largest = np.argmax(np.bincount(world.face_object[rock]))
    face = rock & (world.face_object == largest)
    area, steep = areas(world, face), normals(world, face)[:, 2] < 0.6
    assert area[steep].sum() > 300.0
    sites = np.unique(world.corner_site[face][steep])
    assert len(sites) > area[steep].sum() / 8.0


def test_water_is_one_prescribed_temperature_and_waves_are_small_at_the_shore(world):
    water = world.face_semantic == Semantic.WATER
    surfaces = {int(k) for k in np.unique(world.face_surface[water])}
    assert len(surfaces) == 1
    skin = world.palette[surfaces.pop()]
    assert skin.material.name == "water_fresh_or_sea"
    assert abs(skin.prescribed_K - sea_surface_K(SEASON)) < 3.0
    assert len(np.unique(world.corner_site[water])) < 1500
    z = corners(world, water)[..., 2]
    near = inner(world, corners(world, water)[..., :2].mean(axis=1))
    assert abs(z.mean()) < 0.1 and 0.05 < z[near].max() < 2.5 and z.max() < 6.0
    assert (normals(world, water)[:, 2] > 0.5).all()


@pytest.mark.parametrize(
    "semantic", [Semantic.CAR, Semantic.LARGE_VEHICLE, Semantic.PERSON, Semantic.BOAT, Semantic.ROCK]
)
def test_things_do_not_overlap(world, semantic):
    found = things(world, semantic)
    assert len(found) >= (semantic != Semantic.LARGE_VEHICLE)
    below = plans([g for g in found if np.ptp(g[:, :2], axis=0).max() < 40.0])
    assert shapely.STRtree(below).query(below, predicate="overlaps").shape[1] == 0


@pytest.mark.parametrize("semantic", [Semantic.CAR, Semantic.POLE, Semantic.PERSON])
def test_things_stand_on_the_ground(world, semantic):
    low = feet(things(world, semantic))
    low = low[inner(world, low[:, :2])]
    built = shapely.union_all(plans(things(world, Semantic.PIER, Semantic.WALL)))  # decks and towers
    raised = shapely.dwithin(shapely.points(low[:, :2]), built, 0.3)
    height = (low[:, 2] - world.ground.at(low[:, :2]))[~raised]
    assert len(height) >= 3
    assert height.max() < 0.12
    assert height.min() > -0.7


def test_boats_float_or_lie_on_the_sand(world):
    boats = things(world, Semantic.BOAT)
    middle = np.array([g[:, :2].mean(axis=0) for g in boats])
    low, ground = feet(boats)[:, 2], world.ground.at(middle)
    afloat = ground < 0.02
    assert afloat.sum() >= 3
    sea = world.mesh.vertices[np.unique(world.mesh.faces[world.face_semantic == Semantic.WATER])].astype(
        np.float64
    )
    surface = sea[cKDTree(sea[:, :2]).query(middle[afloat])[1], 2]
    draught = surface - low[afloat]
    assert (draught > 0.05).all() and (draught < 2.6).all()
    assert (np.abs(low[~afloat] - ground[~afloat]) < 0.4).all()


def test_rocks_are_rooted_and_none_hangs_in_the_air(world):
    rocks = [g for g in things(world, Semantic.ROCK) if np.ptp(g[:, :2], axis=0).max() < 40.0]
    low = feet(rocks)
    ground = world.ground.at(low[:, :2])
    assert (low[:, 2] < ground + 0.05).all()
    assert all(g[:, 2].max() > -0.3 for g in rocks)


def test_nothing_grows_in_the_sea(world):
    for semantic in (Semantic.TREE, Semantic.SHRUB):
        low = feet(things(world, semantic))
        low = low[inner(world, low[:, :2])]
        assert len(low) >= 10
        assert (world.ground.at(low[:, :2]) > 0.6).all()


def test_movers_keep_to_road_sand_deck_and_sea(world):
    assert len(world.movers) >= 3
    for mover in world.movers:
        place = mover.route.rows[:, :3]
        near = inner(world, place[:, :2])
        ground = world.ground.at(place[near, :2])
        if mover.kind == "boat":
            assert (ground == 0.0).all()
        elif mover.kind != "person":
            assert np.abs(place[near, 2] - ground).max() < 0.25


def test_the_same_seed_gives_the_same_bytes():
    check_same_bytes(build(0), build.__wrapped__(0))


def test_two_seeds_are_two_coasts():
    one, two = (build(seed).ground for seed in SEEDS[:2])
    xy = np.random.default_rng(5).uniform(-200.0, 200.0, (6000, 2))
    land = [g.at(xy) > 0.0 for g in (one, two)]
    assert min(share.mean() for share in land) > 0.15
    assert (land[0] & land[1]).sum() < 0.75 * (land[0] | land[1]).sum()
    assert np.abs(one.at(xy) - two.at(xy)).mean() > 2.0


def test_knobs_are_honoured():
    none = dict.fromkeys(
        ("boats", "people", "houses", "huts", "cars", "sailing_per_km", "traffic_per_100_m"), 0.0
    )
    flat = dict.fromkeys(("cliff_share", "dune_height_m", "relief_m"), 0.0)
    knobs = CoastlineKnobs(extent_m=440.0, flight_ceiling_m=80.0, **none, **flat)
    world = build_coastline(knobs, SEASON, stream(0, "coast"))
    counts = dict(world.counts)
    assert all(counts[name] == 0 for name in ("boats", "houses", "huts", "cars"))
    assert world.flight_box_m[1][2] == 80.0
    assert world.ground.height_m.max() < 12.0
    with pytest.raises(ValueError, match="outside"):
        CoastlineKnobs(cliff_height_m=(100.0, 200.0))
