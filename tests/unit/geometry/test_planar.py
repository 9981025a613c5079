"""The plane triangulation conforms to its plan, covers it exactly and has no T-junctions."""

from __future__ import annotations

import numpy as np
import pytest
import shapely

from scenegen.geometry.planar import triangulate
from scenegen.geometry.scatter import contact_points, graded_points, hexagonal

GROUND = shapely.box(-40.0, -30.0, 40.0, 30.0)
BLOCK = shapely.Polygon([(-30, -20), (25, -24), (30, 18), (-28, 20)])
HOUSE = shapely.Polygon([(-10, -8), (6, -10), (8, 6), (1, 7), (0, 0), (-9, 1)])
NEIGHBOUR = shapely.Polygon([(6, -10), (20, -12), (21, 4), (8, 6)])
DASH = shapely.box(-36.0, -26.0, -33.0, -25.84)


@pytest.fixture(scope="module")
def plan():
    regions = [GROUND, DASH, BLOCK, HOUSE, NEIGHBOUR]
    free = hexagonal(-40, -30, 40, 30, 2.0, np.random.default_rng(3))
    return regions, triangulate(regions, free, np.array([2.0, 2.0, 2.0, 1.0, 1.0]))


def areas(points, triangles):
    a, b, c = (points[triangles[:, k]] for k in range(3))
    return 0.5 * ((b[:, 0] - a[:, 0]) * (c[:, 1] - a[:, 1]) - (b[:, 1] - a[:, 1]) * (c[:, 0] - a[:, 0]))


def test_each_region_is_covered_exactly(plan):
    regions, mesh = plan
    area = areas(mesh.points, mesh.triangles)
    assert (area > 0).all()
    above = [
        shapely.union_all(regions[k + 1 :]) if k + 1 < len(regions) else shapely.Polygon()
        for k in range(len(regions))
    ]
    for k, (region, cover) in enumerate(zip(regions, above, strict=True)):
        assert area[mesh.region == k].sum() == pytest.approx(region.difference(cover).area, abs=0.05)


def test_interior_edges_are_shared_by_exactly_two_triangles(plan):
    _, mesh = plan
    inside = mesh.triangles[mesh.region >= 0]
    edges = np.sort(inside[:, [0, 1, 1, 2, 2, 0]].reshape(-1, 2), axis=1)
    unique, count = np.unique(edges, axis=0, return_counts=True)
    assert count.max() == 2
    rim = shapely.points(mesh.points[unique[count == 1]].mean(axis=1))
    assert shapely.distance(rim, GROUND.exterior).max() < 1e-6


def test_lines_are_cut_as_finely_as_asked(plan):
    _, mesh = plan
    wall = (mesh.region == 3)[:, None] & np.ones(3, bool)
    edges = np.sort(mesh.triangles[:, [0, 1, 1, 2, 2, 0]].reshape(-1, 3, 2)[wall], axis=1)
    middle = shapely.points(mesh.points[edges].mean(axis=1))
    on_outline = shapely.distance(middle, HOUSE.exterior) < 1e-6
    length = np.linalg.norm(np.diff(mesh.points[edges[on_outline]], axis=1)[:, 0], axis=1)
    assert on_outline.sum() > 40
    assert length.max() <= 1.0 + 1e-9


def test_a_ring_of_points_lies_around_contacts():
    points = contact_points([HOUSE], 1.2, 0.9)
    distance = shapely.distance(shapely.points(points), HOUSE)
    assert len(points) > 40
    assert np.median(distance) == pytest.approx(0.9, abs=0.01)


def test_graded_points_thin_out():
    core = shapely.Point(0, 0).buffer(60.0)
    points = graded_points(core, 800.0, 2.0, np.random.default_rng(0))
    near = np.linalg.norm(points, axis=1) < 55.0
    assert near.sum() / (np.pi * 55.0**2) == pytest.approx(2 / np.sqrt(3) / 4.0, rel=0.05)
    assert len(points) < 2 * near.sum()
    assert np.abs(points).max() < 800.0
