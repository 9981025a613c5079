"""Repair: what is dropped is counted, what stays is sound."""

import numpy as np
import pytest

from scenegen.foundation.errors import InputError
from scenegen.maps.own_scene.raw import Names, RawScene
from scenegen.maps.own_scene.repair import Soup, join, repair, weld

SQUARE = np.array([[0, 0, 0], [4, 0, 0], [4, 4, 0], [0, 4, 0]], float)
FACES = np.array([[0, 1, 2], [0, 2, 3]])


def soup(vertices: np.ndarray = SQUARE, faces: np.ndarray = FACES, matrix: np.ndarray | None = None) -> Soup:
    return Soup(vertices, faces, np.eye(4) if matrix is None else matrix, Names("a", "", "", 0))


def repaired(*soups: Soup, up: str = "z", unit_m: float = 1.0, ignored: int = 0) -> RawScene:
    return repair(join(soups), ignored, up, unit_m)


def test_a_sound_scene_stays_what_it_is() -> None:
    scene = repaired(soup())
    np.testing.assert_array_equal(scene.vertices[scene.faces], SQUARE[FACES])
    assert scene.repairs == ()
    assert scene.shift_m == (0.0, 0.0)


def test_everything_that_is_dropped_is_counted() -> None:
    vertices = np.vstack([SQUARE, [[np.nan, 0, 0], [9, 9, 0], [9, 9, 1e-9]]])
    faces = np.vstack(
        [FACES, [[0, 1, 99], [0, -1, 2], [0, 1, 4], [5, 5, 1], [0, 5, 6], [2, 1, 0], [1, 2, 0]]]
    )
    scene = repaired(soup(vertices, faces), soup(), soup(SQUARE + 10.0), ignored=3)
    assert dict(scene.repairs) == {
        "lines and points ignored": 3,
        "faces dropped: corner missing": 2,
        "faces dropped: not finite": 1,
        "faces dropped: no area": 2,
        "faces dropped: duplicate": 4,  # two in the first part, the whole of the second
    }
    assert len(scene.faces) == 4
    assert scene.part.tolist() == [0, 0, 2, 2]
    assert len(scene.vertices) == 8


def test_a_scene_that_is_mostly_broken_is_refused() -> None:
    faces = np.vstack([FACES, [[0, 1, 9], [0, 1, 8], [0, 1, 7]]])
    with pytest.raises(InputError, match="is broken: 3 of its 5 triangles"):
        repaired(soup(faces=faces))


@pytest.mark.parametrize(
    ("parts", "message"),
    [
        ([], "holds no sound triangle"),
        ([soup(faces=FACES[:0])], "holds no sound triangle"),
        ([soup(faces=np.array([[0, 0, 1], [1, 1, 2]]))], "holds no triangle with an area"),
        ([soup(SQUARE * 1e-4)], "is 0.0004 m large"),
        ([soup(SQUARE * 1e5)], "is 4e.05 m large"),
        ([soup(SQUARE + np.array([0, 0, 2e4]))], "lies 20,000 m high"),
    ],
)
def test_a_scene_that_makes_no_sense_is_refused(parts: list[Soup], message: str) -> None:
    with pytest.raises(InputError, match=message):
        repaired(*parts)


def test_y_up_is_turned_and_units_become_metres() -> None:
    scene = repaired(soup(np.array([[0, 0, 0], [1, 0, 0], [0, 2, 0.0]]), FACES[:1]), up="y", unit_m=10.0)
    np.testing.assert_allclose(scene.vertices[scene.faces[0]], [[0, 0, 0], [10, 0, 0], [0, 0, 20]])
    z_axis = repaired(soup(np.array([[0, 0, 0], [1, 0, 0], [0, 0, 2.0]]), FACES[:1]), up="y", unit_m=10.0)
    np.testing.assert_allclose(z_axis.vertices[z_axis.faces[0]], [[0, 0, 0], [10, 0, 0], [0, -20, 0]])


def test_a_far_away_scene_comes_to_the_origin_by_whole_metres() -> None:
    scene = repaired(soup(SQUARE + np.array([500_000.25, 4_100_000.5, 7.0])))
    assert scene.shift_m == (500_002.0, 4_100_002.0)
    np.testing.assert_allclose(scene.vertices.min(axis=0), [-1.75, -1.5, 7.0])
    near = repaired(soup(SQUARE + np.array([1900.0, 0, 0])))
    assert near.shift_m == (0.0, 0.0)


def test_nodes_carry_their_parts_with_them() -> None:
    matrix = np.diag([2.0, 2.0, 2.0, 1.0])
    matrix[:3, 3] = 1, 2, 3
    scene = repaired(soup(matrix=matrix))
    np.testing.assert_allclose(scene.vertices.min(axis=0), [1, 2, 3])
    np.testing.assert_allclose(scene.vertices.max(axis=0), [9, 10, 3])


def test_vertices_equal_as_float32_are_one() -> None:
    vertices = np.array([[1, 2, 3], [1, 2, 3 + 1e-9], [-0.0, 0, 0], [0, 0, 0], [1, 2, 3.1]])
    welded, faces = weld(vertices, np.array([[0, 2, 4], [1, 3, 4]]))
    assert len(welded) == 3
    assert faces[0].tolist() == faces[1].tolist()
    np.testing.assert_allclose(welded[faces[0]], [[1, 2, 3], [0, 0, 0], [1, 2, 3.1]], atol=1e-6)
