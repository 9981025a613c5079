"""The neighborhood: small worlds hold every invariant; one seed gives the same bytes, two seeds two places."""

from __future__ import annotations

from functools import cache

import numpy as np
import pytest
import shapely

from scenegen.classes import Semantic
from scenegen.climate.season import Season
from scenegen.foundation.rng import stream
from scenegen.maps.neighborhood.knobs import NeighborhoodKnobs
from scenegen.maps.neighborhood.neighborhood import build_neighborhood
from scenegen.movers.company import Company
from worlds import (
    GROUND,
    check_apart,
    check_arrays,
    check_one_ground,
    check_palette,
    check_same_bytes,
    corners,
    feet,
    ground_below,
    normals,
    plans,
    things,
    under,
)

SEEDS = (0, 1, 2)
SMALL = NeighborhoodKnobs(extent_m=(220.0, 235.0), pool_share=0.3, moving_cars_per_km=9.0)
WALLS = [Semantic.WALL, Semantic.WINDOW, Semantic.DOOR]


@cache
def build(seed):
    return build_neighborhood(SMALL, Season(40.0, 7, 15), stream(seed, "neighborhood"))


@pytest.fixture(scope="module", params=SEEDS)
def world(request):
    return build(request.param)


def test_arrays_are_sound(world):
    check_arrays(world)


def test_what_is_there(world):
    present = set(np.unique(world.face_semantic).tolist())
    wanted = {
        Semantic.ROAD, Semantic.SIDEWALK, Semantic.ROAD_MARKING, Semantic.GRASS, Semantic.WATER, Semantic.WALL,
        Semantic.ROOF, Semantic.WINDOW, Semantic.DOOR, Semantic.TREE, Semantic.SHRUB, Semantic.CAR, Semantic.POLE,
        Semantic.FENCE, Semantic.STREET_FURNITURE,
    }  # fmt: skip
    assert wanted <= present
    counts = dict(world.counts)
    assert counts["houses"] > 0.7 * counts["lots"] > 15
    assert counts["trees"] > 60
    check_palette(world)
    reach = np.abs(world.mesh.vertices[:, :2]).max()
    assert reach > 2000.0


def test_a_vertical_line_meets_the_ground_once_or_a_house(world):
    xy = np.random.default_rng(7).uniform(-130.0, 130.0, (2500, 2))
    xy[:400] *= 10.0
    check_one_ground(world, xy, *WALLS, Semantic.ROOF)


def test_houses_stand_in_the_ground_and_apart(world):
    houses = [g for g in things(world, *WALLS) if np.abs(g[:, :2]).max() < 190.0]
    below = plans(houses)
    assert len(below) > 20
    for plan, foot in zip(below, feet(houses)[:, 2], strict=True):
        rim = shapely.get_coordinates(shapely.segmentize(plan.exterior.buffer(0.1).exterior, 2.0))
        ground = world.ground.at(rim)
        assert foot < ground.min() + 0.12 - 0.1
        assert np.ptp(ground) < 2.5
    a, b = shapely.STRtree(below).query(below, predicate="intersects")
    shared = shapely.area(shapely.intersection(below[a], below[b]))[a < b]
    assert (shared < 0.5).all()  # hulls of L plans may touch a shed's corner


def test_walls_reach_the_ground_around_them(world):
    """Just outside every wall the ground lies above the wall's foot and below its windows."""
    panes = corners(world, world.face_semantic == Semantic.WINDOW)
    outward = normals(world, world.face_semantic == Semantic.WINDOW)
    upright = np.abs(outward[:, 2]) < 0.01
    spot = panes[upright].mean(axis=1) + 0.6 * outward[upright]
    point, height = ground_below(world, spot[:, :2])
    sill = panes[upright][point].min(axis=(1, 2)), panes[upright][point][..., 2].min(axis=1)
    assert (height < sill[1] + 0.05).mean() > 0.995


def test_trees_keep_clear_of_houses(world):
    low, high = (np.array(corner)[:2] for corner in world.flight_box_m)
    trees = [g for g in things(world, Semantic.TREE) if (g[:, :2] > low).all() and (g[:, :2] < high).all()]
    assert len(trees) > 30
    trunk = feet(trees)
    assert (np.abs(trunk[:, 2] - world.ground.at(trunk[:, :2])) < 0.9).all()
    houses = shapely.STRtree(plans(things(world, Semantic.ROOF)))
    assert houses.query(shapely.points(trunk[:, :2]), predicate="dwithin", distance=0.3).shape[1] == 0
    walls = np.isin(world.face_semantic, WALLS)
    solid = shapely.STRtree(shapely.linestrings(corners(world, walls)[..., :2]))
    assert solid.query(plans(trees), predicate="intersects").shape[1] == 0


def test_wires_end_on_poles_or_masts(world):
    wires = things(world, Semantic.WIRE)
    assert wires, "the share of streets with poles is at least two fifths"
    posts = corners(world, world.face_semantic == Semantic.POLE)
    middle, half = (posts.max(axis=1) + posts.min(axis=1)) / 2, (posts.max(axis=1) - posts.min(axis=1)) / 2
    for wire in wires:
        axis = np.argmax(np.ptp(wire[:, :2], axis=0))
        for end in (wire[np.argmin(wire[:, axis])], wire[np.argmax(wire[:, axis])]):
            gap = np.linalg.norm(np.maximum(np.abs(end - middle) - half, 0.0), axis=1).min()
            assert gap < 0.25


def test_pools_lie_level_below_their_coping(world):
    water = world.face_semantic == Semantic.WATER
    pools = np.unique(world.face_object[water])
    upward = normals(world)[:, 2] > 0.5
    for pool in pools:
        mine = water & (world.face_object == pool) & upward
        points = corners(world, mine)
        assert np.ptp(points[..., 2]) < 1e-4
        rim = world.ground.at(points[..., :2].reshape(-1, 2)) + 0.12
        assert (rim - points[0, 0, 2] > 0.02).all()
        assert (rim - points[0, 0, 2] < 0.45).all()


def test_cars_stand_on_the_ground_and_touch_nothing(world):
    cars = things(world, Semantic.CAR, Semantic.LARGE_VEHICLE)
    below = plans(cars)
    assert shapely.STRtree(below).query(below, predicate="overlaps").shape[1] == 0
    low = feet(cars)
    height = low[:, 2] - world.ground.at(low[:, :2])
    assert height.min() > -0.15
    assert height.max() < 0.40


def covered_by_movers(world, times):
    """Rectangles (times, movers) that movers cover, and their heights above the ground."""
    company = Company.of(world.movers)
    low, high = company.box[:, 0], company.box[:, 1]
    corner = np.stack(
        [np.where([i, j], high[:, :2], low[:, :2]) for i, j in ((0, 0), (1, 0), (1, 1), (0, 1))]
    )
    poses = company.poses_over(times)
    xy = np.einsum("tmij,kmj->tmki", poses[..., :2, :2], corner) + poses[..., None, :2, 3]
    return xy, poses[..., 2, 3]


def test_movers_keep_to_their_ways_and_to_themselves(world):
    """Cars on the carriageway, people off it, and none in another or in anything that stands."""
    drives = np.array([m.kind != "person" for m in world.movers])
    assert drives.sum() >= 1
    assert (~drives).sum() >= 2
    road = np.isin(world.face_semantic, [Semantic.ROAD, Semantic.ROAD_MARKING])
    pieces = shapely.polygons(corners(world, road)[..., :2])
    owner = world.face_object[road]
    wide = np.bincount(owner, shapely.area(pieces)) > 600.0  # no driveway
    pieces = pieces[wide[owner] | (world.face_semantic[road] == Semantic.ROAD_MARKING)]
    street = shapely.union_all(pieces, grid_size=0.001).buffer(0.15)
    tall = ~np.isin(world.face_semantic, GROUND)
    points = corners(world, tall).reshape(-1, 3)
    height = points[:, 2] - world.ground.at(points[:, :2])
    plant = np.repeat(world.face_semantic[tall] == Semantic.TREE, 3)
    low, high = np.where(plant, -0.2, 0.35), np.where(plant, 0.35, 1.4)  # twigs may hang over a sidewalk
    things = shapely.STRtree(shapely.points(points[(height > low) & (height < high), :2]))
    for xy, z in zip(*covered_by_movers(world, np.linspace(0.0, 1100.0, 23)), strict=True):
        rectangles = shapely.polygons(xy)
        a, b = shapely.STRtree(rectangles).query(rectangles, predicate="intersects")
        assert (a == b).all()
        assert street.contains(rectangles[drives]).all()
        assert not street.buffer(-0.5).intersects(rectangles[~drives]).any()
        above = z - world.ground.at(xy.mean(axis=1))
        assert (above > -0.2).all()
        assert (above < 0.3).all()
        assert things.query(rectangles, predicate="contains").shape[1] == 0


def test_the_same_seed_gives_the_same_bytes():
    check_same_bytes(build(0), build.__wrapped__(0))


def test_two_seeds_are_two_places():
    xy = np.random.default_rng(5).uniform(-100.0, 100.0, (5000, 2))
    check_apart(*(under(build(seed), xy, Semantic.ROOF) for seed in SEEDS[:2]))


def test_a_whole_world_keeps_its_budgets():
    world = build_neighborhood(NeighborhoodKnobs(), Season(45.0, 6, 1), stream(4, "neighborhood"))
    assert 1_000_000 < len(world.mesh.faces) <= 1_600_000
    assert 100_000 < len(world.sites.area) <= 260_000
    assert len(np.unique(world.face_semantic)) >= 18
    low, high = (np.array(corner) for corner in world.flight_box_m)
    assert (high[:2] - low[:2] > 250.0).all()


def test_knobs_are_honoured():
    knobs = NeighborhoodKnobs(
        extent_m=220.0, relief_m=0.0, driveway_cars=0.0, parked_cars_per_100_m=0.0, moving_cars_per_km=0.0,
        pool_share=0.0, people_per_100_lots=0.0, walkers_per_100_m=0.0, pole_share=0.0, hedge_share=0.0,
        fence_share=0.0, flight_ceiling_m=60,
    )  # fmt: skip
    world = build_neighborhood(knobs, Season(40.0, 7, 15), stream(0, "neighborhood"))
    counts = dict(world.counts)
    assert [
        counts[k] for k in ("cars", "pools", "people who stand", "utility poles", "fences", "hedges")
    ] == [0] * 6
    assert world.movers == ()
    assert np.ptp(world.ground.height_m) < 1e-6
    assert world.flight_box_m[1][2] == 60.0
    with pytest.raises(ValueError, match="outside"):
        NeighborhoodKnobs(extent_m=(100.0, 5000.0))
