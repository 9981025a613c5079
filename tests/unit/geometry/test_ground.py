"""Draped ground: kerbs close their gaps, levels are what was asked, sites lie on their own side."""

from __future__ import annotations

import numpy as np
import pytest
import shapely

from scenegen.geometry.ground import Region, drape
from scenegen.geometry.part import face_normals
from scenegen.geometry.planar import triangulate
from scenegen.geometry.scatter import hexagonal

ROAD = Region(shapely.box(-30, -30, 30, 30), surface=0, semantic=1, object=1)
PAINT = Region(shapely.box(-25, -20, -22, -19.85), surface=3, semantic=3, object=9, lumped=True)
BLOCK = Region(shapely.box(-15, -12, 18, 16), surface=1, semantic=2, object=2, level_m=0.12)
HOUSE = Region(shapely.box(-10, -6, -2, 5), surface=0, semantic=0, object=0, hole=True)
POND = Region(shapely.Point(9, 5).buffer(5.0), surface=2, semantic=8, object=3, level_m=-0.6, absolute=True)
REGIONS = [ROAD, PAINT, BLOCK, HOUSE, POND]


def slope(xy):
    return 0.02 * xy[:, 0] + 0.01 * xy[:, 1]


@pytest.fixture(scope="module")
def ground():
    free = hexagonal(-30, -30, 30, 30, 2.0, np.random.default_rng(1))
    return drape(triangulate([r.outline for r in REGIONS], free, 1.5), REGIONS, slope)


def test_nothing_but_the_house_and_the_rim_is_open(ground):
    position = np.rint(ground.vertices * 1e4).astype(np.int64)
    _, merged = np.unique(position, axis=0, return_inverse=True)
    faces = merged.ravel()[ground.faces]
    edges = np.sort(faces[:, [0, 1, 1, 2, 2, 0]].reshape(-1, 2), axis=1)
    unique, first, count = np.unique(edges, axis=0, return_index=True, return_counts=True)
    assert count.max() == 2
    corner = ground.faces[:, [0, 1, 1, 2, 2, 0]].reshape(-1, 2)[first[count == 1]]
    middle = shapely.points(ground.vertices[corner].mean(axis=1)[:, :2])
    edge = shapely.union_all([ROAD.outline.exterior, HOUSE.outline.exterior])
    assert shapely.distance(middle, edge).max() < 1e-6
    assert len(unique)


def test_levels(ground):
    for region, expected in ((ROAD, 0.0), (BLOCK, 0.12)):
        corners = ground.vertices[ground.faces[(ground.object == region.object)]].reshape(-1, 3)
        rise = corners[:, 2] - slope(corners[:, :2])
        assert rise.max() == pytest.approx(expected, abs=1e-9)
    water = ground.vertices[ground.faces[ground.semantic == 8]].reshape(-1, 3)
    assert np.ptp(water[:, 2]) == 0.0


def test_faces_look_outwards_and_kerbs_stand_upright(ground):
    normals, area = face_normals(ground.vertices, ground.faces)
    flat = np.abs(normals[:, 2]) > 0.5
    assert (normals[flat, 2] > 0.99).all()
    kerb = ~flat & (ground.object == 2)
    middle = ground.vertices[ground.faces[kerb]].mean(axis=1)[:, :2]
    outer = shapely.distance(shapely.points(middle), BLOCK.outline.exterior) < 1e-6
    assert (np.einsum("ij,ij->i", normals[kerb][outer, :2], middle[outer] - [1.5, 2.0]) > 0).all()
    assert area[kerb][outer].sum() == pytest.approx(0.12 * BLOCK.outline.exterior.length, rel=1e-6)


def test_sites_lie_inside_their_own_region(ground):
    corner_sites = np.unique(ground.corner_site[(ground.object == 2)])
    flat = corner_sites[ground.site_normal[corner_sites, 2] > 0.5]
    points = shapely.points(ground.site_position[flat, :2])
    assert shapely.contains(BLOCK.outline, points).all()
    assert (shapely.distance(points, HOUSE.outline) > 0.005).all()


def test_a_painted_line_has_one_site(ground):
    assert len(np.unique(ground.corner_site[ground.semantic == 3])) == 1
