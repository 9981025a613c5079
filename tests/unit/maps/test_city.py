"""The city: three worlds hold every invariant; one seed gives the same bytes, two seeds two cities."""

from __future__ import annotations

from functools import cache

import numpy as np
import pytest
import shapely

from scenegen.classes import Semantic
from scenegen.climate.climatology import normals as climate_normals
from scenegen.climate.season import Season
from scenegen.foundation.errors import InputError
from scenegen.foundation.rng import stream
from scenegen.maps.city.knobs import CityKnobs
from scenegen.maps.registry import MAPS, build_world, map_family
from scenegen.materials.material import Build
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
    ground_below,
    normals,
    plans,
    things,
    under,
)

SEASON = Season(40.0, 7, 15)

SEEDS = (0, 1, 2)
ROOMS = (Build.WALL_INSULATED, Build.WINDOW, Build.ROOF_INSULATED)


@cache
def build(seed):
    return build_world("city", CityKnobs(), SEASON, stream(seed, "city"))


@pytest.fixture(scope="module", params=SEEDS)
def world(request):
    return build(request.param)


def test_arrays_are_sound(world):
    check_arrays(world)


def test_sites_are_near_their_faces(world):
    near = np.linalg.norm(world.sites.position[world.corner_site] - corners(world), axis=2)
    detailed = np.abs(corners(world)[..., :2]).max(axis=(1, 2)) < 330.0
    area = areas(world, detailed)
    far = (
        near[detailed].max(axis=1) > 6.0
    )  # narrow ones may be: the reveals of many windows share their sites
    assert area[far].sum() < 0.05 * area.sum()


def test_size(world):
    assert 100_000 < len(world.sites.area) <= 250_000
    assert 1_000_000 <= len(world.mesh.faces) <= 1_600_000
    counts = dict(world.counts)
    assert counts["buildings"] >= 200
    assert counts["trees"] >= 300
    assert counts["vehicles that stand"] >= 200
    assert counts["parks"] >= 1
    low, high = (np.array(corner) for corner in world.flight_box_m)
    assert (high[:2] - low[:2] > 400.0).all()
    assert high[2] == 120.0


def test_classes_and_palette(world):
    present = np.unique(world.face_semantic)
    assert len(present) >= 12
    assert Semantic.SKY not in present
    check_palette(world)
    rooms_K = np.array([s.interior_K for s in world.palette if s.material.build in ROOMS])
    heated = (rooms_K >= 292.0) & (rooms_K <= 297.0)
    assert heated.sum() > 10
    assert rooms_K[~heated] == pytest.approx(climate_normals(SEASON).expected_C + 275.15)
    assert (~heated).sum() > 1


def test_every_building_is_one_instance_with_walls_roof_and_windows(world):
    walls = np.unique(world.face_object[world.face_semantic == Semantic.WALL])
    roofs = np.unique(world.face_object[world.face_semantic == Semantic.ROOF])
    windows = np.unique(world.face_object[world.face_semantic == Semantic.WINDOW])
    assert set(roofs) <= set(walls)
    assert len(windows) >= dict(world.counts)["buildings"] * 0.95


def test_a_vertical_line_meets_the_ground_once_or_a_building(world):
    xy = np.random.default_rng(7).uniform(-320.0, 320.0, (4000, 2))
    xy[:500] *= 7.0
    check_one_ground(world, xy, Semantic.ROOF, Semantic.WALL, Semantic.ROOF_EQUIPMENT, Semantic.WINDOW)


def test_ground_edges_are_shared_by_two_faces_or_meet_a_wall(world):
    ground = np.isin(world.face_semantic, GROUND)
    position = np.rint(world.mesh.vertices.astype(np.float64) * 1e3).astype(np.int64)
    _, merged = np.unique(position, axis=0, return_inverse=True)
    index = world.mesh.faces[ground][:, [0, 1, 1, 2, 2, 0]].reshape(-1, 2)
    edges = np.sort(merged.ravel()[index], axis=1)
    _, first, count = np.unique(edges, axis=0, return_index=True, return_counts=True)
    assert (count > 2).sum() == 0
    rim = world.mesh.vertices[index[first[count == 1]]].mean(axis=1).astype(np.float64)
    inner = np.abs(rim[:, :2]).max(axis=1) < 2500.0
    walls = np.isin(world.face_semantic, [Semantic.WALL, Semantic.DOOR])
    segments = shapely.linestrings(corners(world, walls)[..., :2])
    near = np.unique(
        shapely.STRtree(segments).query(shapely.points(rim[inner, :2]), predicate="dwithin", distance=0.03)[0]
    )
    assert len(near) == inner.sum()


def layers_below(world, xy):
    """How many ground faces a vertical line meets at each point."""
    return np.bincount(ground_below(world, xy)[0], minlength=len(xy))


def test_undersides_of_roofs_hang_over_the_ground_outside(world):
    roof = np.unique(world.corner_site[world.face_semantic == Semantic.ROOF])
    detailed = np.abs(world.sites.position[roof, :2]).max(axis=1) < 330.0
    below = roof[detailed & (world.sites.normal[roof, 2] < -0.5)]
    assert len(below) > 100
    assert (layers_below(world, world.sites.position[below, :2].astype(np.float64)) == 1).all()


def test_cars_stand_on_the_ground_and_touch_nothing(world):
    cars = things(world, Semantic.CAR)
    below = plans(cars)
    assert shapely.STRtree(below).query(below, predicate="overlaps").shape[1] == 0
    low = feet(cars)
    height = low[:, 2] - world.ground.at(low[:, :2])
    assert height.min() > -0.08
    assert height.max() < 0.30
    walls = corners(world, world.face_semantic == Semantic.WALL)
    low_walls = walls[walls[..., 2].min(axis=1) < world.ground.at(walls.mean(axis=1)[:, :2]) + 1.5]
    lines = shapely.STRtree(shapely.linestrings(low_walls[..., :2]))
    assert lines.query(below, predicate="intersects").shape[1] == 0


def test_trunks_stand_in_open_ground(world):
    trunk = feet(things(world, Semantic.TREE))
    trunk = trunk[np.abs(trunk[:, :2]).max(axis=1) < 300.0]
    assert len(trunk) > 200
    assert (np.abs(trunk[:, 2] - world.ground.at(trunk[:, :2])) < 0.7).all()
    assert (layers_below(world, trunk[:, :2]) == 1).all()


def test_ground_faces_look_up_and_walls_keep_their_sites_side(world):
    assert normals(world, np.isin(world.face_semantic, GROUND))[:, 2].min() > -1e-3
    glass = world.face_semantic == Semantic.WINDOW
    mine = world.sites.normal[world.corner_site[glass][:, 0]]
    assert np.einsum("ij,ij->i", normals(world, glass), mine).min() > 0.99


def test_a_railway_crosses_the_city_above_its_streets(world):
    bridge = corners(world, np.isin(world.face_semantic, [Semantic.BRIDGE, Semantic.BARRIER]))
    middle = bridge.mean(axis=1)
    inside = np.abs(middle[:, :2]).max(axis=1) < 330.0
    above = middle[inside, 2] - world.ground.at(middle[inside, :2])
    assert above.max() > 8.0
    deck = bridge[inside][bridge[inside, :, 2].min(axis=1) - world.ground.at(middle[inside, :2]) > 4.9]
    plan = shapely.union_all(shapely.buffer(shapely.polygons(deck[..., :2]), 0.05))
    assert plan.area > 8.0 * 500.0
    posts = bridge[inside][above < 4.0]
    assert len(posts) > 14 * 10
    blocks = corners(world, world.face_semantic == Semantic.SIDEWALK)[..., :2]
    on_sidewalk = shapely.STRtree(shapely.polygons(blocks)).query(
        shapely.points(posts.mean(axis=1)[:, :2]), predicate="within"
    )
    assert on_sidewalk.shape[1] == 0


def test_wires_hang_above_what_drives_below_them(world):
    wires = corners(world, world.face_semantic == Semantic.WIRE).reshape(-1, 3)
    wires = wires[np.abs(wires[:, :2]).max(axis=1) < 330.0]
    assert len(wires) > 1000
    assert (wires[:, 2] - world.ground.at(wires[:, :2])).min() > 4.5


def test_some_rooms_are_unheated_and_some_air_handlers_run(world):
    skins = world.palette
    glass = np.unique(world.face_surface[world.face_semantic == Semantic.WINDOW])
    rooms_K = {skins[k].interior_K for k in glass if skins[k].material.name == "window_glass"}
    assert max(rooms_K) - min(rooms_K) > 1.0
    gear = np.unique(world.face_surface[world.face_semantic == Semantic.ROOF_EQUIPMENT])
    assert max(skins[k].interior_K for k in gear if np.isfinite(skins[k].interior_K)) > 303.0


def test_the_same_seed_gives_the_same_bytes():
    check_same_bytes(build(0), build.__wrapped__(0))


def test_two_seeds_are_two_cities():
    xy = np.random.default_rng(5).uniform(-300.0, 300.0, (6000, 2))
    check_apart(*(under(build(seed), xy, Semantic.ROOF) for seed in SEEDS[:2]))


def test_knobs_are_honoured():
    knobs = CityKnobs(
        parked_cars_per_100_m=0.0,
        moving_cars_per_100_m=0.0,
        extent_m=420.0,
        relief_m=0.0,
        flight_ceiling_m=80,
    )
    world = build_world("city", knobs, SEASON, stream(0, "city"))
    assert dict(world.counts)["vehicles that stand"] < 0.4 * dict(build(0).counts)["vehicles that stand"]
    assert world.flight_box_m[1][0] < 250.0
    assert world.flight_box_m[1][2] == 80.0
    assert np.ptp(world.ground.height_m) == 0.0


def test_registry():
    assert "city" in MAPS
    assert map_family("city").knobs is CityKnobs
    with pytest.raises(InputError, match="perhaps you meant 'city'"):
        map_family("citty")
    with pytest.raises(ValueError, match="outside"):
        CityKnobs(extent_m=(100.0, 5000.0))
