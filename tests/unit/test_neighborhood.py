"""The neighborhood: small worlds hold every invariant; one seed gives the same bytes, two seeds two places."""

from __future__ import annotations

from functools import cache

import numpy as np
import pytest
import shapely

from scenegen.buildings.detached.body import Body, End, Home, Role, Top, outline
from scenegen.buildings.detached.draw import Traits, draw_bodies, draw_home_style
from scenegen.buildings.detached.roofs import home_roofs
from scenegen.buildings.detached.walls import home_walls
from scenegen.buildings.lots import Lot
from scenegen.classes import Semantic
from scenegen.climate.season import Season
from scenegen.foundation.rng import stream
from scenegen.geometry.part import concatenate, face_areas, face_normals
from scenegen.geometry.relief import draw_relief
from scenegen.maps.neighborhood.grading import grade
from scenegen.maps.neighborhood.knobs import NeighborhoodKnobs
from scenegen.maps.neighborhood.lots import divide
from scenegen.maps.neighborhood.neighborhood import build_neighborhood
from scenegen.maps.neighborhood.streets import draw_streets
from scenegen.maps.neighborhood.warp import Warp
from scenegen.materials.palette import PaletteBuilder
from scenegen.movers.company import Company

SEEDS = (0, 1, 2)
SMALL = NeighborhoodKnobs(extent_m=(220.0, 235.0), pool_share=0.3, moving_cars_per_km=9.0)
GROUND = [
    Semantic.ROAD, Semantic.SIDEWALK, Semantic.ROAD_MARKING, Semantic.SOIL, Semantic.GRASS, Semantic.WATER,
]  # fmt: skip
WALLS = [Semantic.WALL, Semantic.WINDOW, Semantic.DOOR]


@cache
def build(seed):
    return build_neighborhood(SMALL, Season(40.0, 7, 15), stream(seed, "neighborhood"))


@cache
def streets(seed, curvature=0.9):
    return draw_streets(420.0, 33.0, curvature, 0.4, stream(seed, "streets"))


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


def objects(world, semantics):
    """Vertices of each object of some classes, and its id."""
    mask = np.isin(world.face_semantic, semantics)
    owner = world.face_object[mask]
    order = np.argsort(owner, kind="stable")
    points = corners(world, mask)[order].reshape(-1, 3)
    start = np.flatnonzero(np.concatenate([[True], np.diff(owner[order]) > 0])) * 3
    return np.split(points, start[1:]), owner[order][start // 3]


def hulls(groups):
    return np.array([shapely.MultiPoint(g[:, :2]).convex_hull for g in groups], dtype=object)


def ground_below(world, xy):
    """Heights of all ground faces that vertical lines meet, and the point of each (plain plane equations)."""
    flat = np.isin(world.face_semantic, GROUND)
    normals, _ = face_normals(world.mesh.vertices.astype(np.float64), world.mesh.faces.astype(np.int64))
    flat &= normals[:, 2] > 0.3
    triangles, normal = corners(world, flat), normals[flat]
    tree = shapely.STRtree(shapely.polygons(triangles[..., :2]))
    point, face = tree.query(shapely.points(xy), predicate="intersects")
    a, n = triangles[face, 0], normal[face]
    return point, a[:, 2] - ((xy[point] - a[:, :2]) * n[:, :2]).sum(axis=1) / n[:, 2]


def test_arrays_are_sound(world):
    for array in arrays(world):
        assert np.isfinite(array.astype(np.float64)).all()
    faces = world.mesh.faces.astype(np.int64)
    assert faces.max() == len(world.mesh.vertices) - 1
    assert face_areas(world.mesh.vertices.astype(np.float64), faces).min() > 1e-8
    assert np.linalg.norm(world.sites.normal, axis=1) == pytest.approx(1.0, abs=1e-5)
    assert world.face_object.min() >= 1
    assert (world.sites.area > 0).all()
    assert (world.sites.surface[world.corner_site] == world.face_surface[:, None]).all()
    assert (world.sites.object[world.corner_site] == world.face_object[:, None]).all()


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
    names = [s.material.name for s in world.palette]
    assert max(names.count(n) for n in names) <= 4
    reach = np.abs(world.mesh.vertices[:, :2]).max()
    assert reach > 2000.0


def test_a_vertical_line_meets_the_ground_once_or_a_house(world):
    xy = np.random.default_rng(7).uniform(-130.0, 130.0, (2500, 2))
    xy[:400] *= 10.0
    point, _ = ground_below(world, xy)
    layers = np.bincount(point, minlength=len(xy))
    assert layers.max() == 1
    built = np.isin(world.face_semantic, [*WALLS, Semantic.ROOF])
    tree = shapely.STRtree(shapely.polygons(corners(world, built)[..., :2]))
    bare = np.flatnonzero(layers == 0)
    covered = np.unique(tree.query(shapely.points(xy[bare]), predicate="dwithin", distance=0.03)[0])
    assert len(covered) == len(bare)


def test_houses_stand_in_the_ground_and_apart(world):
    groups, _ = objects(world, WALLS)
    groups = [g for g in groups if np.abs(g[:, :2]).max() < 190.0]
    low = np.array([g[:, 2].min() for g in groups])
    plans = hulls(groups)
    assert len(plans) > 20
    for plan, foot in zip(plans, low, strict=True):
        rim = shapely.get_coordinates(shapely.segmentize(plan.exterior.buffer(0.1).exterior, 2.0))
        ground = world.ground.at(rim)
        assert foot < ground.min() + 0.12 - 0.1
        assert np.ptp(ground) < 2.5
    a, b = shapely.STRtree(plans).query(plans, predicate="intersects")
    shared = shapely.area(shapely.intersection(plans[a], plans[b]))[a < b]
    assert (shared < 0.5).all()  # hulls of L plans may touch a shed's corner


def test_walls_reach_the_ground_around_them(world):
    """Just outside every wall the ground lies above the wall's foot and below its windows."""
    panes = corners(world, world.face_semantic == Semantic.WINDOW)
    normals, _ = face_normals(world.mesh.vertices.astype(np.float64), world.mesh.faces.astype(np.int64))
    outward = normals[world.face_semantic == Semantic.WINDOW]
    upright = np.abs(outward[:, 2]) < 0.01
    spot = panes[upright].mean(axis=1) + 0.6 * outward[upright]
    point, height = ground_below(world, spot[:, :2])
    sill = panes[upright][point].min(axis=(1, 2)), panes[upright][point][..., 2].min(axis=1)
    assert (height < sill[1] + 0.05).mean() > 0.995


def test_trees_keep_clear_of_houses(world):
    groups, _ = objects(world, [Semantic.TREE])
    low, high = (np.array(corner)[:2] for corner in world.flight_box_m)
    trees = [g for g in groups if (g[:, :2] > low).all() and (g[:, :2] < high).all()]
    assert len(trees) > 30
    feet = np.array([g[np.argmin(g[:, 2])] for g in trees])
    assert (np.abs(feet[:, 2] - world.ground.at(feet[:, :2])) < 0.9).all()
    houses = shapely.STRtree(hulls(objects(world, [Semantic.ROOF])[0]))
    assert houses.query(shapely.points(feet[:, :2]), predicate="dwithin", distance=0.3).shape[1] == 0
    walls = np.isin(world.face_semantic, WALLS)
    solid = shapely.STRtree(shapely.linestrings(corners(world, walls)[..., :2]))
    assert solid.query(hulls(trees), predicate="intersects").shape[1] == 0


def test_wires_end_on_poles_or_masts(world):
    groups, _ = objects(world, [Semantic.WIRE])
    if not groups:
        pytest.fail("a neighborhood without wires: the share of poles is at least a half")
    posts = corners(world, world.face_semantic == Semantic.POLE)
    middle, half = (posts.max(axis=1) + posts.min(axis=1)) / 2, (posts.max(axis=1) - posts.min(axis=1)) / 2
    for wire in groups:
        axis = np.argmax(np.ptp(wire[:, :2], axis=0))
        for end in (wire[np.argmin(wire[:, axis])], wire[np.argmax(wire[:, axis])]):
            gap = np.linalg.norm(np.maximum(np.abs(end - middle) - half, 0.0), axis=1).min()
            assert gap < 0.25


def test_pools_lie_level_below_their_coping(world):
    water = world.face_semantic == Semantic.WATER
    pools = np.unique(world.face_object[water])
    normals, _ = face_normals(world.mesh.vertices.astype(np.float64), world.mesh.faces.astype(np.int64))
    for pool in pools:
        mine = water & (world.face_object == pool) & (normals[:, 2] > 0.5)
        points = corners(world, mine)
        assert np.ptp(points[..., 2]) < 1e-4
        rim = world.ground.at(points[..., :2].reshape(-1, 2)) + 0.12
        assert (rim - points[0, 0, 2] > 0.02).all()
        assert (rim - points[0, 0, 2] < 0.45).all()


def test_cars_stand_on_the_ground_and_touch_nothing(world):
    groups, _ = objects(world, [Semantic.CAR, Semantic.LARGE_VEHICLE])
    plans = hulls(groups)
    assert shapely.STRtree(plans).query(plans, predicate="overlaps").shape[1] == 0
    low = np.array([g[np.argmin(g[:, 2])] for g in groups])
    height = low[:, 2] - world.ground.at(low[:, :2])
    assert height.min() > -0.15
    assert height.max() < 0.40


def plans(world, times):
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
    for xy, z in zip(*plans(world, np.linspace(0.0, 1100.0, 23)), strict=True):
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
    first, second = build(0), build.__wrapped__(0)
    for a, b in zip(arrays(first), arrays(second), strict=True):
        assert a.tobytes() == b.tobytes()
    assert repr(first.palette) == repr(second.palette)
    assert first.counts == second.counts


def test_two_seeds_are_two_places():
    xy = np.random.default_rng(5).uniform(-100.0, 100.0, (5000, 2))
    built = []
    for seed in SEEDS[:2]:
        world = build(seed)
        tree = shapely.STRtree(
            shapely.polygons(corners(world, world.face_semantic == Semantic.ROOF)[..., :2])
        )
        built.append(np.isin(np.arange(len(xy)), tree.query(shapely.points(xy), predicate="within")[0]))
    assert min(b.mean() for b in built) > 0.05
    assert (built[0] & built[1]).sum() < 0.5 * (built[0] | built[1]).sum()


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


@pytest.mark.parametrize("seed", range(6))
def test_streets_are_one_network_that_winds(seed):
    plan = streets(seed)
    lines = shapely.union_all([shapely.LineString(line) for line in plan.lines], grid_size=0.01)
    assert lines.buffer(0.05).geom_type == "Polygon"
    assert plan.carriageway.is_valid
    assert plan.front.contains(plan.carriageway)
    assert any(a or b for a, b in plan.dead_end)
    headings = np.concatenate([np.arctan2(*np.diff(line, axis=0).T[::-1]) for line in plan.lines])
    main = 0.25 * np.angle(np.exp(4j * headings).mean())
    off = np.abs((headings - main + np.pi / 4) % (np.pi / 2) - np.pi / 4)
    assert np.quantile(off, 0.9) > 0.15  # no grid


def test_the_warp_keeps_areas():
    warp = Warp.draw(1.2, 500.0, stream(1, "warp"))
    xy = np.random.default_rng(3).uniform(-250.0, 250.0, (500, 2))
    step = 1e-3
    east, north = (warp(xy + step * e) - warp(xy - step * e) for e in np.eye(2))
    area = (east[:, 0] * north[:, 1] - east[:, 1] * north[:, 0]) / (2 * step) ** 2
    assert area == pytest.approx(1.0, abs=1e-5)


@pytest.mark.parametrize("seed", range(3))
def test_lots_share_the_blocks_without_overlap(seed):
    plan = streets(seed)
    division = divide(plan, 22.0, 33.0, stream(seed, "lots"))
    areas = np.array([lot.area for lot in division.lots], dtype=object)
    assert len(areas) > 80
    assert shapely.area(shapely.union_all(areas)) == pytest.approx(shapely.area(areas).sum(), rel=1e-4)
    assert shapely.area(shapely.intersection(shapely.union_all(areas), plan.front)) < 1.0
    assert (shapely.distance(areas, plan.front) < 0.01).all()
    for lot in division.lots:
        spot = lot.world(np.array([[lot.frontage_m / 2, 5.0]]))[0]
        assert lot.area.distance(shapely.Point(spot)) < 3.0


def test_grading_levels_pads_and_leaves_streets():
    relief = draw_relief(stream(0, "relief"), 5.0, (240.0, 900.0))
    pad = shapely.box(10.0, 10.0, 22.0, 20.0)
    street = shapely.box(-50.0, -5.0, 50.0, 5.0)
    graded = grade(relief, [pad], street, 60.0)
    inside = np.random.default_rng(0).uniform((10.0, 10.0), (22.0, 20.0), (50, 2))
    on_street = np.random.default_rng(1).uniform((-40.0, -4.0), (40.0, 4.0), (50, 2))
    assert np.ptp(relief(inside)) > 10 * np.ptp(graded(inside))
    assert graded(on_street) == pytest.approx(relief(on_street), abs=1e-5)
    assert graded.sample(50.0, 2.0).at(inside) == pytest.approx(graded(inside), abs=0.02)


def house(bodies, seed=0):
    palette = PaletteBuilder(stream(seed, "palette"))
    style = draw_home_style(Traits(False, 1, False, 0.3), 0, palette, stream(seed, "style"))
    lot = Lot(shapely.box(-50, -50, 50, 50), np.zeros(2), 0.0, 100.0)
    none = np.zeros((0, 3))
    return Home(1, style, bodies, lot, 0.0, 0.5, none, none)


def volume(vertices, faces):
    a, b, c = (vertices[faces[:, k]] for k in range(3))
    return float(np.einsum("ij,ij->i", a, np.cross(b, c)).sum() / 6)


def test_a_cross_gable_covers_its_plan_once():
    """Seen from above, main roof and wing roof meet in valleys: no hole and no second layer inside the walls."""
    main = Body(-6.0, 6.0, 0.0, 9.0, 2.8, 1, Role.HOUSE, Top.RIDGED, slope=0.7)
    wing = Body(
        -5.0, 0.0, -3.0, 0.0, 2.8, 1, Role.HOUSE, Top.RIDGED, True, slope=0.7, ends=(End.GABLE, End.VALLEY)
    )
    roof = home_roofs([house((main, wing))])
    normals, _ = face_normals(roof.vertices, roof.faces)
    upper = (normals[:, 2] > 0.3) & (roof.semantic == Semantic.ROOF)
    tree = shapely.STRtree(shapely.polygons(roof.vertices[roof.faces[upper]][..., :2]))
    xy = np.random.default_rng(0).uniform((-6.0, -3.0), (6.0, 9.0), (2000, 2))
    xy = xy[shapely.contains_xy(outline((main, wing)).buffer(-0.1), xy)]
    hits = np.bincount(tree.query(shapely.points(xy), predicate="within")[0], minlength=len(xy))
    assert (hits == 1).mean() > 0.995
    assert hits.max() == 1


@pytest.mark.parametrize("end", [End.GABLE, End.HIP])
def test_walls_and_roof_close_around_a_plain_house(end):
    """The shell is watertight enough to hold the volume of the prism below and the roof above, overhangs aside."""
    a, b, eave, slope = 12.0, 8.0, 2.8, 0.6
    body = Body(-a / 2, a / 2, 0.0, b, eave, 1, Role.HOUSE, Top.RIDGED, slope=slope, ends=(end, end))
    home = house((body,))
    shell = concatenate([home_walls([home], stream(0, "walls")), home_roofs([home])])
    normals, _ = face_normals(shell.vertices, shell.faces)
    middle = shell.vertices[shell.faces].mean(axis=1)
    roof = (shell.semantic == Semantic.ROOF) & (normals[:, 2] > 0.3)
    assert ((normals[roof] * (middle[roof] - np.array([0.0, b / 2, 0.0]))).sum(axis=1) > 0).all()
    ridge = middle[roof][:, 2].max()
    assert eave < ridge < eave + slope * b / 2 + 0.3
    wall = (shell.semantic != Semantic.ROOF) & (np.abs(normals[:, 2]) < 0.01)
    outward = (normals[wall] * (middle[wall] - np.array([0.0, b / 2, 0.0])))[:, :2].sum(axis=1)
    assert (outward > 0).mean() > 0.7  # the rest are reveals of windows


@pytest.mark.parametrize("seed", range(40))
def test_bodies_touch_but_do_not_overlap(seed):
    rng = stream(seed, "bodies")
    traits = Traits(bool(rng.uniform() < 0.5), int(rng.integers(1, 3)), True, 0.3)
    style = draw_home_style(traits, 0, PaletteBuilder(rng), rng)
    bodies = draw_bodies(traits, style, rng.uniform(10.0, 24.0), rng)
    boxes = np.array([shapely.box(b.x0_m, b.y0_m, b.x1_m, b.y1_m) for b in bodies], dtype=object)
    assert shapely.area(boxes).sum() == pytest.approx(outline(bodies).area, rel=1e-6)
    mirrored = tuple(b.moved(3.0, 4.0, True) for b in bodies)
    assert outline(mirrored).area == pytest.approx(outline(bodies).area, rel=1e-9)
    main = bodies[0]
    for body in bodies[1:]:
        if End.VALLEY in body.ends:
            assert body.slope == main.slope
            assert body.eave_m == main.eave_m
            assert body.half_across_m <= main.half_across_m
