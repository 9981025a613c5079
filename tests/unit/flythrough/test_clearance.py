"""Distances to a mesh: closed forms on simple shapes, and an independent oracle on random ones."""

from __future__ import annotations

import numpy as np
import pytest

from scenegen.world import TriangleMesh
from scenegen_flythrough.clearance import MeshProximity
from scenegen_flythrough.distance import point_triangle, segment_triangle

TRIANGLE = np.array([[0.0, 0.0, 0.0], [4.0, 0.0, 0.0], [0.0, 3.0, 0.0]])


def mesh_of(triangles: np.ndarray) -> TriangleMesh:
    corners = triangles.reshape(-1, 3).astype(np.float32)
    return TriangleMesh(corners, np.arange(len(corners), dtype=np.uint32).reshape(-1, 3))


def random_soup(seed: int, count: int) -> TriangleMesh:
    """Triangles of very different sizes, some of them degenerate to a needle or a point."""
    rng = np.random.default_rng(seed)
    centre = rng.uniform(-20, 20, (count, 1, 3))
    shape = rng.normal(size=(count, 3, 3)) * np.exp(rng.uniform(-3, 2.5, (count, 1, 1)))
    shape[::17, 2] = shape[::17, 1]
    shape[::31] = shape[::31, :1]
    return mesh_of(centre + shape)


def dense_distance(start: np.ndarray, end: np.ndarray, triangle: np.ndarray) -> float:
    """Projected gradient descent over segment x triangle: shares no formula with the code under test."""
    a, e1, e2 = triangle[0], triangle[1] - triangle[0], triangle[2] - triangle[0]
    basis = np.stack([end - start, -e1, -e2], axis=1)
    offset = start - a
    lipschitz = max(np.linalg.norm(basis, 2) ** 2, 1e-12)
    best = np.inf
    for x in (np.array([0.5, 1 / 3, 1 / 3]), np.array([0.0, 0.0, 0.0]), np.array([1.0, 0.5, 0.5])):
        y, momentum = x.copy(), 1.0
        for _ in range(600):
            step = y - basis.T @ (offset + basis @ y) / lipschitz
            new = np.concatenate([np.clip(step[:1], 0, 1), onto_simplex(step[1:])])
            following = (1 + np.sqrt(1 + 4 * momentum**2)) / 2
            y = new + (momentum - 1) / following * (new - x)
            x, momentum = new, following
        best = min(best, float(np.linalg.norm(offset + basis @ x)))
    return best


def onto_simplex(uv: np.ndarray) -> np.ndarray:
    """Nearest point with u, v >= 0 and u + v <= 1."""
    inside = np.clip(uv, 0, None)
    if inside.sum() <= 1:
        return inside
    t = np.clip((uv[0] - uv[1] + 1) / 2, 0, 1)
    return np.array([t, 1 - t])


@pytest.mark.parametrize(
    ("point", "distance"),
    [
        ((1.0, 1.0, 2.0), 2.0),  # above the face
        ((1.0, 1.0, -0.5), 0.5),  # below it
        ((2.0, -3.0, 4.0), 5.0),  # beside an edge
        ((-3.0, -4.0, 12.0), 13.0),  # beyond a corner
        ((2.0 + 3 * 0.6, 1.5 + 3 * 0.8, 0.0), 3.0),  # beside the long edge, in the plane
        ((1.0, 1.0, 0.0), 0.0),  # on the face
    ],
)
def test_point_to_triangle_closed_forms(point: tuple[float, float, float], distance: float) -> None:
    assert np.sqrt(point_triangle(np.array([point]), TRIANGLE[None]))[0] == pytest.approx(distance, abs=1e-12)


@pytest.mark.parametrize(
    ("start", "end", "distance"),
    [
        ((1.0, 1.0, 2.0), (1.0, 1.0, -2.0), 0.0),  # through the face, from above
        ((1.0, 1.0, -2.0), (1.0, 1.0, 2.0), 0.0),  # and from below
        ((3.0, 3.0, 2.0), (3.0, 3.0, -2.0), (3 * 3 + 4 * 3 - 12) / 5),  # past the long edge
        ((1.0, -2.0, 5.0), (1.0, -2.0, -5.0), 2.0),  # past a leg: both ends far, the middle near
        ((1.0, 1.0, 3.0), (1.0, 1.0, 1.5), 1.5),  # ends above the face
        ((-1.0, -5.0, 0.0), (-1.0, 5.0, 0.0), 1.0),  # in the plane, beside a leg
        ((-1.0, 1.0, 0.0), (5.0, 1.0, 0.0), 0.0),  # in the plane, across
        ((0.5, 0.5, 0.7), (1.5, 0.5, 0.7), 0.7),  # parallel to the face
        ((1.0, 1.0, 1.0), (1.0, 1.0, 1.0), 1.0),  # no length
    ],
)
def test_segment_to_triangle_closed_forms(start: tuple, end: tuple, distance: float) -> None:
    for corners in (TRIANGLE, TRIANGLE[::-1], np.roll(TRIANGLE, 1, axis=0)):
        found = np.sqrt(segment_triangle(np.array([start]), np.array([end]), corners[None].copy()))[0]
        assert found == pytest.approx(distance, abs=1e-12)


def test_segment_to_triangle_agrees_with_descent_on_random_pairs() -> None:
    rng = np.random.default_rng(11)
    starts, ends = rng.normal(size=(2, 60, 3)) * 1.5
    triangles = rng.normal(size=(60, 3, 3))
    found = np.sqrt(segment_triangle(starts, ends, triangles))
    truth = [dense_distance(*pair) for pair in zip(starts, ends, triangles, strict=True)]
    np.testing.assert_allclose(found, truth, atol=2e-5)
    assert (found < 1e-9).any()
    assert (found > 0.3).any()


@pytest.mark.parametrize("count", [1, 7, 8, 9, 300, 3000])
def test_tree_equals_brute_force(count: int) -> None:
    mesh = random_soup(count, count)
    proximity = MeshProximity(mesh)
    rng = np.random.default_rng(3)
    starts = rng.uniform(-30, 30, (80, 3))
    ends = starts + rng.normal(size=(80, 3)) * 3
    corners = mesh.vertices[mesh.faces].astype(np.float64)
    many = lambda p: np.repeat(p, count, axis=0)  # noqa: E731
    tiled = np.tile(corners, (80, 1, 1))
    to_points = np.sqrt(point_triangle(many(starts), tiled)).reshape(80, count)
    to_segments = np.sqrt(segment_triangle(many(starts), many(ends), tiled)).reshape(80, count)
    np.testing.assert_array_equal(proximity.distance(starts), to_points.min(axis=1))
    sweep = proximity.sweep(starts, ends)
    np.testing.assert_array_equal(sweep.distance_m, to_segments.min(axis=1))
    np.testing.assert_array_equal(to_segments[np.arange(80), sweep.face], sweep.distance_m)
    for radius in (0.05, 0.7, 4.0):
        limited = proximity.sweep(starts, ends, radius)
        np.testing.assert_array_equal(limited.touches, to_segments.min(axis=1) <= radius)
        np.testing.assert_array_equal(limited.distance_m[limited.touches], sweep.distance_m[limited.touches])
        assert np.isinf(limited.distance_m[~limited.touches]).all()
        assert (limited.face[~limited.touches] == -1).all()


def test_far_away_and_many_queries() -> None:
    mesh = mesh_of(TRIANGLE[None] + 1000.0)
    points = np.zeros((5000, 3))
    points[:, 0] = np.linspace(-5000, 5000, 5000)
    proximity = MeshProximity(mesh)
    expected = np.sqrt(point_triangle(points, np.repeat((TRIANGLE + 1000.0)[None], 5000, axis=0)))
    np.testing.assert_array_equal(proximity.distance(points), expected)
    assert np.isinf(proximity.distance(points, limit_m=100.0)).all()


def test_touching_at_exactly_the_radius_counts() -> None:
    proximity = MeshProximity(mesh_of(TRIANGLE[None]))
    start, end = np.array([[1.0, 1.0, 0.1]]), np.array([[1.5, 0.5, 0.1]])
    assert proximity.sweep(start, end, 0.1).touches[0]
    assert not proximity.sweep(start, end, 0.0999999).touches[0]


def test_fast_sphere_does_not_tunnel_through_a_wire() -> None:
    """22 m/s at 20 Hz: the ends of the step are half a metre from a wire of 1 cm, the step crosses it."""
    wire = np.array([[[0.0, -50.0, 5.0], [0.0, 50.0, 5.0], [0.0, 50.0, 5.01]]])
    proximity = MeshProximity(mesh_of(wire))
    start, end = np.array([[-0.55, 0.0, 5.2]]), np.array([[0.55, 0.0, 5.2]])
    assert not proximity.distance(np.concatenate([start, end]), 0.35).min() <= 0.35
    assert proximity.sweep(start, end, 0.35).touches[0]


def test_first_contact_with_a_wall() -> None:
    wall = np.array([[[5.0, -9.0, -9.0], [5.0, 9.0, -9.0], [5.0, 0.0, 9.0]]])
    proximity = MeshProximity(mesh_of(wall))
    starts = np.array([[0.0, 0.0, 0.0], [4.9, 0.0, 0.0], [0.0, 0.0, 0.0]])
    ends = np.array([[10.0, 0.0, 0.0], [9.0, 0.0, 0.0], [-10.0, 0.0, 0.0]])
    share = proximity.first_contact(starts, ends, 0.35)
    assert share[0] == pytest.approx((5.0 - 0.35) / 10.0, abs=2e-6)
    assert share[0] <= (5.0 - 0.35) / 10.0
    assert share[1] == 0.0
    assert np.isinf(share[2])


def test_mesh_without_faces_is_infinitely_far() -> None:
    empty = TriangleMesh(np.zeros((0, 3), np.float32), np.zeros((0, 3), np.uint32))
    proximity = MeshProximity(empty)
    assert np.isinf(proximity.distance(np.zeros((2, 3)))).all()
    assert not proximity.sweep(np.zeros((2, 3)), np.ones((2, 3)), 1.0).touches.any()
    assert proximity.distance(np.zeros((0, 3))).shape == (0,)


def test_order_of_faces_does_not_change_distances() -> None:
    mesh = random_soup(5, 500)
    shuffled = TriangleMesh(mesh.vertices, mesh.faces[np.random.default_rng(1).permutation(500)])
    points = np.random.default_rng(2).uniform(-20, 20, (50, 3))
    np.testing.assert_array_equal(
        MeshProximity(mesh).distance(points), MeshProximity(shuffled).distance(points)
    )
