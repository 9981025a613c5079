"""The smaller builders: merging, patches, templates, cars, boxes, placement."""

from __future__ import annotations

import numpy as np
import pytest
import shapely

from scenegen.geometry.boxes import boxes
from scenegen.geometry.builder import GeometryBuilder
from scenegen.geometry.part import concatenate, face_areas, face_normals
from scenegen.geometry.patch import patches
from scenegen.geometry.placement import along, clear_of, first_come, rectangles
from scenegen.geometry.ragged import ragged_arange, ragged_grid
from scenegen.geometry.rings import inset, strip
from scenegen.geometry.template import place
from scenegen.parts.vehicles.vehicle import vehicle

SQUARE = np.array([[[0, 0, 0], [6, 0, 0], [6, 4, 0], [0, 4, 0]]], np.float64)
ZERO = np.zeros(1, np.int64)


def test_ragged_counts():
    item, index = ragged_arange(np.array([2, 0, 3]))
    assert item.tolist() == [0, 0, 2, 2, 2]
    assert index.tolist() == [0, 1, 0, 1, 2]
    item, column, row = ragged_grid(np.array([2, 1]), np.array([1, 2]))
    assert list(zip(item.tolist(), column.tolist(), row.tolist(), strict=True)) == [
        (0, 0, 0), (0, 1, 0), (1, 0, 0), (1, 0, 1),
    ]  # fmt: skip


@pytest.mark.parametrize("lumped", [False, True])
def test_a_patch_keeps_its_area_and_side(lumped):
    part = patches(SQUARE, 2.0, ZERO, ZERO, ZERO + 1, lumped_rows=lumped)
    normals, area = face_normals(part.vertices, part.faces)
    assert area.sum() == pytest.approx(24.0)
    assert (normals[:, 2] > 0.999).all()
    assert len(part.site_position) == (4 if lumped else 12)


def test_a_triangle_is_a_patch_with_two_equal_corners():
    gable = SQUARE.copy()
    gable[0, 3] = gable[0, 2] = [3, 5, 0]
    builder = GeometryBuilder()
    builder.add(patches(gable, 2.0, ZERO, ZERO, ZERO + 1))
    merged = builder.merge()
    assert float(merged.sites.area.sum()) == pytest.approx(15.0, rel=1e-5)
    assert (
        face_areas(merged.mesh.vertices.astype(np.float64), merged.mesh.faces.astype(np.int64)).min() > 1e-6
    )


def test_the_builder_refuses_a_site_of_two_surfaces():
    part = patches(SQUARE, 3.0, ZERO, ZERO, ZERO + 1)
    part.surface[0] = 5
    builder = GeometryBuilder()
    builder.add(part)
    with pytest.raises(AssertionError, match="two surfaces"):
        builder.merge()


def test_boxes_are_closed_but_for_the_underside():
    part = boxes(
        np.array([[1.0, 2.0, 3.0]]), np.array([[4.0, 2.0, 1.5]]), np.array([0.7]), ZERO, ZERO, ZERO + 1
    )
    normals, area = face_normals(part.vertices, part.faces)
    assert area.sum() == pytest.approx(2 * (4 + 2) * 1.5 + 8)
    outward = part.vertices[part.faces].mean(axis=1) - np.array([1.0, 2.0, 3.75])
    assert (np.einsum("ij,ij->i", normals, outward) > 0).all()


def test_a_copy_is_turned_scaled_and_sheared():
    template = vehicle("saloon")
    position = np.array([[10.0, -4.0, 2.0]])
    part = place(
        template, position, np.array([np.pi / 2]), np.array([[1.0, 1.0, 2.0]]),
        np.array([[5, 6, 7, 8, 9, 10, 11, 12]]), np.array([3]), np.array([[0.1, 0.0]]),
    )  # fmt: skip
    expected = np.column_stack(
        [-template.vertices[:, 1], template.vertices[:, 0], 2 * template.vertices[:, 2]]
    )
    expected[:, 2] += 0.1 * expected[:, 0]
    assert np.allclose(part.vertices, expected + position)
    assert np.allclose(np.linalg.norm(part.site_normal, axis=1), 1.0)
    assert set(np.unique(part.surface)) == set(range(5, 12))


def test_offset_rings_and_strips():
    ring = np.array([[0, 0], [8, 0], [8, 5], [0, 5]], np.float64)
    assert inset(ring, 1.0).tolist() == [[1, 1], [7, 1], [7, 4], [1, 4]]
    quads = strip(ring, 0.0, ring, 2.0)
    part = patches(quads, 10.0, np.zeros(4, np.int64), np.zeros(4, np.int64), np.ones(4, np.int64))
    normals, area = face_normals(part.vertices, part.faces)
    outward = part.vertices[part.faces].mean(axis=1) - np.array([4.0, 2.5, 1.0])
    assert (np.einsum("ij,ij->i", normals, outward) > 0).all()
    assert area.sum() == pytest.approx(52.0)


def test_placement_along_a_line_and_keeping_apart():
    line = np.array([[0, 0], [10, 0], [10, 10]], np.float64)
    xy, heading = along(line, np.array([4.0, 15.0]), np.array([1.0, 2.0]))
    assert np.allclose(xy, [[4, -1], [12, 5]])
    assert np.allclose(heading, [0, np.pi / 2])
    shapes = rectangles(np.array([[0.0, 0], [1, 0], [9, 0]]), np.full(3, 4.0), np.full(3, 2.0), np.zeros(3))
    assert first_come(shapes).tolist() == [True, False, True]
    assert clear_of(shapes, np.array([shapely.box(11.5, -1, 12, 1)], dtype=object), 1.0).tolist() == [
        True,
        True,
        False,
    ]


def test_concatenation_shifts_indices():
    part = patches(SQUARE, 2.0, ZERO, ZERO, ZERO + 1)
    double = concatenate([part, part])
    assert double.faces.max() == 2 * len(part.vertices) - 1
    assert double.corner_site.max() == 2 * len(part.site_position) - 1
