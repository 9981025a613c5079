"""The coarse map: what it calls free, and how far it says the next obstacle is."""

from __future__ import annotations

import numpy as np
import pytest

from scenegen_flythrough.airspace import ROOM_CELLS, Airspace
from scenegen_flythrough.surface_samples import inner_points

BOX = (np.array([-100.0, -100.0, 0.5]), np.array([100.0, 100.0, 100.0]))


@pytest.fixture(scope="module")
def tower(build_city) -> Airspace:
    """One block of 40 x 20 m and 30 m height in the middle of a plain."""
    return Airspace(build_city(np.array([[[-20.0, -10.0, -1.0], [20.0, 10.0, 30.0]]])).world)


def test_room_counts_metres_to_the_wall(tower: Airspace) -> None:
    room = tower.room(15.0, 2.0)
    east = np.stack([np.arange(20.5, 40.0), np.full(20, 0.5)], axis=1)  # the wall stands in the first cell
    expected = np.minimum(np.arange(20), ROOM_CELLS)
    np.testing.assert_allclose(tower.look_up(room, east), expected, atol=1)


def test_walls_are_occupied_and_above_the_roof_is_free(tower: Airspace) -> None:
    wall = np.stack([np.full(18, 20.0 + 1e-3), np.arange(-8.5, 9.5)], axis=1)
    low, high = tower.room(15.0, 2.0), tower.room(40.0, 2.0)
    assert (tower.look_up(low, wall) <= 1).all()
    assert (tower.look_up(low, wall) == 0).mean() > 0.4  # samples are two cells apart
    assert (tower.look_up(high, wall) == ROOM_CELLS).all()


def test_outside_the_flight_box_there_is_no_room(tower: Airspace) -> None:
    beyond = np.array([[-141.0, 0.0], [141.0, 0.0], [0.0, -141.0], [0.0, 141.0], [1e6, 1e6]])
    np.testing.assert_array_equal(tower.look_up(tower.room(15.0, 1.0), beyond), 0)
    assert tower.look_up(tower.room(15.0, 1.0), np.array([[-139.5, 0.0]]))[0] > 0


def test_cell_centres_are_where_they_are_looked_up(tower: Airspace) -> None:
    room = tower.room(15.0, 1.0)
    flat = np.arange(room.size)[::37]
    np.testing.assert_array_equal(tower.look_up(room, tower.centre(flat)), room.ravel()[flat])


def test_the_ground_is_no_obstacle(hills_air: Airspace) -> None:
    """Terrain rises by 18 m, but the map counts from the ground."""
    assert (hills_air.room(2.0, 1.0) == ROOM_CELLS).mean() > 0.5


def test_inner_points_cover_a_large_triangle_and_nothing_else() -> None:
    corners = np.array([[0, 0, 0], [30, 0, 0], [0, 0, 40], [0, 0, 0.2], [1, 0, 0.2], [0, 1, 0.2]], np.float32)
    faces = np.array([[0, 1, 2], [3, 4, 5]], np.uint32)
    samples = np.concatenate(list(inner_points(corners, faces, 1.0, BOX)))
    assert (samples[:, 1] == 0).all()
    assert (samples[:, 0] / 30 + samples[:, 2] / 40 <= 1 + 1e-6).all()
    assert samples.min() >= -1e-9
    probe = np.random.default_rng(0).random((400, 2))
    probe = np.where(probe.sum(axis=1, keepdims=True) > 1, 1 - probe, probe) * [30, 40]
    gap = np.linalg.norm(probe[:, None] - samples[None, :, [0, 2]], axis=2).min(axis=1)
    assert gap.max() <= 1.0
    assert len(samples) < 4 * 600  # its area, within a factor


def test_inner_points_of_many_triangles_come_in_batches() -> None:
    rng = np.random.default_rng(1)
    corners = rng.uniform(0, 60, (600, 3)).astype(np.float32)
    corners[0:3] = 5.0  # a triangle without size
    faces = np.arange(600, dtype=np.uint32).reshape(-1, 3)
    batches = list(inner_points(corners, faces, 2.0, BOX))
    assert len(batches) > 1
    assert all(np.isfinite(batch).all() and len(batch) for batch in batches)


def test_inner_points_skip_what_stays_outside_the_box() -> None:
    corners = np.array([[0, 0, 0], [30, 0, 0], [0, 0, 40]], np.float32)
    faces = np.array([[0, 1, 2]], np.uint32)
    for shift in ([200.0, 0, 0], [0, -101.0, 0], [0, 0, -39.6], [0, 0, 100.0]):
        assert not sum(len(b) for b in inner_points(corners + np.float32(shift), faces, 1.0, BOX))
    assert sum(len(b) for b in inner_points(corners + np.float32([0, 0, -39.4]), faces, 1.0, BOX))


def test_tops_are_never_below_what_stands_there_and_little_above(tower: Airspace) -> None:
    roof = np.stack(np.meshgrid(np.arange(-19.5, 20.0), np.arange(-9.5, 10.0)), axis=-1)
    tops = tower.tops(roof)
    assert tops.min() >= 30.0
    assert tops.max() <= 34.0  # a layer of two metres, and one to spare
    plain = np.array([[30.0, 0.0], [0.0, 40.0], [500.0, 0.0]])
    np.testing.assert_array_equal(tower.tops(plain), 0.0)


def test_blocked_is_what_is_near_a_wall_a_roof_or_the_ground_and_what_lies_beyond_the_map(
    tower: Airspace,
) -> None:
    at = np.arange(-8.5, 9.5, 2.0)
    wall = np.stack([np.full(9, 20.4), at, np.full(9, 11.0)], axis=1)
    assert tower.blocked(wall).all()
    np.testing.assert_array_equal(tower.blocked(wall + np.array([6.0, 0.0, 0.0])), False)
    assert tower.blocked(
        np.array([[0.0, 0.0, 30.5], [0.0, 0.0, 31.9], [60.0, 0.0, 0.2], [300.0, 0.0, 50.0]])
    ).all()
    np.testing.assert_array_equal(tower.blocked(np.array([[0.0, 0.0, 36.1], [60.0, 0.0, 3.0]])), False)
