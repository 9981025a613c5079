"""The coastline: three worlds hold every invariant; one seed gives the same bytes, two seeds two coasts."""

from __future__ import annotations

from functools import cache

import numpy as np
import pytest
import shapely
from scipy.spatial import cKDTree

from scenegen.classes import Semantic
from scenegen.climate.sea import FREEZING_K, SKIN_K, sea_surface_K
from scenegen.climate.season import Season
from scenegen.foundation.rng import stream
from scenegen.geometry.part import face_areas, face_normals
from scenegen.maps.coastline.coastline import build_coastline
from scenegen.maps.coastline.knobs import CoastlineKnobs
from scenegen.maps.coastline.waves import draw_waves, jonswap, peak_frequency

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


def arrays(world):
    sites = world.sites
    moving = [a for m in world.movers for a in (m.body.vertices, m.body.faces, m.route.rows)]
    return [
        world.mesh.vertices, world.mesh.faces, world.face_surface, world.face_semantic, world.face_object,
        world.corner_site, sites.position, sites.normal, sites.area, sites.surface, sites.object,
        sites.standoff, world.ground.height_m, *moving,
    ]  # fmt: skip


def corners(world, mask):
    return world.mesh.vertices[world.mesh.faces[mask]].astype(np.float64)


def things(world, semantic):
    """Points and convex plan of every object of a class."""
    mask = world.face_semantic == semantic
    owner = world.face_object[mask]
    if not len(owner):
        return [], np.zeros(0, dtype=object)
    order = np.argsort(owner, kind="stable")
    start = np.flatnonzero(np.concatenate([[True], np.diff(owner[order]) > 0]))
    groups = np.split(corners(world, mask)[order].reshape(-1, 3), 3 * start[1:])
    return groups, np.array([shapely.MultiPoint(g[:, :2]).convex_hull for g in groups], dtype=object)


def feet(groups):
    return np.array([g[np.argmin(g[:, 2])] for g in groups])


def inner(world, xy):
    return np.abs(xy).max(axis=1) < world.flight_box_m[1][0]


def test_arrays_are_sound(world):
    for array in arrays(world):
        assert np.isfinite(array.astype(np.float64)).all()
    faces = world.mesh.faces.astype(np.int64)
    assert faces.max() == len(world.mesh.vertices) - 1
    assert world.corner_site.max() == len(world.sites.area) - 1
    assert np.abs(world.mesh.vertices).max() < 1e4
    assert face_areas(world.mesh.vertices.astype(np.float64), faces).min() > 1e-7
    assert np.linalg.norm(world.sites.normal, axis=1) == pytest.approx(1.0, abs=1e-5)
    assert world.face_object.min() >= 1
    assert (world.sites.area > 0).all()
    assert (world.sites.surface[world.corner_site] == world.face_surface[:, None]).all()
    assert (world.sites.object[world.corner_site] == world.face_object[:, None]).all()


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
    names = [s.material.name for s in world.palette]
    assert max(names.count(n) for n in names) <= 4
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
    assert np.linalg.norm(corners(world, slice(None))[..., :2], axis=2).max() > 9000.0


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
    normals, area = face_normals(
        world.mesh.vertices.astype(np.float64), world.mesh.faces[face].astype(np.int64)
    )
    steep = normals[:, 2] < 0.6
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
    assert (
        face_normals(world.mesh.vertices.astype(np.float64), world.mesh.faces[water].astype(np.int64))[0][
            :, 2
        ]
        > 0.5
    ).all()


@pytest.mark.parametrize(
    "semantic", [Semantic.CAR, Semantic.LARGE_VEHICLE, Semantic.PERSON, Semantic.BOAT, Semantic.ROCK]
)
def test_things_do_not_overlap(world, semantic):
    groups, plans = things(world, semantic)
    assert len(groups) >= (semantic != Semantic.LARGE_VEHICLE)
    keep = np.array([np.ptp(g[:, :2], axis=0).max() < 40.0 for g in groups], bool)
    plans = plans[keep]
    assert shapely.STRtree(plans).query(plans, predicate="overlaps").shape[1] == 0


@pytest.mark.parametrize("semantic", [Semantic.CAR, Semantic.POLE, Semantic.PERSON])
def test_things_stand_on_the_ground(world, semantic):
    groups, _ = things(world, semantic)
    low = feet(groups)
    low = low[inner(world, low[:, :2])]
    on_deck = shapely.dwithin(
        shapely.points(low[:, :2]), shapely.union_all(things(world, Semantic.PIER)[1]), 0.3
    )
    on_tower = shapely.dwithin(
        shapely.points(low[:, :2]), shapely.union_all(things(world, Semantic.WALL)[1]), 0.3
    )
    height = (low[:, 2] - world.ground.at(low[:, :2]))[~on_deck & ~on_tower]
    assert len(height) >= 3
    assert height.max() < 0.12
    assert height.min() > -0.7


def test_boats_float_or_lie_on_the_sand(world):
    groups, _ = things(world, Semantic.BOAT)
    middle = np.array([g[:, :2].mean(axis=0) for g in groups])
    low, ground = np.array([g[:, 2].min() for g in groups]), world.ground.at(middle)
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
    groups, _ = things(world, Semantic.ROCK)
    rocks = [g for g in groups if np.ptp(g[:, :2], axis=0).max() < 40.0]
    low = feet(rocks)
    ground = world.ground.at(low[:, :2])
    assert (low[:, 2] < ground + 0.05).all()
    assert all(g[:, 2].max() > -0.3 for g in rocks)


def test_nothing_grows_in_the_sea(world):
    for semantic in (Semantic.TREE, Semantic.SHRUB):
        groups, _ = things(world, semantic)
        low = feet(groups)
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
    first, second = build(0), build.__wrapped__(0)
    for a, b in zip(arrays(first), arrays(second), strict=True):
        assert a.tobytes() == b.tobytes()
    assert repr(first.palette) == repr(second.palette)
    assert first.counts == second.counts


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


def test_the_sea_is_warm_in_the_tropics_cold_at_the_poles_and_late():
    tropics, pole = sea_surface_K(Season(5.0, 8, 25)), sea_surface_K(Season(85.0, 2, 20))
    assert 299.0 < tropics < 303.0
    assert pole == pytest.approx(FREEZING_K + SKIN_K, abs=0.01)
    year = [sea_surface_K(Season.from_day_of_year(45.0, d)) for d in range(1, 366)]
    assert abs(int(np.argmax(year)) + 1 - 237) <= 1
    assert max(year) - min(year) == pytest.approx(9.8, abs=0.5)
    assert sea_surface_K(Season(-45.0, 2, 24)) > sea_surface_K(Season(-45.0, 8, 25))


def test_jonswap_grows_with_fetch_and_becomes_a_full_sea():
    omega = np.linspace(0.2, 12.0, 60_000)
    step = omega[1] - omega[0]
    height = [4.0 * np.sqrt(jonswap(omega, 10.0, f).sum() * step) for f in (5e3, 20e3, 80e3)]
    # Hasselmann et al.: Hs = 0.0016 U sqrt(x / g) while the sea grows; their fits of alpha and of the peak, which
    # make the spectrum, give a third more at long fetches.
    expected = [0.0016 * 10.0 * np.sqrt(f / 9.81) for f in (5e3, 20e3, 80e3)]
    assert height == pytest.approx(expected, rel=0.33)
    assert omega[np.argmax(jonswap(omega, 10.0, 20e3))] == pytest.approx(peak_frequency(10.0, 20e3), rel=0.01)
    assert peak_frequency(3.0, 500e3) == pytest.approx(0.855 * 9.81 / 3.0)


def test_drawn_waves_carry_the_energy_of_their_spectrum():
    waves = draw_waves(8.0, 50e3, 0.0, 0.3, np.random.default_rng(0))
    omega = np.linspace(0.2, 12.0, 60_000)
    wanted = 4.0 * np.sqrt(jonswap(omega, 8.0, 50e3).sum() * (omega[1] - omega[0]))
    assert waves.significant_m == pytest.approx(wanted, rel=0.06)
    xy = np.random.default_rng(1).uniform(-2000.0, 2000.0, (20_000, 2))
    assert 4.0 * waves.elevation(xy, np.full(len(xy), 0.01)).std() == pytest.approx(
        waves.significant_m, rel=0.05
    )
    smooth = waves.elevation(xy, np.full(len(xy), 200.0))
    assert np.abs(smooth).max() == 0.0
