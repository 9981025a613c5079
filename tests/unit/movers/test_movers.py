"""Routes without jumps, crowds that never meet, bodies on the ground, boats on the water; the same every time."""

from __future__ import annotations

import numpy as np
import pytest
import shapely

from scenegen.climate.season import Season
from scenegen.geometry.builder import GeometryBuilder
from scenegen.geometry.placement import rectangles
from scenegen.materials.palette import PaletteBuilder
from scenegen.movers.clock import Clock
from scenegen.movers.company import Company
from scenegen.movers.drive import drive
from scenegen.movers.mover import Mover
from scenegen.movers.play import play
from scenegen.movers.rounds import Pace, ring_route, there_and_back
from scenegen.movers.route import HEADING, TRAVELLED, Timetable
from scenegen.movers.sail import anchor, sail
from scenegen.movers.stroll import stroll
from scenegen.parts.workshop import Workshop

RING = np.array([[0.0, 0.0], [0.0, 80.0], [60.0, 80.0], [60.0, 0.0]])
CAR = Pace(12.0, 2.0, 1.5, 1.6, leans=True)


def hills(xy: np.ndarray) -> np.ndarray:
    return np.asarray(1.5 * np.sin(xy[:, 0] / 30.0) + 0.02 * xy[:, 1])


def shop() -> Workshop:
    rng = np.random.default_rng(0)
    return Workshop(hills, PaletteBuilder(rng), GeometryBuilder(), Season(50.0, 7, 1))


def crowd(seed: int) -> tuple[Mover, ...]:
    """A bit of everything, at one place each."""
    rng, at = np.random.default_rng(seed), shop()
    far = np.array([1000.0, 0.0])
    pitch = np.array([[0.0, 0.0], [100.0, 0.0], [100.0, 60.0], [0.0, 60.0]]) - far
    place, heading = RING * 4.0 + 2.0 * far, np.zeros(4)
    return (
        *drive([RING], 4.0, at, rng, mix={"car": 0.5, "van": 0.2, "bus": 0.2, "truck": 0.1}),
        *stroll([there_and_back(np.array([[100.0, 0.0], [150.0, 10.0]]), 0.5)], 10.0, at, rng),
        *play(pitch, 22, at, rng),
        *sail([RING * 5.0 + far], 10.0, at, rng, water=hills),
        *anchor(place, heading, ["rowing", "sailing", "motor", "fishing"], at, rng, water=hills),
    )


@pytest.fixture(scope="module")
def company() -> Company:
    return Company.of(crowd(1))


def test_a_route_is_smooth_in_place_and_heading_also_where_its_round_ends():
    route = ring_route(RING, hills, CAR)
    step = 0.02
    times = np.arange(0.0, 2.2 * route.round_s, step)
    states = Timetable.of([route.starting(0.3)]).over(times)[:, 0]
    velocity = np.diff(states[:, :3], axis=0) / step
    speed = np.linalg.norm(velocity, axis=1)
    assert speed.min() > 1.0 and speed.max() < 12.6
    assert np.abs(np.diff(velocity, axis=0) / step).max() < 9.0  # no jump of the velocity
    turn = np.angle(np.exp(1j * np.diff(states[:, HEADING]))) / step
    assert np.abs(turn).max() < 2.5
    np.testing.assert_allclose(np.diff(states[:, TRAVELLED]) / step, speed, rtol=0.06, atol=0.05)


def test_it_drives_in_the_order_of_the_points_on_the_ground_and_slower_in_bends():
    route = ring_route(RING, hills, CAR, lift_m=0.25)
    times = np.linspace(0.0, route.round_s, 400)
    states = Timetable.of([route]).over(times)[:, 0]
    np.testing.assert_allclose(states[:, 2], hills(states[:, :2]) + 0.25, atol=0.02)
    assert not shapely.LinearRing(states[:-1, :2]).is_ccw
    ahead = np.gradient(states[:, :2], times, axis=0)
    course = np.arctan2(ahead[:, 1], ahead[:, 0])
    assert np.abs(np.angle(np.exp(1j * (course - states[:, HEADING]))))[2:-2].max() < 0.12
    corner = np.abs(states[:, None, :2] - RING).sum(axis=2).min(axis=1) < 3.0
    speed = np.linalg.norm(ahead, axis=1)
    assert speed[corner].max() < 0.6 * speed.max()


def test_a_pose_is_rigid_and_leans_with_the_slope():
    route = ring_route(RING, hills, CAR)
    for time in (0.0, 5.0, 17.3):
        pose = route.pose(time)
        np.testing.assert_allclose(pose[:3, :3] @ pose[:3, :3].T, np.eye(3), atol=1e-12)
        assert np.linalg.det(pose[:3, :3]) > 0.0
        corners = (pose @ np.array([[2.0, 0, 0, 1], [-2.0, 0, 0, 1], [0, 0.9, 0, 1], [0, -0.9, 0, 1]]).T).T
        np.testing.assert_allclose(corners[:, 2], hills(corners[:, :2]), atol=0.06)


def test_there_and_back_keeps_to_the_right_of_the_line():
    line = np.array([[0.0, 0.0], [100.0, 0.0]])
    route = ring_route(there_and_back(line, 2.0), lambda xy: np.zeros(len(xy)), CAR)
    states = Timetable.of([route]).over(np.linspace(0.0, route.round_s, 300))[:, 0]
    middle = (states[:, 0] > 10.0) & (states[:, 0] < 90.0)
    eastwards = np.cos(states[:, HEADING]) > 0.0
    np.testing.assert_allclose(states[middle & eastwards, 1], -2.0, atol=0.1)
    np.testing.assert_allclose(states[middle & ~eastwards, 1], 2.0, atol=0.1)


def test_nobody_meets_anybody(company: Company):
    middle, size = company.box.mean(axis=1)[:, :2], np.ptp(company.box, axis=1)
    rigid = np.array([m.kind not in ("person", "player") for m in company.movers])
    size[~rigid, 0] = 0.4  # of people the trunks, whose arms swing past each other
    for time in np.arange(0.0, 240.0, 4.0):
        pose = company.poses(float(time))
        place = pose[:, :2, 3] + np.einsum("nij,nj->ni", pose[:, :2, :2], middle)
        shapes = rectangles(place, size[:, 0], size[:, 1], np.arctan2(pose[:, 1, 0], pose[:, 0, 0]))
        first, second = shapely.STRtree(shapes).query(shapes, predicate="intersects")
        assert (first == second).all(), (time, first[first != second])


def test_feet_and_wheels_touch_the_ground(company: Company):
    for time in (0.0, 3.3, 50.1):
        vertices = company.vertices(time)
        for k, mover in enumerate(company.movers):
            own = vertices[company.first[k] : company.first[k + 1]]
            above = own[:, 2] - hills(own[:, :2])
            if mover.kind != "boat":
                assert -0.12 < above.min() < 0.05, mover.kind
            else:
                assert above.min() < 0.0 < above.max()


def test_a_walker_moves_its_limbs_and_a_car_does_not(company: Company):
    for mover in company.movers:
        k = company.movers.index(mover)
        own = slice(company.first[k], company.first[k + 1])
        local = []
        for time in (10.0, 10.35):
            pose = company.poses(time)[k]
            local.append((company.vertices(time)[own] - pose[:3, 3]) @ pose[:3, :3])
        change = np.abs(local[1] - local[0]).max()
        assert change > 0.03 if mover.gait is not None else change < 1e-9


def test_gaits_pass_through_their_own_key_poses(company: Company):
    walker = next(m for m in company.movers if m.gait is not None)
    assert walker.gait is not None
    np.testing.assert_allclose(
        walker.gait.cycle[0][:, :2], walker.body.vertices[:, :2], atol=1e-5
    )  # rest pose: start of the step
    low, high = walker.box_m
    assert (walker.gait.cycle >= low - 1e-6).all() and (walker.gait.cycle <= high + 1e-6).all()


def test_boats_bob(company: Company):
    k = next(i for i, m in enumerate(company.movers) if m.kind == "boat" and m.route.rows[-1, TRAVELLED] == 0)
    poses = company.poses_over(np.arange(0.0, 60.0, 0.1))[:, k]
    heave, roll = poses[:, 2, 3], np.arcsin(poses[:, 2, 1])
    assert 0.01 < heave.std() < 0.2 and 0.002 < roll.std() < 0.2
    assert np.ptp(poses[:, 0, 3]) == 0.0


def test_every_mover_has_an_id_of_its_own_and_two_builds_are_equal():
    one, two, other = crowd(1), crowd(1), crowd(2)
    ids = [m.object for m in one]
    assert len(set(ids)) == len(ids) and all((m.body.object == m.object).all() for m in one)
    assert {m.kind for m in one} >= {"car", "person", "player", "boat"}
    for a, b in zip(one, two, strict=True):
        assert a.route.rows.tobytes() == b.route.rows.tobytes() and a.route.start_s == b.route.start_s
        assert a.body.vertices.tobytes() == b.body.vertices.tobytes()
        assert a.body.surface.tobytes() == b.body.surface.tobytes()
    assert len(other) != len(one) or other[0].route.start_s != one[0].route.start_s


def test_a_stopped_clock_shows_the_same_moment_for_ever():
    times = np.array([-1.0, 0.0, 7.0])
    assert (Clock.stopped().at(times) == 0.0).all()
    drawn = Clock.draw(np.random.default_rng(0))
    np.testing.assert_allclose(drawn.at(times), drawn.start_s + times)
    assert drawn == Clock.draw(np.random.default_rng(0)) != Clock.draw(np.random.default_rng(1))
