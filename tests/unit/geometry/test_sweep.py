"""Sweeps along lines, and heights of a coarse mesh."""

from __future__ import annotations

import numpy as np
import pytest

from scenegen.geometry.part import Part, face_normals
from scenegen.geometry.standing import mesh_heights
from scenegen.geometry.sweep import sweep


def beam(line, lumped=False):
    square = np.array([[-1.0, 0.0], [1.0, 0.0], [1.0, 2.0], [-1.0, 2.0], [-1.0, 0.0]])
    labels = [np.full(4, k, np.int64) for k in (3, 17, 9)]
    return sweep(line, square, *labels, lumped=lumped)


def test_a_swept_square_is_a_beam_that_faces_outwards():
    line = np.column_stack([np.linspace(0.0, 30.0, 7), np.zeros(7), np.linspace(5.0, 6.0, 7)])
    part = beam(line)
    normal, area = face_normals(part.vertices, part.faces)
    middle = part.vertices[part.faces].mean(axis=1)
    axis = np.column_stack([middle[:, 0], np.zeros(len(middle)), 6.0 + middle[:, 0] / 30.0])
    assert (np.einsum("ij,ij->i", normal, middle - axis) > 0.9).all()
    slope = np.hypot(30.0, 1.0)
    assert area.sum() == pytest.approx(2 * 2.0 * slope + 2 * 2.0 * 30.0)
    assert len(part.site_position) == 4 * len(line)
    own = part.site_normal[part.corner_site]
    assert (np.einsum("fj,fkj->fk", normal, own) > 0.99).all()


def test_lumped_sweeps_have_one_site_per_station_on_top():
    line = np.column_stack([np.zeros(5), np.linspace(0.0, 8.0, 5), np.full(5, 1.0)])
    part = beam(line, lumped=True)
    assert len(part.site_position) == 5
    assert part.site_position[:, 2] == pytest.approx(3.0)
    assert part.corner_site.max() == 4


def test_heights_are_those_of_the_triangles_and_of_the_relief_beyond_them():
    vertices = np.array([[0.0, 0.0, 0.0], [10.0, 0.0, 2.0], [0.0, 10.0, 4.0]])
    one = np.zeros(1, np.int64)
    faces = np.array([[0, 1, 2]])
    ground = Part(vertices, faces, one, one, one, faces, vertices, vertices, np.zeros(3))
    xy = np.array([[5.0, 0.0], [2.0, 3.0], [9.0, 9.0]])
    height = mesh_heights(ground, np.ones(1, bool), xy, lambda p: np.full(len(p), -7.0))
    assert height == pytest.approx([1.0, 0.4 + 1.2, -7.0])
