"""Flights through box cities: everything a trajectory promises, judged against the boxes themselves."""

from __future__ import annotations

import numpy as np
import pytest

from routes import positions, solid_distance
from scenegen.foundation.rng import stream
from scenegen.world import World
from scenegen_flythrough.airspace import Airspace
from scenegen_flythrough.fly import fly
from scenegen_flythrough.knobs import STYLES, FlightKnobs
from scenegen_flythrough.trajectory import Trajectory

FLIGHTS = 64

FRAMES = 65

DRAWN = STYLES[:-1]

DENSE_S = 0.002


def knobs_of(index: int) -> FlightKnobs:
    """A spread of wishes: default, low and fast, low and slow, high, fine steps, coarse steps; every style in turn."""
    wishes: tuple[dict[str, object], ...] = (
        {},
        {"height_m": (3.0, 6.0), "speed_mps": 22.2},
        {"height_m": 4.0, "speed_mps": 3.0, "clearance_m": 0.4},
        {"height_m": (50.0, 70.0), "climb_deg": 5.0},
        {"spacing_m": 0.25, "pitch_deg": (-45.0, -30.0)},
        {"spacing_m": 2.5, "bank_deg": 20.0},
    )
    style = DRAWN[index % len(DRAWN)]
    spare = () if index // 6 % 2 == 0 else ("explore",)  # the hills have no streets
    return FlightKnobs.model_validate({"styles": (style, *spare), **wishes[index % len(wishes)]})


@pytest.fixture(scope="module")
def flights(city_air: Airspace, hills_air: Airspace) -> list[tuple[World, FlightKnobs, Trajectory]]:
    out = []
    for index in range(FLIGHTS):
        airspace, knobs = (city_air, hills_air)[index // 6 % 2], knobs_of(index)
        out.append(
            (airspace.world, knobs, fly(airspace.world, knobs, FRAMES, stream(7, "flight", index), airspace))
        )
    return out


def dense(trajectory: Trajectory) -> tuple[np.ndarray, np.ndarray]:
    """Instants of a flight every 2 ms, clip time, and where it is."""
    time_s = np.arange(trajectory.time_s[0], trajectory.time_s[-1], DENSE_S)
    return time_s, trajectory.motion.position.at(time_s + trajectory.zero_s)


def test_one_pose_more_at_both_ends_and_time_from_the_first_frame(flights) -> None:
    for _, knobs, trajectory in flights:
        assert trajectory.world_from_camera.shape == (FRAMES + 2, 4, 4)
        assert trajectory.time_s[1] == 0.0
        assert (np.diff(trajectory.time_s) > 0.0).all()
        way = (FRAMES + 1) * knobs.spacing_m
        assert trajectory.speed_mps == pytest.approx(way / np.ptp(trajectory.time_s), rel=1e-12)
        assert trajectory.speed_mps <= knobs.speed_mps[1] * 1.05
        assert trajectory.rejected == sum(count for _, count in trajectory.rejections)


def test_frames_are_equally_far_apart_along_the_way(flights) -> None:
    for _, knobs, trajectory in flights:
        time_s, path = dense(trajectory)
        way = np.concatenate([[0.0], np.cumsum(np.linalg.norm(np.diff(path, axis=0), axis=1))])
        at = np.interp(trajectory.time_s[:-1], time_s, way)
        np.testing.assert_allclose(np.diff(at), knobs.spacing_m, atol=2e-4)
        np.testing.assert_allclose(
            positions(trajectory),
            trajectory.motion.position.at(trajectory.time_s + trajectory.zero_s),
            atol=1e-12,
        )


def test_velocity_is_the_change_of_place(flights) -> None:
    for _, _, trajectory in flights:
        t, h = trajectory.time_s[1:-1] + trajectory.zero_s, 1e-3
        position = trajectory.motion.position
        change = (position.at(t + h) - position.at(t - h)) / (2 * h)
        np.testing.assert_allclose(trajectory.velocity_mps[1:-1], change, atol=1e-4)


def test_no_limit_is_ever_exceeded(flights) -> None:
    """Finite differences of places and attitudes every 2 ms, which know nothing of splines."""
    for _, knobs, trajectory in flights:
        limits = knobs.limits
        time_s, path = dense(trajectory)
        speed, pull, jerk = (np.diff(path, k, axis=0) / DENSE_S**k for k in (1, 2, 3))
        assert np.linalg.norm(speed, axis=1).max() <= limits.speed_mps
        assert np.linalg.norm(pull, axis=1).max() <= limits.acceleration_mps2
        assert (
            np.linalg.norm(jerk, axis=1).max() <= limits.jerk_mps3 + 1e-2
        )  # rounding of places over 2 ms cubed
        body = trajectory.motion.attitude(time_s + trajectory.zero_s).world_from_body
        tilt = np.degrees(np.arccos(np.clip(body[:, 2, 2], -1.0, 1.0)))
        assert tilt.max() <= limits.tilt_deg
        yaw = np.degrees(np.unwrap(np.arctan2(-body[:, 0, 1], body[:, 1, 1])))  # square to the left wing
        assert np.abs(np.diff(yaw)).max() / DENSE_S <= limits.yaw_rate_dps
        assert np.abs(np.diff(yaw, 2)).max() / DENSE_S**2 <= limits.yaw_acceleration_dps2 + 1e-2


def test_poses_are_rotations_in_the_camera_convention(flights) -> None:
    for _, _, trajectory in flights:
        pose = trajectory.world_from_camera
        rotation = pose[:, :3, :3]
        eye = np.broadcast_to(np.eye(3), rotation.shape)
        np.testing.assert_allclose(rotation.transpose(0, 2, 1) @ rotation, eye, atol=1e-12)
        np.testing.assert_allclose(np.linalg.det(rotation), 1.0, atol=1e-12)  # right-handed
        np.testing.assert_array_equal(pose[:, 3], np.broadcast_to([0.0, 0.0, 0.0, 1.0], (len(pose), 4)))
        assert (rotation[:, 2, 1] < 0).all()  # y points down


def test_the_nose_follows_the_course_or_the_thing_it_circles(flights) -> None:
    for _, _, trajectory in flights:
        ahead = trajectory.world_from_camera[1:-1, :2, 2]
        course = trajectory.velocity_mps[1:-1, :2]
        cosine = (ahead * course).sum(axis=1) / np.linalg.norm(ahead, axis=1) / np.linalg.norm(course, axis=1)
        if trajectory.style == "orbit":
            assert np.abs(np.degrees(np.arcsin(cosine))).max() < 25.0  # sideways, leaning
        else:
            assert np.degrees(np.arccos(np.clip(cosine, -1, 1))).max() < 45.0


def test_the_camera_shakes_on_its_mount_by_as_much_as_asked(city, city_air: Airspace) -> None:
    for asked in (0.0, 4.0):
        knobs = FlightKnobs(vibration_mrad=asked)
        trajectory = fly(city.world, knobs, 300, stream(12, "shake"), city_air)
        body = trajectory.motion.attitude(trajectory.time_s + trajectory.zero_s).world_from_body
        still = body @ trajectory.body_from_camera
        shake = np.einsum("nji,njk->nik", still, trajectory.world_from_camera[:, :3, :3])
        angles = np.stack([shake[:, 2, 1], shake[:, 0, 2], shake[:, 1, 0]])
        np.testing.assert_allclose(1e3 * angles.std(axis=1), asked, rtol=0.15, atol=1e-9)


def test_height_above_ground_stays_in_range(flights) -> None:
    for world, knobs, trajectory in flights:
        path = positions(trajectory)
        height = path[:, 2] - world.ground.at(path[:, :2])
        assert height.min() >= knobs.height_m[0] - knobs.height_slack_m
        assert height.max() <= knobs.height_m[1] + knobs.height_slack_m
        assert (path >= world.flight_box_m[0]).all()
        assert (path <= world.flight_box_m[1]).all()


def test_clearance_holds_along_the_whole_path(flights, city, hills) -> None:
    """Every 2 ms against the solid boxes: free of them, never inside, and `clearance_m` is true."""
    for world, knobs, trajectory in flights:
        boxes = (city if world is city.world else hills).boxes
        points = dense(trajectory)[1][::2]
        nearest = min(solid_distance(boxes, part).min() for part in np.array_split(points, 20))
        assert trajectory.clearance_m >= knobs.clearance_m
        assert nearest >= trajectory.clearance_m - 1e-5  # float32 corners against the exact boxes


def test_clearance_is_the_smallest_distance_to_box_or_ground(city, city_air: Airspace) -> None:
    """Over flat ground the truth is a closed form: the lower of height and box distance, at finely sampled points."""
    for index in range(12):
        trajectory = fly(city.world, FlightKnobs(), 33, stream(9, index), city_air)
        points = dense(trajectory)[1]
        truth = min(
            points[:, 2].min(), min(solid_distance(city.boxes, p).min() for p in np.array_split(points, 20))
        )
        assert trajectory.clearance_m == pytest.approx(truth, abs=5e-3)


def test_heights_and_headings_spread(city, city_air: Airspace) -> None:
    """Low flights are as likely as high ones although most free airspace is above the roofs."""
    knobs = FlightKnobs(styles="explore", height_m=(4.0, 64.0))
    flown = [positions(fly(city.world, knobs, 33, stream(3, i), city_air)) for i in range(60)]
    heights = np.array([path[:, 2].mean() for path in flown])
    counts = np.histogram(heights, bins=[4, 16, 28, 40, 52, 64])[0]
    assert counts.min() >= 4, counts
    course = np.array([np.arctan2(*(path[-1] - path[0])[[1, 0]]) for path in flown])
    assert np.histogram(course, bins=8, range=(-np.pi, np.pi))[0].min() >= 2
    starts = np.array([path[0, :2] for path in flown])
    assert (np.ptp(starts, axis=0) > 150.0).all()


def test_there_is_always_world_ahead(flights) -> None:
    """No pose looks over the edge of the world into nothing."""
    for world, _, trajectory in flights:
        ahead = trajectory.world_from_camera[1:, :2, 2]
        ahead = ahead / np.linalg.norm(ahead, axis=1, keepdims=True)
        edge = np.abs(world.ground.origin_m).max()
        assert np.abs(trajectory.world_from_camera[1:, :2, 3] + 30.0 * ahead).max() < edge


def test_same_generator_same_bytes(city, city_air: Airspace) -> None:
    first = fly(city.world, FlightKnobs(), 20, stream(1, "x"), city_air)
    again = fly(city.world, FlightKnobs(), 20, stream(1, "x"), Airspace(city.world))
    other = fly(city.world, FlightKnobs(), 20, stream(2, "x"), city_air)
    assert first.world_from_camera.tobytes() == again.world_from_camera.tobytes()
    assert (first.time_s.tobytes(), first.clearance_m, first.rejected) == (
        again.time_s.tobytes(), again.clearance_m, again.rejected,
    )  # fmt: skip
    assert first.world_from_camera.tobytes() != other.world_from_camera.tobytes()
