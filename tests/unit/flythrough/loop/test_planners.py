"""What planners make of depth: closed forms for what a picture proves, and decisions in simple places."""

from __future__ import annotations

import math

import numpy as np
import pytest

from scenegen_flythrough.loop.drone import DroneState, advance, camera_poses
from scenegen_flythrough.loop.knobs import LoopKnobs
from scenegen_flythrough.loop.pilot import Command, Observation
from scenegen_flythrough.planners.detour import next_detour
from scenegen_flythrough.planners.five_section import STOP_M, SWITCH_M, FiveSection, band_depths
from scenegen_flythrough.planners.foresight import stopping_speed, then_stop
from scenegen_flythrough.planners.sight import FREE, HIT, UNKNOWN, Seen, sights
from scenegen_flythrough.planners.straight import Straight
from scenegen_flythrough.planners.waypoint import Waypoint
from scenegen_render.camera import Camera

CAMERA = Camera.from_fov(256, 144, 90.0)
FAR = np.full((1, 144, 256), np.inf, np.float32)


def seen_from(state: DroneState, goal: tuple[float, float, float], camera: Camera = CAMERA) -> Observation:
    count = len(state.yaw_rad)
    return Observation(
        flight=np.arange(count),
        time_s=state.time_s,
        position_m=state.position_m,
        velocity_mps=state.velocity_mps,
        yaw_rad=state.yaw_rad,
        goal_m=np.tile(np.array(goal), (count, 1)),
        ceiling_m=np.full(count, 60.0),
        camera=camera,
        world_from_camera=camera_poses(state, 0.0, stabilised=True),
    )


def at_rest(yaw: float = 0.0) -> DroneState:
    return DroneState.resting(np.array([[0.0, 0.0, 10.0]]), np.array([yaw]))


def test_a_picture_proves_what_it_looks_past_and_no_more():
    """A wall 10 m ahead, eastwards; the camera stands at (0, 0, 10)."""
    wall = np.full((1, 144, 256), 10.0, np.float32)
    pose = camera_poses(at_rest(), 0.0, stabilised=True)
    sight = sights(wall, CAMERA, pose, 0.0)[0]
    points = np.array([[5.0, 0, 10], [9.4, 0, 10], [9.6, 0, 10], [10.4, 0, 10], [10.6, 0, 10], [20.0, 0, 10]])
    assert sight.ask(points, 0.5, 0.0).tolist() == [FREE, FREE, HIT, HIT, UNKNOWN, UNKNOWN]
    beside = np.array([[-3.0, 0, 10], [5.0, 5.5, 10], [5.0, 0.0, 13.0], [5.0, 4.0, 10.0], [0.6, 0.0, 10.0]])
    # behind; beyond the edge; above; near the edge but inside; too near to fit into the picture
    assert sight.ask(beside, 0.5, 0.0).tolist() == [UNKNOWN, UNKNOWN, UNKNOWN, FREE, UNKNOWN]
    assert sight.ask(beside[4:], 0.5, 1.2).tolist() == [FREE]


@pytest.mark.parametrize("row", [40, 72, 100])
@pytest.mark.parametrize("column", [30, 128, 200])
def test_one_pixel_forbids_exactly_the_balls_that_cover_it(row, column):
    """A speck in an empty picture, against the true distance of balls from the ray through its pixel."""
    depth = FAR.copy()
    depth[0, row, column] = 8.0
    pose = camera_poses(at_rest(), 0.0, stabilised=True)
    sight = sights(depth, CAMERA, pose, 0.0)[0]
    local = np.array([(column + 0.5 - 128) / 128, (row + 0.5 - 72) / 128, 1.0]) * 8.0
    speck = pose[0, :3, :3] @ local + pose[0, :3, 3]
    rng = np.random.default_rng(row + column)
    points = speck + rng.normal(0.0, 0.8, (1000, 3))
    told = sight.ask(points, 0.5, 0.0)
    apart = np.linalg.norm(points - speck, axis=1)
    assert (told[apart < 0.5] == HIT).mean() > 0.99
    assert not (told[apart < 0.5] == FREE).any()
    beside = np.abs((points - speck) @ pose[0, :3, :3])[:, :2].max(axis=1)
    wide = (beside > 1.4) & (told != UNKNOWN)
    assert (told[wide] == FREE).all()
    assert wide.sum() > 20


def test_what_left_the_picture_stays_known_for_a_while():
    memory = Seen(5, 1.0, math.radians(20.0), 0.5)
    aside = np.array([[4.0, 0.0, 10.0]])
    for k in range(12):
        state = at_rest(0.3 * k)
        wall = np.full((1, 144, 256), 30.0, np.float32)
        memory.add(sights(wall, CAMERA, camera_poses(state, 0.0, stabilised=True), 0.2 * k)[0])
        known = memory.free(aside, 0.5, 1.2, 1.0)[0]
        if k == 4:
            assert known  # 69 degrees beside the axis, long out of the picture
    assert not known  # and forgotten


def test_a_wire_seen_once_is_believed_though_the_next_picture_misses_it():
    memory = Seen(5, 1.0, math.radians(20.0), 0.5)
    pose = camera_poses(at_rest(), 0.0, stabilised=True)
    wire = FAR.copy()
    wire[0, 72, ::9] = 6.0
    point = np.array([[6.0, 0.0, 10.0]])
    memory.add(sights(FAR, CAMERA, pose, 0.0)[0])
    assert memory.free(point, 0.5, 1.2, 1.0)[0]
    moved = pose.copy()
    memory.add(sights(wire, CAMERA, moved, 0.2)[0])
    assert not memory.free(point, 0.5, 1.2, 1.0)[0]
    moved = pose.copy()
    moved[0, 0, 3] += 1.5
    memory.add(sights(FAR, CAMERA, moved, 0.4)[0])
    assert not memory.free(point, 0.5, 1.2, 1.0)[0]


def test_foresight_is_what_the_drone_then_does():
    knobs = LoopKnobs()
    now, before, told = np.array([[4.0, 0.0, 0.0]]), np.array([[5.0, 0.0, 0.0]]), np.array([[3.0, 4.0, 0.0]])
    zero = np.zeros((1, 3))
    foreseen = then_stop(zero, now, before, told, knobs)[0]
    state = DroneState(zero, now, zero, np.zeros(1), 0.0)
    flown = []
    for k in range(80):
        command = before if k * 0.05 < 0.1 - 1e-9 else told if k * 0.05 < 0.3 - 1e-9 else zero
        state = advance(state, Command(command, np.zeros(1)), knobs.drone, zero, 0.05)
        flown.append(state.position_m[0])
    np.testing.assert_allclose(foreseen[-1], flown[-1], atol=0.25)
    apart = np.linalg.norm(np.array(flown)[:, None] - foreseen, axis=2).min(axis=1)
    assert apart.max() < 0.3
    assert np.linalg.norm(np.diff(foreseen, axis=0)[-1]) < 0.03  # it has come to rest


@pytest.mark.parametrize("way_m", [1.0, 5.0, 20.0, 60.0])
def test_from_the_stopping_speed_one_stops_within_the_way(way_m):
    knobs = LoopKnobs(drone=LoopKnobs().drone.model_copy(update={"speed_mps": 22.0}))
    speed = float(stopping_speed(np.array([way_m]), knobs)[0])
    v = np.array([[speed, 0.0, 0.0]])
    end = then_stop(np.zeros((1, 3)), v, v, v, knobs)[0, -1, 0]
    assert 0.6 * way_m < end < way_m + 0.2


def fly_in(depth_of, goal, steps: int, planner, knobs: LoopKnobs) -> list[DroneState]:
    """Fly a planner in a place whose depth images a function makes; still air."""
    state, own, states = at_rest(), planner.memory(), []
    command = Command(np.zeros((1, 3)), np.zeros(1))
    for _ in range(steps):
        depth = depth_of(camera_poses(state, 0.0, stabilised=True)[0])[None]
        new = planner.plan(depth, seen_from(state, goal), [own])
        for k in range(4):
            state = advance(state, command if k < 2 else new, knobs.drone, np.zeros((1, 3)), 0.05)
            states.append(state)
        command = new
    return states


def wall_with_gap(x_m: float, gap_m: float, at_m: float = 0.0):
    """Depth of an endless wall across the way with a gap from the ground to the sky."""

    def depth(pose: np.ndarray) -> np.ndarray:
        v, u = np.mgrid[0:144, 0:256] + 0.5
        rays = np.stack([(u - 128) / 128, (v - 72) / 128, np.ones_like(u)], axis=-1) @ pose[:3, :3].T
        with np.errstate(divide="ignore", invalid="ignore"):
            t = (x_m - pose[0, 3]) / rays[..., 0]
            y = pose[1, 3] + t * rays[..., 1]
        met = (t > 0.0) & (np.abs(y - at_m) > 0.5 * gap_m)
        return np.where(met, t, np.inf).astype(np.float32)

    return depth


def test_waypoint_stops_before_a_wall_without_end():
    knobs = LoopKnobs()
    states = fly_in(wall_with_gap(25.0, 0.0), (60.0, 0.0, 10.0), 60, Waypoint(knobs), knobs)
    furthest = max(float(s.position_m[0, 0]) for s in states)
    assert 20.0 < furthest < 25.0 - knobs.radius_m
    assert max(float(np.linalg.norm(s.velocity_mps)) for s in states) > 5.0


@pytest.mark.parametrize(("gap_m", "at_m"), [(2.2, 4.0), (3.0, -9.0)])
def test_waypoint_goes_through_a_gap_little_wider_than_itself(gap_m, at_m):
    knobs = LoopKnobs()
    states = fly_in(wall_with_gap(25.0, gap_m, at_m), (45.0, 0.0, 10.0), 140, Waypoint(knobs), knobs)
    path = np.array([s.position_m[0] for s in states])
    crossing = np.abs(path[np.argmax(path[:, 0] >= 25.0), 1] - at_m)
    assert path[:, 0].max() > 40.0
    assert crossing < 0.5 * gap_m - knobs.radius_m
    near = np.abs(path[:, 0] - 25.0) < knobs.radius_m
    assert (np.abs(path[near, 1] - at_m) < 0.5 * gap_m - 0.25).all()


def test_waypoint_does_not_climb_above_its_ceiling():
    knobs = LoopKnobs()
    planner, own, state = Waypoint(knobs), Waypoint(knobs).memory(), at_rest()
    for _ in range(30):
        seen = seen_from(state, (30.0, 0.0, 25.0))
        object.__setattr__(seen, "ceiling_m", np.array([12.0]))
        command = planner.plan(FAR, seen, [own])
        for _ in range(4):
            state = advance(state, command, knobs.drone, np.zeros((1, 3)), 0.05)
    assert 10.3 < state.position_m[0, 2] < 12.1


def test_blind_is_straight():
    """Constant depth hides every wall: the planner heads for its goal as if nothing were there."""
    knobs = LoopKnobs()
    blind = lambda pose: np.full((144, 256), 100.0, np.float32)  # noqa: E731
    states = fly_in(blind, (40.0, 6.0, 12.0), 45, Waypoint(knobs), knobs)
    path = np.array([s.position_m[0] for s in states])
    way = np.array([40.0, 6.0, 2.0]) / np.linalg.norm([40.0, 6.0, 2.0])
    off = (path - [0.0, 0.0, 10.0]) - ((path - [0.0, 0.0, 10.0]) @ way)[:, None] * way
    assert np.linalg.norm(off, axis=1).max() < 0.3
    assert path[-1, 0] > 35.0


def bands(*metres: float) -> np.ndarray:
    """A picture with one depth per band in the upper half; the lower half is ground right below."""
    depth = np.full((1, 144, 256), 0.5, np.float32)
    for k, value in enumerate(metres):
        depth[0, :72, round(k * 51.2) : round((k + 1) * 51.2)] = value
    return depth


def test_five_sections_are_judged_by_their_nearest_pixel():
    depth = bands(30.0, 40.0, 50.0, np.inf, 70.0)
    depth[0, 10, 240] = 3.0
    np.testing.assert_allclose(band_depths(depth), [[30.0, 40.0, 50.0, 100.0, 3.0]])


@pytest.mark.parametrize(
    ("metres", "turn_deg", "moves"),
    [
        ((50.0, 50.0, 50.0, 50.0, 50.0), 0.0, True),
        ((50.0, 50.0, 50.0, 50.0, 50.0 + SWITCH_M - 0.1), 0.0, True),  # not enough to leave the middle
        ((50.0, 50.0, 50.0, 50.0, 50.0 + SWITCH_M + 0.1), -36.0, True),
        ((50.0 + SWITCH_M + 1.0, 20.0, 50.0, 20.0, 50.0), 36.0, True),
        ((5.0, 6.0, STOP_M - 0.1, 6.0, 5.0), 0.0, False),  # nowhere to go
        ((5.0, 12.0, STOP_M - 0.1, 6.0, 5.0), 18.0, False),  # stands, and turns
    ],
)
def test_five_section_decides_as_documented(metres, turn_deg, moves):
    command = FiveSection().plan(bands(*metres), seen_from(at_rest(), (80.0, 0.0, 10.0)), [None])
    assert math.degrees(command.yaw_rad[0]) == pytest.approx(turn_deg)
    speed = np.linalg.norm(command.velocity_mps[0])
    assert speed == pytest.approx(6.0 if moves else 0.0)
    if moves:
        assert math.degrees(math.atan2(*command.velocity_mps[0, 1::-1])) == pytest.approx(turn_deg)


def test_five_section_seeks_its_goal_where_nothing_is_in_the_way():
    free = bands(*[100.0] * 5)
    for goal, turn in (((0.0, 80.0, 10.0), 18.0), ((0.0, -80.0, 10.0), -18.0), ((80.0, 5.0, 10.0), 0.0)):
        command = FiveSection().plan(free, seen_from(at_rest(), goal), [None])
        assert math.degrees(command.yaw_rad[0]) == pytest.approx(turn)
    high = FiveSection().plan(free, seen_from(at_rest(), (80.0, 0.0, 11.0)), [None])
    assert high.velocity_mps[0, 2] == pytest.approx(0.7)


def test_straight_heads_for_the_goal_and_slows_down_there():
    far = Straight(8.0).plan(FAR, seen_from(at_rest(), (30.0, 40.0, 10.0)), [None])
    np.testing.assert_allclose(far.velocity_mps, [[4.8, 6.4, 0.0]])
    assert far.yaw_rad[0] == pytest.approx(math.atan2(4.0, 3.0))
    near = Straight(8.0).plan(FAR, seen_from(at_rest(1.0), (0.0, 0.0, 12.0)), [None])
    np.testing.assert_allclose(near.velocity_mps, [[0.0, 0.0, 2.0]])
    assert near.yaw_rad[0] == 1.0


def test_a_detour_keeps_its_side_until_it_pays_or_its_patience_ends():
    goal, left, right = np.array([50.0, 0.0, 0.0]), np.array([0.0, 1.0, 0.0]), np.array([0.0, -1.0, 0.0])
    ahead = np.array([1.0, 0.0, 0.0])
    assert next_detour(None, ahead, goal, 50.0, 0.0) is None
    begun = next_detour(None, left, goal, 50.0, 0.0)
    cost = begun.cost(np.stack([ahead, left, right]), goal)
    assert cost[0] == cost[1] == 0.0
    assert cost[2] > 1.0
    assert next_detour(begun, left, goal, 55.0, 15.0) == begun  # further away, but patient
    nearer = next_detour(begun, left, goal, 48.0, 15.0)
    assert (
        next_detour(nearer, left, goal, 60.0, 34.0).side == begun.side
    )  # patience counts from the last gain
    other = next_detour(nearer, left, goal, 60.0, 36.0)
    assert other.side == -begun.side
    assert other.patience_s == 2.0 * begun.patience_s
    assert next_detour(begun, ahead, goal, 49.5, 5.0) is not None  # free, but hardly nearer
    assert next_detour(begun, ahead, goal, 47.0, 5.0) is None
