"""The loop as a whole, in a city of boxes: missions, flights, ends, and that nothing depends on company."""

from __future__ import annotations

import numpy as np
import pytest

from scenegen.foundation.errors import InputError, RejectedDrawError
from scenegen.movers.clock import Clock
from scenegen_flythrough.loop.arena import Arena
from scenegen_flythrough.loop.asking import Answer, ask
from scenegen_flythrough.loop.knobs import LoopKnobs, MissionKnobs, WindKnobs
from scenegen_flythrough.loop.missions import Missions, draw_missions
from scenegen_flythrough.loop.pilot import Command
from scenegen_flythrough.loop.pilots import ConstantDepth, DepthPilot, TrueDepth
from scenegen_flythrough.planners.registry import PLANNERS, planner

CLOCK = Clock()
HARD = MissionKnobs(difficulty=0.5, distance_m=40.0, height_m=(3.0, 10.0))


@pytest.fixture(scope="module")
def missions(city_air, city_obstacles) -> Missions:
    return draw_missions(city_air, city_obstacles, CLOCK, HARD, 0.35, 8, np.random.default_rng(1), 100)


def some(missions: Missions, rows: list[int]) -> Missions:
    return Missions(
        missions.flight[rows], missions.start_m[rows], missions.goal_m[rows], missions.yaw_rad[rows],
        missions.ceiling_m[rows], missions.obstructed[rows], tuple(missions.wind[k] for k in rows),
    )  # fmt: skip


def fly(obstacles, missions, knobs, pilot, camera, look=None, boxes=None):
    arena = Arena(obstacles, CLOCK, missions, knobs)
    pilot.begin(missions.flight, 0)
    while len(arena.flying):
        depth = None if look is None else look(boxes, camera, arena.poses())
        arena.advance(ask(pilot, arena.observe(camera, depth_m=depth), knobs.patience_s))
    return arena.outcomes()


def hover(count: int, failed: dict[int, str] | None = None, latency_s: float = 0.0) -> Answer:
    still = Command(np.zeros((count, 3)), np.zeros(count))
    return Answer(still, None, np.full(count, latency_s), failed or {})


def test_missions_hold_what_they_promise(missions, city, city_obstacles):
    assert missions.flight.tolist() == list(range(100, 108))
    way = missions.goal_m - missions.start_m
    np.testing.assert_allclose(np.hypot(way[:, 0], way[:, 1]), 40.0)
    assert missions.obstructed.sum() == 4
    touches = city_obstacles.proximity.sweep(missions.start_m, missions.goal_m, 0.35).touches
    np.testing.assert_array_equal(touches, missions.obstructed)
    low, high = city.boxes[:, 0], city.boxes[:, 1]
    for place in (missions.start_m, missions.goal_m):
        gap = np.maximum(np.maximum(low - place[:, None], place[:, None] - high), 0.0)
        assert (np.sqrt((gap**2).sum(axis=2)) >= 2.0).all()
        assert ((place[:, 2] >= 3.0) & (place[:, 2] <= 10.0)).all()
    np.testing.assert_allclose(
        missions.ceiling_m, np.maximum(missions.start_m[:, 2], missions.goal_m[:, 2]) + 12.0
    )


@pytest.mark.parametrize(("difficulty", "hard"), [(0.0, 0), (1.0, 10)])
def test_difficulty_is_the_share_of_obstructed_missions(city_air, city_obstacles, difficulty, hard):
    asked = HARD.model_copy(update={"difficulty": difficulty})
    drawn = draw_missions(city_air, city_obstacles, CLOCK, asked, 0.35, 10, np.random.default_rng(2))
    assert drawn.obstructed.sum() == hard


def test_missions_repeat_and_a_world_without_them_says_so(missions, city_air, city_obstacles):
    again = draw_missions(city_air, city_obstacles, CLOCK, HARD, 0.35, 8, np.random.default_rng(1), 100)
    np.testing.assert_array_equal(again.start_m, missions.start_m)
    far = HARD.model_copy(update={"distance_m": 500.0})
    with pytest.raises(RejectedDrawError, match="500 m"):
        draw_missions(city_air, city_obstacles, CLOCK, far, 0.35, 1, np.random.default_rng(1))


def test_the_blind_crash_exactly_where_the_way_is_obstructed(missions, city_obstacles, camera):
    calm = LoopKnobs(wind=WindKnobs(mean_mps=0.0))
    pilot = DepthPilot(ConstantDepth(), planner("straight", calm))
    outcomes = fly(city_obstacles, missions, calm, pilot, camera)
    assert [o.flight for o in outcomes] == list(range(100, 108))
    assert [o.kind == "collision" for o in outcomes] == missions.obstructed.tolist()
    for o, start, goal in zip(outcomes, missions.start_m, missions.goal_m, strict=True):
        np.testing.assert_allclose(o.path[0], [0.0, *start])
        np.testing.assert_allclose(o.path[-1], [o.time_s, *o.place_m])
        assert (np.diff(o.path[:, 0]) > 0.0).all()
        if o.kind == "goal":
            assert o.progress == 1.0
            assert np.linalg.norm(goal - o.place_m) == pytest.approx(calm.goal_radius_m, abs=1e-6)
        else:
            place = np.array([o.place_m])
            assert city_obstacles.proximity.distance(place)[0] == pytest.approx(0.35, abs=1e-4)
            assert o.closest_m == 0.35
            assert 0.0 <= o.progress < 1.0
        assert o.latency_s == pytest.approx(0.1)
        assert o.mean_speed_mps <= calm.cruise_mps + 0.3


def test_the_oracle_with_waypoint_reaches_its_goals(missions, city, city_obstacles, camera, look):
    knobs = LoopKnobs()
    pilot = DepthPilot(TrueDepth(), planner("waypoint", knobs))
    outcomes = fly(city_obstacles, some(missions, [0, 1, 2, 3]), knobs, pilot, camera, look, city.boxes)
    assert "collision" not in {o.kind for o in outcomes}
    assert sum(o.kind == "goal" for o in outcomes) >= 3


def test_a_flight_does_not_depend_on_its_company(missions, city_obstacles, camera):
    knobs = LoopKnobs(wind=WindKnobs(mean_mps=8.0))
    pilot = DepthPilot(ConstantDepth(), planner("straight", knobs))
    together = fly(city_obstacles, missions, knobs, pilot, camera)
    for rows in ([3], [5, 7]):
        for own in fly(city_obstacles, some(missions, rows), knobs, pilot, camera):
            twin = next(o for o in together if o.flight == own.flight)
            np.testing.assert_array_equal(own.path, twin.path)
            assert (own.kind, own.time_s, own.place_m) == (twin.kind, twin.time_s, twin.place_m)


def test_who_hovers_runs_out_of_time_and_who_fails_ends_at_once(missions, city_obstacles, camera):
    knobs = LoopKnobs(time_factor=1.0, cruise_mps=20.0, wind=WindKnobs(mean_mps=0.0))
    arena = Arena(city_obstacles, CLOCK, some(missions, [0, 1]), knobs)
    arena.advance(hover(2, {101: "raised ValueError: no"}))
    assert arena.flying.tolist() == [100]
    failed = arena.outcomes()[0]
    assert (failed.kind, failed.time_s, failed.reason) == ("pilot", 0.0, "raised ValueError: no")
    while len(arena.flying):
        arena.advance(hover(1))
    waited = arena.outcomes()[0]
    assert waited.kind == "timeout"
    way = np.linalg.norm(missions.goal_m[0] - missions.start_m[0])
    assert waited.time_s == pytest.approx(way / 20.0, abs=0.051)
    assert waited.progress == 0.0


def test_a_command_acts_after_the_latency(missions, city_obstacles):
    ahead = Answer(Command(np.array([[5.0, 0.0, 0.0]]), np.zeros(1)), None, np.array([0.45]))
    for knobs, step_s, still_s in (
        (LoopKnobs(latency_ms=0.0), 0.2, 0.0),
        (LoopKnobs(latency_ms=150.0), 0.2, 0.15),
        (LoopKnobs(latency="measured"), 0.45, 0.45),
    ):
        calm = knobs.model_copy(update={"wind": WindKnobs(mean_mps=0.0)})
        arena = Arena(city_obstacles, CLOCK, some(missions, [0]), calm)
        arena.advance(ahead)
        assert arena.time_s == pytest.approx(step_s)
        moved = float(arena.poses()[0, 0, 3] - missions.start_m[0, 0])
        assert (moved > 0.0) == (still_s < step_s)
        arena.advance(ahead)
        assert arena.poses()[0, 0, 3] > missions.start_m[0, 0]


def test_planners_are_found_by_name_and_by_module():
    knobs = LoopKnobs(cruise_mps=3.0)
    for name in PLANNERS:
        assert planner(name, knobs).name == name
    assert planner("scenegen_flythrough.planners.waypoint:Waypoint", knobs).name == "waypoint"
    with pytest.raises(InputError, match="perhaps you meant 'waypoint'"):
        planner("waypont", knobs)
    with pytest.raises(InputError, match="cannot import 'nowhere_at_all'"):
        planner("nowhere_at_all:Planner", knobs)
    with pytest.raises(InputError, match="has no 'Missing'"):
        planner("scenegen_flythrough.planners.waypoint:Missing", knobs)
    with pytest.raises(InputError, match="made no planner"):
        planner("builtins:str", knobs)
