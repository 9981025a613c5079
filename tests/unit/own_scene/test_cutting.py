"""Cutting triangles and placing sites: watertight, orientation kept, bounded, on the surface."""

from functools import partial

import numpy as np
import pytest
import trimesh

from scenegen.geometry.part import face_areas, face_normals
from scenegen.maps.own_scene.detail import Detail
from scenegen.maps.own_scene.facets import smooth_facets
from scenegen.maps.own_scene.sites import Skin, place_sites
from scenegen.maps.own_scene.subdivide import subdivide


def uniform(places: np.ndarray, longest_m: float) -> np.ndarray:
    return np.full(len(places), longest_m)


def mesh(shape: trimesh.Trimesh) -> tuple[np.ndarray, np.ndarray]:
    return np.asarray(shape.vertices, np.float32).astype(float), np.asarray(shape.faces, np.int64)


def cut(
    vertices: np.ndarray, faces: np.ndarray, longest_m: float
) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    result = subdivide(vertices, faces, partial(uniform, longest_m=longest_m), 10**6)
    assert result is not None
    return result


def skin_of(vertices: np.ndarray, faces: np.ndarray, group: np.ndarray | None = None) -> Skin:
    group = np.zeros(len(faces), np.int64) if group is None else group
    normals, area = face_normals(vertices, faces)
    return Skin(vertices, faces, normals, area, smooth_facets(faces, normals, group), group)


@pytest.mark.parametrize(
    "shape",
    [
        trimesh.creation.box(extents=(40, 23, 11)),
        trimesh.creation.cylinder(radius=9, height=31, sections=17),
        trimesh.creation.icosphere(subdivisions=1, radius=12),
        trimesh.creation.box(extents=(900, 2, 2)),
    ],
    ids=["box", "cylinder", "ball", "beam"],
)
@pytest.mark.parametrize("longest_m", [2.5, 7.0])
def test_a_closed_shape_stays_closed_and_keeps_volume_area_and_order(
    shape: trimesh.Trimesh, longest_m: float
) -> None:
    vertices, faces = mesh(shape)
    more, pieces, parent = cut(vertices, faces, longest_m)
    after = trimesh.Trimesh(more, pieces, process=False)
    assert after.is_watertight
    assert after.is_winding_consistent
    assert after.volume == pytest.approx(shape.volume, rel=1e-5)
    assert (np.diff(parent) >= 0).all()
    np.testing.assert_allclose(
        np.bincount(parent, face_areas(more, pieces)), face_areas(vertices, faces), rtol=1e-4
    )
    edges = np.linalg.norm(more[pieces][:, [1, 2, 0]] - more[pieces], axis=2)
    small = face_areas(more, pieces) <= 0.25 * longest_m**2
    assert (small | (edges.max(axis=1) <= longest_m)).all()


def test_thin_slivers_are_left_long() -> None:
    """A fan of 2,000 slivers of 200 m x 5 cm: cut to 2.5 m for the sake of their edges, they would be 160,000."""
    x = np.linspace(0.0, 100.0, 2001)
    rim = np.stack([x, np.full_like(x, 200.0), np.zeros_like(x)], axis=1)
    vertices = np.vstack([[[50.0, 0.0, 0.0]], rim]).astype(np.float32).astype(float)
    fan = np.stack([np.zeros(2000, int), np.arange(2, 2002), np.arange(1, 2001)], axis=1)
    more, pieces, _ = cut(vertices, fan, 2.5)
    assert 5000 < len(pieces) < 15_000
    assert face_areas(more, pieces).max() <= 0.25 * 2.5**2


def test_cutting_gives_up_where_it_would_make_too_many() -> None:
    vertices, faces = mesh(trimesh.creation.box(extents=(500, 500, 1)))
    assert subdivide(vertices, faces, partial(uniform, longest_m=2.5), 20_000) is None


def test_open_ground_far_from_everything_is_cut_coarsely() -> None:
    plane, box = (
        mesh(trimesh.creation.box(extents=(2000, 2000, 1))),
        mesh(trimesh.creation.box(extents=(8, 8, 8))),
    )
    vertices = np.vstack([plane[0], box[0] + [0, 0, 4.5]])
    faces = np.vstack([plane[1], box[1] + len(plane[0])])
    normals, area = face_normals(vertices, faces)
    facet = smooth_facets(faces, normals, np.zeros(len(faces), np.int64))
    detail = Detail.of(vertices, faces, area, facet)
    places = np.array([[0.0, 0, 0], [100.0, 0, 0], [900.0, 0, 0]])
    near, middle, far = detail.longest_m(places, 2.5, 20.0)
    assert near == 2.5
    assert 10.0 < middle < 20.0
    assert far > 80.0


def test_facets_end_at_creases_groups_and_reversed_neighbours() -> None:
    vertices, faces = mesh(trimesh.creation.cylinder(radius=5, height=10, sections=32))
    normals, _ = face_normals(vertices, faces)
    together = np.zeros(len(faces), np.int64)
    assert smooth_facets(faces, normals, together).max() + 1 == 3  # mantle, top, bottom
    halves = (vertices[faces].mean(axis=1)[:, 0] > 0).astype(np.int64)
    assert smooth_facets(faces, normals, halves).max() + 1 == 6
    for second, count in (([1, 3, 2], 1), ([1, 2, 3], 2)):
        pair = np.array([[0, 1, 2], second])
        upward = np.tile([0.0, 0.0, 1.0], (2, 1))
        assert smooth_facets(pair, upward, np.zeros(2, np.int64)).max() + 1 == count


def test_sites_of_a_ball_lie_on_it_and_look_outwards() -> None:
    vertices, faces = mesh(trimesh.creation.icosphere(subdivisions=4, radius=6.0))
    placed = place_sites(skin_of(vertices, faces), 2.5)
    radius = np.linalg.norm(placed.position, axis=1)
    np.testing.assert_allclose(radius, 6.0, rtol=1e-6)
    assert np.einsum("ij,ij->i", placed.position / radius[:, None], placed.normal).min() > 0.97
    assert 100 < len(placed.position) < len(vertices)
    reach = np.linalg.norm(placed.position[placed.corner_site] - vertices[faces], axis=2)
    assert reach.max() < 2.5


def test_a_box_has_flat_sides_and_sites_at_its_corners() -> None:
    vertices, faces, _ = cut(*mesh(trimesh.creation.box(extents=(10, 10, 10))), 2.5)
    placed = place_sites(skin_of(vertices, faces), 2.5)
    assert set(np.abs(placed.normal).round(9).max(axis=1)) == {1.0}
    normals, _ = face_normals(vertices, faces)
    assert np.einsum("fk,fck->fc", normals, placed.normal[placed.corner_site]).min() > 1 - 1e-9


def test_small_things_are_lumped_by_object_and_side() -> None:
    rng = np.random.default_rng(4)
    leaves = rng.normal(0, 0.6, (400, 1, 3)) + rng.normal(0, 0.08, (400, 3, 3))
    vertices, faces = leaves.reshape(-1, 3), np.arange(1200).reshape(-1, 3)
    owner = np.repeat([0, 1], 200)
    placed = place_sites(skin_of(vertices, faces, owner), 2.5)
    assert len(placed.position) <= 2 * 6 * 27
    lumps = placed.corner_site[:, 0]
    assert (placed.corner_site == lumps[:, None]).all()
    assert all(len(set(owner[lumps == k])) == 1 for k in range(len(placed.position)))
    middle = vertices[faces].mean(axis=1)
    assert all(np.linalg.norm(middle - p, axis=1).min() < 1e-9 for p in placed.position)
    np.testing.assert_allclose(np.linalg.norm(placed.normal, axis=1), 1.0)


@pytest.mark.parametrize("most", [60, 500, 4000])
def test_there_are_never_more_sites_than_allowed(most: int) -> None:
    vertices, faces, _ = cut(*mesh(trimesh.creation.box(extents=(60, 60, 20))), 2.5)
    placed = place_sites(skin_of(vertices, faces), 2.5, most)
    assert len(placed.position) <= most
    assert placed.corner_site.max() == len(placed.position) - 1
