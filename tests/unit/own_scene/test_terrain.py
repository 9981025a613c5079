"""Ground of a scene: lowest surface that looks up, land before water, ground classes before roofs."""

import numpy as np
import trimesh

from scenegen.classes import Semantic
from scenegen.geometry.part import face_normals
from scenegen.maps.own_scene.terrain import ground_field
from scenegen.world import HeightField


def field(*shapes: tuple[trimesh.Trimesh, Semantic]) -> HeightField:
    vertices, faces, kinds, first = [], [], [], 0
    for shape, kind in shapes:
        for _ in range(5):
            shape = shape.subdivide()
        vertices.append(np.asarray(shape.vertices))
        faces.append(np.asarray(shape.faces, np.int64) + first)
        kinds.append(np.full(len(shape.faces), kind, np.uint8))
        first += len(shape.vertices)
    v, f = np.concatenate(vertices), np.concatenate(faces)
    return ground_field(v, f, face_normals(v, f)[0], np.concatenate(kinds))


def slab(x: float, y: float, top: float, size: float, thick: float = 0.5) -> trimesh.Trimesh:
    box = trimesh.creation.box(extents=(size, size, thick))
    box.apply_translation((x, y, top - thick / 2))
    return box


def at(ground: HeightField, x: float, y: float) -> float:
    return float(ground.at(np.array([[x, y]], float))[0])


def test_a_slope_is_met_exactly() -> None:
    plane = slab(0, 0, 0, 50)
    plane.apply_transform(trimesh.transformations.rotation_matrix(0.3, (0, 1, 0)))
    ground = field((plane, Semantic.OTHER))
    for x in (-15.0, 0.0, 12.5):
        assert abs(at(ground, x, 3.0) + np.tan(0.3) * x) < 1e-3


def test_under_a_bridge_the_ground_goes_on() -> None:
    ground = field((slab(0, 0, 0, 60), Semantic.OTHER), (slab(0, 0, 6, 10), Semantic.OTHER))
    assert abs(at(ground, 0, 0)) < 1e-3


def test_land_counts_where_the_sea_goes_on_below_it() -> None:
    ground = field((slab(0, 0, 0, 80), Semantic.WATER), (slab(20, 0, 9, 30, 1.0), Semantic.GRASS))
    assert abs(at(ground, 20, 0) - 9.0) < 1e-3
    assert abs(at(ground, -25, 0)) < 1e-3


def test_a_roof_over_nothing_is_no_ground() -> None:
    """A house without a floor stands in a hole of its lot, as in worlds that were exported."""
    lots = [
        (slab(x, y, 0, 20), Semantic.GRASS) for x in (-20, 0, 20) for y in (-20, 0, 20) if (x, y) != (0, 0)
    ]
    ground = field(*lots, (slab(0, 0, 8, 20), Semantic.ROOF))
    assert abs(at(ground, 0, 0)) < 0.1


def test_without_any_surface_that_looks_up_it_is_the_lowest_point() -> None:
    wall = trimesh.Trimesh([[0, 0, 2], [9, 0, 2], [9, 0, 7.0]], [[0, 1, 2]], process=False)
    ground = field((wall, Semantic.WALL))
    assert float(ground.height_m.min()) == float(ground.height_m.max()) == 2.0
