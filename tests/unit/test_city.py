"""The city: three worlds hold every invariant; one seed gives the same bytes, two seeds two cities."""

from __future__ import annotations

from functools import cache

import numpy as np
import pytest
import shapely

from scenegen.classes import Semantic
from scenegen.climate.climatology import normals
from scenegen.climate.season import Season
from scenegen.foundation.errors import InputError
from scenegen.foundation.rng import stream
from scenegen.geometry.part import face_areas, face_normals
from scenegen.maps.city.knobs import CityKnobs
from scenegen.maps.registry import MAPS, build_world, map_family
from scenegen.materials.material import Build

SEASON = Season(40.0, 7, 15)

SEEDS = (0, 1, 2)
ROOMS = (Build.WALL_INSULATED, Build.WINDOW, Build.ROOF_INSULATED)
GROUND = [
    Semantic.ROAD, Semantic.SIDEWALK, Semantic.ROAD_MARKING, Semantic.SOIL, Semantic.GRASS, Semantic.WATER,
]  # fmt: skip


@cache
def build(seed):
    return build_world("city", CityKnobs(), SEASON, stream(seed, "city"))


@pytest.fixture(scope="module", params=SEEDS)
def world(request):
    return build(request.param)


def arrays(world):
    sites = world.sites
    return [
        world.mesh.vertices, world.mesh.faces, world.face_surface, world.face_semantic, world.face_object,
        world.corner_site, sites.position, sites.normal, sites.area, sites.surface, sites.object,
        sites.standoff, world.ground.height_m,
    ]  # fmt: skip


def corners(world, mask):
    return world.mesh.vertices[world.mesh.faces[mask]].astype(np.float64)


def test_arrays_are_sound(world):
    for array in arrays(world):
        assert np.isfinite(array.astype(np.float64)).all()
    faces = world.mesh.faces.astype(np.int64)
    assert faces.max() == len(world.mesh.vertices) - 1
    assert world.corner_site.max() == len(world.sites.area) - 1
    assert np.abs(world.mesh.vertices).max() < 1e4
    assert face_areas(world.mesh.vertices.astype(np.float64), faces).min() > 1e-8
    assert np.linalg.norm(world.sites.normal, axis=1) == pytest.approx(1.0, abs=1e-5)
    assert world.face_surface.max() < len(world.palette)
    assert world.face_object.min() >= 1
    assert (world.sites.area > 0).all()


def test_sites_agree_with_their_faces(world):
    surface = world.sites.surface[world.corner_site]
    owner = world.sites.object[world.corner_site]
    assert (surface == world.face_surface[:, None]).all()
    assert (owner == world.face_object[:, None]).all()
    near = np.linalg.norm(world.sites.position[world.corner_site] - corners(world, slice(None)), axis=2)
    detailed = np.abs(corners(world, slice(None))[..., :2]).max(axis=(1, 2)) < 330.0
    area = face_areas(world.mesh.vertices.astype(np.float64), world.mesh.faces.astype(np.int64))[detailed]
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
    names = [s.material.name for s in world.palette]
    assert max(names.count(n) for n in names) <= 4
    assert set(np.unique(world.face_surface)) <= set(range(len(world.palette)))
    for surface in world.palette:
        low, high = surface.material.emissivity_range
        assert low <= surface.emissivity <= high
    rooms_K = np.array([s.interior_K for s in world.palette if s.material.build in ROOMS])
    heated = (rooms_K >= 292.0) & (rooms_K <= 297.0)
    assert heated.sum() > 10
    assert rooms_K[~heated] == pytest.approx(normals(SEASON).expected_C + 275.15)
    assert (~heated).sum() > 1


def test_every_building_is_one_instance_with_walls_roof_and_windows(world):
    walls = np.unique(world.face_object[world.face_semantic == Semantic.WALL])
    roofs = np.unique(world.face_object[world.face_semantic == Semantic.ROOF])
    windows = np.unique(world.face_object[world.face_semantic == Semantic.WINDOW])
    assert set(roofs) <= set(walls)
    assert len(windows) >= dict(world.counts)["buildings"] * 0.95


def ground_under(world, xy):
    """How many ground faces a vertical line meets at each point (an independent point-in-triangle count)."""
    normals, _ = face_normals(world.mesh.vertices.astype(np.float64), world.mesh.faces.astype(np.int64))
    flat = np.isin(world.face_semantic, GROUND) & (normals[:, 2] > 0.3)
    tree = shapely.STRtree(shapely.polygons(corners(world, flat)[..., :2]))
    point, _ = tree.query(shapely.points(xy), predicate="intersects")
    return np.bincount(point, minlength=len(xy))


def test_a_vertical_line_meets_the_ground_once_or_a_building(world):
    xy = np.random.default_rng(7).uniform(-320.0, 320.0, (4000, 2))
    xy[:500] *= 7.0
    layers = ground_under(world, xy)
    assert layers.max() == 1
    roofs = np.isin(
        world.face_semantic, [Semantic.ROOF, Semantic.WALL, Semantic.ROOF_EQUIPMENT, Semantic.WINDOW]
    )
    tree = shapely.STRtree(shapely.polygons(corners(world, roofs)[..., :2]))
    open_points = np.flatnonzero(layers == 0)
    covered = np.unique(tree.query(shapely.points(xy[open_points]), predicate="dwithin", distance=0.02)[0])
    assert len(covered) == len(open_points)


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


def footprint(world, semantics):
    """Convex plan of each object of some classes."""
    mask = np.isin(world.face_semantic, semantics)
    owner = world.face_object[mask]
    order = np.argsort(owner, kind="stable")
    points = corners(world, mask)[order].reshape(-1, 3)
    start = np.flatnonzero(np.concatenate([[True], np.diff(owner[order]) > 0])) * 3
    groups = np.split(points, start[1:])
    return groups, np.array([shapely.MultiPoint(g[:, :2]).convex_hull for g in groups], dtype=object)


def test_undersides_of_roofs_hang_over_the_ground_outside(world):
    roof = np.unique(world.corner_site[world.face_semantic == Semantic.ROOF])
    detailed = np.abs(world.sites.position[roof, :2]).max(axis=1) < 330.0
    below = roof[detailed & (world.sites.normal[roof, 2] < -0.5)]
    assert len(below) > 100
    assert (ground_under(world, world.sites.position[below, :2].astype(np.float64)) == 1).all()


def test_cars_stand_on_the_ground_and_touch_nothing(world):
    groups, plans = footprint(world, [Semantic.CAR])
    pairs = shapely.STRtree(plans).query(plans, predicate="overlaps")
    assert pairs.shape[1] == 0
    low = np.array([g[np.argmin(g[:, 2])] for g in groups])
    height = low[:, 2] - world.ground.at(low[:, :2])
    assert height.min() > -0.08
    assert height.max() < 0.30
    walls = corners(world, world.face_semantic == Semantic.WALL)
    low_walls = walls[walls[..., 2].min(axis=1) < world.ground.at(walls.mean(axis=1)[:, :2]) + 1.5]
    lines = shapely.STRtree(shapely.linestrings(low_walls[..., :2]))
    assert lines.query(plans, predicate="intersects").shape[1] == 0


def test_trunks_stand_in_open_ground(world):
    groups, _ = footprint(world, [Semantic.TREE])
    feet = np.array([g[np.argmin(g[:, 2])] for g in groups])
    feet = feet[np.abs(feet[:, :2]).max(axis=1) < 300.0]
    assert len(feet) > 200
    assert (np.abs(feet[:, 2] - world.ground.at(feet[:, :2])) < 0.7).all()
    assert (ground_under(world, feet[:, :2]) == 1).all()


def test_ground_faces_look_up_and_walls_keep_their_sites_side(world):
    normals, _ = face_normals(world.mesh.vertices.astype(np.float64), world.mesh.faces.astype(np.int64))
    ground = np.isin(world.face_semantic, GROUND)
    assert normals[ground, 2].min() > -1e-3
    glass = world.face_semantic == Semantic.WINDOW
    mine = world.sites.normal[world.corner_site[glass][:, 0]]
    assert np.einsum("ij,ij->i", normals[glass], mine).min() > 0.99


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
    first, second = build(0), build.__wrapped__(0)
    for a, b in zip(arrays(first), arrays(second), strict=True):
        assert a.tobytes() == b.tobytes()
    assert repr(first.palette) == repr(second.palette)
    assert first.counts == second.counts


def test_two_seeds_are_two_cities():
    xy = np.random.default_rng(5).uniform(-300.0, 300.0, (6000, 2))
    built = []
    for seed in SEEDS[:2]:
        world = build(seed)
        tree = shapely.STRtree(
            shapely.polygons(corners(world, world.face_semantic == Semantic.ROOF)[..., :2])
        )
        built.append(np.isin(np.arange(len(xy)), tree.query(shapely.points(xy), predicate="within")[0]))
    assert min(b.mean() for b in built) > 0.05
    assert (built[0] & built[1]).sum() < 0.5 * (built[0] | built[1]).sum()


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
