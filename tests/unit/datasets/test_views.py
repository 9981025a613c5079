"""Where the pictures of a world are taken from."""

import math

import numpy as np
import pytest

from scenegen.materials.material import Surface
from scenegen.materials.table import material
from scenegen.world import World
from scenegen_datasets.pictures.views import bird_pose, looking_at, plan_pose
from scenegen_datasets.pictures.words import celsius, date, latitude, sky, time_of_day
from scenegen_render.reference_scenes import plate


@pytest.fixture(scope="module")
def world() -> World:
    return plate(Surface(material("granite"), 0.9, 0.7), 300.0)


def seen(pose: np.ndarray, points: np.ndarray) -> np.ndarray:
    """Image plane coordinates x / z, y / z of points, and z."""
    x, y, z = np.linalg.inv(pose)[:3] @ np.vstack([points.T, np.ones(len(points))])
    assert (z > 0).all()
    return np.stack([x / z, y / z], axis=1)


def corners(world: World) -> np.ndarray:
    low, high = np.asarray(world.flight_box_m)
    return np.array([[x, y, 0.0] for x in (low[0], high[0]) for y in (low[1], high[1])])


@pytest.mark.parametrize("eye", [(3.0, -4.0, 5.0), (0.0, 0.0, 9.0), (-7.0, 2.0, 0.1)])
def test_a_pose_looks_at_its_target_and_stands_upright(eye: tuple[float, float, float]) -> None:
    pose = looking_at(np.array(eye), np.zeros(3))
    np.testing.assert_allclose(pose[:3, :3] @ pose[:3, :3].T, np.eye(3), atol=1e-12)
    assert np.linalg.det(pose[:3, :3]) == pytest.approx(1.0)
    np.testing.assert_allclose(seen(pose, np.zeros((1, 3))), 0.0, atol=1e-12)
    assert pose[2, 0] == pytest.approx(0.0)  # the horizon is level
    assert pose[2, 1] <= 1e-12  # and the right way up


def test_the_plan_has_north_up_east_right_and_all_of_the_flight_box(world: World) -> None:
    places = np.array([[0.0, 100.0, 0.0], [100.0, 0.0, 0.0]])
    north, east = seen(plan_pose(world), places)
    assert abs(north[0]) < 1e-9 > north[1]
    assert abs(east[1]) < 1e-9 < east[0]
    edge = math.tan(math.radians(2.0))
    assert np.abs(seen(plan_pose(world), corners(world))).max() < edge


def test_the_bird_sees_the_middle_from_the_south_west_and_above(world: World) -> None:
    pose = bird_pose(world)
    assert pose[0, 3] < -100.0
    assert pose[1, 3] == pytest.approx(pose[0, 3])
    assert pose[2, 3] > 100.0
    np.testing.assert_allclose(seen(pose, np.zeros((1, 3))), 0.0, atol=1e-9)


def test_words_above_pictures() -> None:
    assert (time_of_day(5.2), time_of_day(23.999), time_of_day(0.0)) == (
        "05:12 solar time",
        "23:59 solar time",
        "00:00 solar time",
    )
    assert (date(2, 9), latitude(-12.4), latitude(48.0)) == ("9 Feb", "12°S", "48°N")
    assert latitude(-0.4) == latitude(0.4) == "0°"
    assert (sky(0.1), sky(0.5), sky(0.95), celsius(273.15)) == ("clear", "4/8 cloud", "overcast", "0 °C")
