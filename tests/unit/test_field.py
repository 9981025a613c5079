"""The field: three small worlds hold every invariant; one seed gives the same bytes, two seeds two grounds."""

from __future__ import annotations

from functools import cache

import numpy as np
import pytest
import shapely

from scenegen.classes import Semantic
from scenegen.climate.season import Season
from scenegen.foundation.rng import stream
from scenegen.geometry.part import face_areas, face_normals
from scenegen.maps.field.field import build_field
from scenegen.maps.field.frame import Frame, Plot
from scenegen.maps.field.grounds import lay_out_grounds
from scenegen.maps.field.knobs import FieldKnobs
from scenegen.maps.field.pitch import GOAL_HEIGHT_M, GOAL_WIDTH_M, LINE_M, line_quads
from scenegen.maps.field.relief import draw_land, level
from scenegen.maps.field.track import LANE_M, RADIUS_M, STRAIGHT_M, fits_inside, oval

SEASON = Season(48.0, 7, 15)
SEEDS = (0, 1, 2)
SMALL = FieldKnobs(
    extent_m=400.0, farms=6.0, wood_share=0.06, hedge_share=0.1, trees_per_hectare=4.0, stand_occupancy=0.02,
    bystanders=12.0,
)  # fmt: skip
GROUND = [
    Semantic.ROAD, Semantic.SIDEWALK, Semantic.ROAD_MARKING, Semantic.SOIL, Semantic.GRASS, Semantic.WATER,
    Semantic.SPORTS_SURFACE,
]  # fmt: skip


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


def arrays(world):
    sites = world.sites
    return [
        world.mesh.vertices, world.mesh.faces, world.face_surface, world.face_semantic, world.face_object,
        world.corner_site, sites.position, sites.normal, sites.area, sites.surface, sites.object,
        sites.standoff, world.ground.height_m,
    ]  # fmt: skip


def corners(world, mask):
    return world.mesh.vertices[world.mesh.faces[mask]].astype(np.float64)


def groups(world, semantics):
    """Corner points of each object of some classes, by id."""
    mask = np.isin(world.face_semantic, semantics)
    owner = world.face_object[mask]
    order = np.argsort(owner, kind="stable")
    start = np.flatnonzero(np.diff(owner[order])) + 1
    return np.split(corners(world, mask)[order].reshape(-1, 3), start * 3)


def plans(found):
    return np.array([shapely.MultiPoint(g[:, :2]).convex_hull for g in found], dtype=object)


def test_arrays_are_sound(world):
    for array in arrays(world):
        assert np.isfinite(array.astype(np.float64)).all()
    faces = world.mesh.faces.astype(np.int64)
    assert faces.max() == len(world.mesh.vertices) - 1
    assert world.corner_site.max() == len(world.sites.area) - 1
    assert face_areas(world.mesh.vertices.astype(np.float64), faces).min() > 1e-8
    assert np.linalg.norm(world.sites.normal, axis=1) == pytest.approx(1.0, abs=1e-5)
    assert world.face_surface.max() < len(world.palette)
    assert world.face_object.min() >= 1
    assert (world.sites.area > 0).all()


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
    names = [s.material.name for s in world.palette]
    assert max(names.count(n) for n in names) <= 4
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
    normals, _ = face_normals(world.mesh.vertices.astype(np.float64), world.mesh.faces.astype(np.int64))
    flat = np.isin(world.face_semantic, GROUND) & (normals[:, 2] > 0.3)
    assert normals[np.isin(world.face_semantic, GROUND), 2].min() > -1e-3
    xy = np.random.default_rng(7).uniform(-190.0, 190.0, (3000, 2))
    xy[:500] *= 10.0
    tree = shapely.STRtree(shapely.polygons(corners(world, flat)[..., :2]))
    layers = np.bincount(tree.query(shapely.points(xy), predicate="intersects")[0], minlength=len(xy))
    assert layers.max() == 1
    built = np.isin(world.face_semantic, [Semantic.ROOF, Semantic.WALL, Semantic.STAND, Semantic.WINDOW])
    cover = shapely.STRtree(shapely.polygons(corners(world, built)[..., :2]))
    bare = shapely.points(xy[layers == 0])
    covered = np.unique(cover.query(bare, predicate="dwithin", distance=0.03)[0])
    assert len(covered) == len(bare)


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
        middle = corners(world, slice(None)).mean(axis=1)
        local = pitch.frame.local(middle[:, :2])
        spot = (np.abs(local - [0.25 * pitch.length_m, 0.2 * pitch.width_m]).max(axis=1) < 6.0) & np.isin(
            world.face_semantic, GROUND
        )
        names = {world.palette[k].material.name for k in np.unique(world.face_surface[spot])}
        assert ("artificial_turf" in names) == pitch.artificial


def test_goals_have_the_right_size(world, seed):
    """7.32 m between the posts and 2.44 m below the bar, measured on the mesh."""
    pitches = grounds_of(seed).pitches
    goals = groups(world, [Semantic.GOAL])
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
    found = groups(world, [kind])
    if kind is Semantic.PERSON:  # those on seats stand on the stand
        seats = corners(world, world.face_semantic == Semantic.STAND)[..., :2]
        stand = shapely.union_all(shapely.convex_hull(shapely.polygons(seats))).buffer(0.3)
        found = [g for g in found if not stand.contains(shapely.Point(g[:, :2].mean(axis=0)))]
    low = np.array([g[np.argmin(g[:, 2])] for g in found]).reshape(-1, 3)
    height = low[:, 2] - world.ground.at(low[:, :2])
    assert (height > -0.15).all() and (height < 0.3).all()
    hulls = plans(found)
    assert shapely.STRtree(hulls).query(hulls, predicate="overlaps").shape[1] == 0


def test_masts_and_poles_are_rooted(world):
    high = [g for g in groups(world, [Semantic.POLE]) if np.ptp(g[:, 2]) > 7.0]
    near = [g for g in high if np.abs(g[:, :2]).max() < 190.0]
    stands = [g for g in near if np.ptp(g[:, :2], axis=0).max() > 20.0]
    feet = np.array([g[np.argmin(g[:, 2])] for g in near if np.ptp(g[:, :2], axis=0).max() <= 20.0])
    assert len(feet) + len(stands) >= 4
    sunk = feet[:, 2] - world.ground.at(feet[:, :2])
    assert (sunk < -0.05).all() and (sunk > -2.2).all()


def test_nets_are_strands_not_sheets(world):
    net = np.isin(world.face_semantic, [Semantic.GOAL])
    area = face_areas(world.mesh.vertices.astype(np.float64), world.mesh.faces[net].astype(np.int64))
    assert np.median(area) < 0.01
    assert net.sum() > 4000


def test_the_same_seed_gives_the_same_bytes():
    first, second = build(0), build.__wrapped__(0)
    for a, b in zip(arrays(first), arrays(second), strict=True):
        assert a.tobytes() == b.tobytes()
    assert repr(first.palette) == repr(second.palette)
    assert first.counts == second.counts
    for one, other in zip(first.movers, second.movers, strict=True):
        assert one.body.vertices.tobytes() == other.body.vertices.tobytes()
        assert one.route.rows.tobytes() == other.route.rows.tobytes()


def test_two_seeds_are_two_grounds():
    xy = np.random.default_rng(5).uniform(-190.0, 190.0, (6000, 2))
    hits = []
    for seed in SEEDS[:2]:
        shapes = [s.outline() for s in grounds_of(seed).stands] + [
            p.turf.outline() for p in grounds_of(seed).pitches
        ]
        hits.append(shapely.contains_xy(shapely.union_all(shapes), xy))
    assert min(h.mean() for h in hits) > 0.04
    assert (hits[0] & hits[1]).sum() < 0.5 * (hits[0] | hits[1]).sum()
    one, two = (build(k).mesh.vertices[:, 2] for k in SEEDS[:2])
    assert abs(np.quantile(one, 0.9) - np.quantile(two, 0.9)) > 0.1


def test_lines_follow_the_laws():
    quads = line_quads(105.0, 68.0)
    painted = shapely.union_all(shapely.polygons(quads))
    assert painted.bounds == pytest.approx((-52.5, -34.0, 52.5, 34.0))
    straight = 2 * 105.0 + 3 * 68.0 - 6 * LINE_M
    boxes = 2 * (2 * 16.5 + 40.32 + 2 * 5.5 + 18.32) - 8 * LINE_M
    arcs = 2 * np.pi * (9.15 - LINE_M / 2) + 4 * np.arccos(5.5 / 9.15) * (9.15 - LINE_M / 2)
    spots = 2 * 0.22**2
    # Lines that end on others overlap them by less than half a square metre in all.
    assert painted.area == pytest.approx((straight + boxes + arcs) * LINE_M + spots, abs=0.7)
    for x, y in (
        (52.5 - 16.5 + 0.06, 0.0),
        (52.5 - 5.5 + 0.06, 0.0),
        (9.09, 0.0),
        (0.0, 0.0),
        (52.5 - 11.0, 0.0),
    ):
        assert painted.contains(shapely.Point(x, y))


def test_the_track_measures_400_m():
    """World Athletics measures 0.30 m outside the kerb of the first lane."""
    ring = shapely.LinearRing(oval(RADIUS_M + 0.30))
    assert ring.length == pytest.approx(400.0, abs=0.3)
    assert ring.length == pytest.approx(2 * STRAIGHT_M + 2 * np.pi * 36.8, abs=0.3)
    assert shapely.LinearRing(oval(RADIUS_M + 8 * LANE_M)).is_ccw
    assert fits_inside(100.0, 64.0)
    assert not fits_inside(110.0, 72.0)


def test_platforms_are_level_and_joined_smoothly():
    rng = np.random.default_rng(3)
    land = draw_land(3.0, 40.0, rng)
    plots = (Plot(Frame(0.0, 0.0, 0.3), 50.0, 30.0), Plot(Frame(90.0, 75.0, 0.3), 40.0, 30.0))
    relief = level(land, plots)
    for plot, height in zip(plots, relief.level_m, strict=True):
        inside = plot.frame.world(rng.uniform(-1.0, 1.0, (500, 2)) * [plot.half_x_m, plot.half_y_m])
        assert relief(inside) == pytest.approx(height, abs=1e-4)
        assert height == pytest.approx(land(inside).mean(), abs=0.8)
    away = np.array([[400.0, -300.0], [-220.0, 10.0]])
    assert relief(away) == pytest.approx(land(away))
    walk = np.column_stack([np.linspace(-120.0, 220.0, 4000), np.linspace(-60.0, 140.0, 4000)])
    step = np.linalg.norm(walk[1] - walk[0])
    assert np.abs(np.diff(relief(walk))).max() < 1.0 * step


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
