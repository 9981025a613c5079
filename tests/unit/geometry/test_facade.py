"""Facades: areas add up, openings are where they should be, everything faces outwards."""

from __future__ import annotations

import numpy as np
import pytest

from scenegen.classes import Semantic
from scenegen.geometry.facade import BLANK, DOOR, WINDOW, Walls, facades
from scenegen.geometry.part import face_normals

COLUMNS = np.array([6, 2])
STOREYS = np.array([4, 1])


@pytest.fixture(scope="module")
def walls():
    start = np.array([[0.0, 0.0], [24.0, 0.0]])
    end = np.array([[24.0, 0.0], [24.0, 9.0]])
    one = np.ones(2)
    return Walls(
        start=start,
        end=end,
        floor_m=10.0 * one,
        foundation_m=1.0 * one,
        top_m=np.array([24.0, 14.0]),
        storeys=STOREYS,
        first_storey_m=4.0 * one,
        storey_m=3.0 * one,
        columns=COLUMNS,
        window_share=0.5 * one,
        sill_m=0.9 * one,
        head_m=2.4 * one,
        first_sill_m=0.8 * one,
        first_head_m=3.0 * one,
        surface=np.array([3, 4]),
        glass=np.array([7, 7]),
        door=np.array([8, 8]),
        object=np.array([1, 1]),
        recess_m=0.1 * one,
    )


@pytest.fixture(scope="module")
def part(walls):
    wall, column, storey = walls.cells()
    filling = np.full(len(wall), WINDOW)
    filling[(wall == 0) & (column == 2) & (storey == 0)] = DOOR
    filling[(wall == 1)] = BLANK
    return facades(walls, filling)


def test_front_area_is_wall_area(part):
    normals, area = face_normals(part.vertices, part.faces)
    facing = normals @ np.array([0.0, -1.0, 0.0]) > 0.999
    assert area[facing].sum() == pytest.approx(24.0 * 15.0)
    blank = part.surface == 4
    assert area[blank].sum() == pytest.approx(9.0 * 5.0)
    assert (normals[blank] @ np.array([1.0, 0.0, 0.0]) > 0.999).all()


def test_panes_and_doors(part):
    normals, area = face_normals(part.vertices, part.faces)
    glass = part.semantic == Semantic.WINDOW
    assert area[glass].sum() == pytest.approx((5 * 2.0 * 2.2) + (18 * 2.0 * 1.5))
    assert part.vertices[part.faces[glass]][..., 1] == pytest.approx(0.1)
    assert len(np.unique(part.corner_site[glass])) == 23
    door = part.semantic == Semantic.DOOR
    assert area[door].sum() == pytest.approx(2.0 * (3.0 + 1.0))
    assert (normals[glass | door] @ np.array([0.0, -1.0, 0.0]) > 0.999).all()


def test_reveals_face_into_the_opening(part):
    normals, area = face_normals(part.vertices, part.faces)
    middle = part.vertices[part.faces].mean(axis=1)
    reveal = (part.surface == 3) & (np.abs(normals[:, 1]) < 0.5)
    assert area[reveal].sum() == pytest.approx(0.1 * (5 * 2 * (2.0 + 2.2) + 18 * 2 * (2.0 + 1.5)))
    panes = part.vertices[part.faces[part.semantic == Semantic.WINDOW]].mean(axis=1)
    near = panes[
        np.argmin(np.linalg.norm(middle[reveal][:, None, [0, 2]] - panes[None][..., [0, 2]], axis=2), axis=1)
    ]
    assert ((near - middle[reveal]) * normals[reveal])[:, [0, 2]].sum(axis=1).min() > 0


def test_the_wall_is_closed_around_its_openings(part):
    """Every edge inside the facade is shared by two faces, so no ray passes between wall, reveal and pane."""
    mine = part.surface != 4
    position = np.rint(part.vertices * 1e5).astype(np.int64)
    _, merged = np.unique(position, axis=0, return_inverse=True)
    edges = np.sort(merged.ravel()[part.faces[mine]][:, [0, 1, 1, 2, 2, 0]].reshape(-1, 2), axis=1)
    _, first, count = np.unique(edges, axis=0, return_index=True, return_counts=True)
    corner = part.faces[mine][:, [0, 1, 1, 2, 2, 0]].reshape(-1, 2)[first[count == 1]]
    ends = part.vertices[corner]
    on_rim = np.isclose(ends[..., 0], 0) | np.isclose(ends[..., 0], 24) | np.isclose(ends[..., 2], 9)
    assert (on_rim | np.isclose(ends[..., 2], 24)).all()
    assert count.max() == 2


def test_rows_of_sites_are_finer_near_the_ground(part):
    heights = np.unique(
        np.round(part.site_position[np.unique(part.corner_site[part.surface == 3]), 2] - 10.0, 3)
    )
    assert heights[:2] == pytest.approx([0.15, 0.6])
    assert np.diff(heights).max() < 3.6
