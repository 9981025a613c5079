"""A pilot that fails costs the flights at fault, with a reason, and nothing else."""

from __future__ import annotations

import threading
from dataclasses import dataclass

import numpy as np
import pytest

from scenegen_flythrough.loop.asking import ask
from scenegen_flythrough.loop.pilot import Command, Decision, Observation
from scenegen_render.camera import Camera


def question(count: int = 4) -> Observation:
    zero = np.zeros((count, 3))
    return Observation(
        flight=10 + np.arange(count),
        time_s=0.0,
        position_m=zero,
        velocity_mps=zero,
        yaw_rad=np.full(count, 0.25),
        goal_m=zero + 9.0,
        ceiling_m=np.full(count, 50.0),
        camera=Camera.from_fov(8, 4, 90.0),
        world_from_camera=np.tile(np.eye(4), (count, 1, 1)),
        depth_m=np.ones((count, 4, 8), np.float32),
    )


@dataclass
class Scripted:
    """Answers what a function makes of the question."""

    act: object
    name: str = "scripted"
    needs: frozenset = frozenset()

    def begin(self, flights, seed):
        """Nothing to forget."""


def misshapen(velocity: np.ndarray, yaw: np.ndarray) -> Decision:
    """What a pilot could hand over where nobody checks shapes."""
    command = Command(np.zeros((1, 3)), np.zeros(1))
    object.__setattr__(command, "velocity_mps", velocity)
    object.__setattr__(command, "yaw_rad", yaw)
    return Decision(command)


def good(seen: Observation) -> Decision:
    count = len(seen.flight)
    return Decision(Command(np.ones((count, 3)), np.zeros(count)), seen.depth_m)


def test_a_good_answer_comes_through():
    answer = ask(Scripted(good), question(), 60.0)
    assert answer.failed == {}
    np.testing.assert_array_equal(answer.command.velocity_mps, 1.0)
    assert answer.depth_m is not None
    assert (answer.latency_s >= 0.0).all()


def test_numbers_that_are_none_fail_their_flights_only():
    def act(seen):
        decision = good(seen)
        decision.command.velocity_mps[1, 2] = np.nan
        decision.command.yaw_rad[3] = np.inf
        return decision

    answer = ask(Scripted(act), question(), 60.0)
    assert answer.failed == {11: "velocity_mps is not finite", 13: "yaw_rad is not finite"}
    assert np.isfinite(answer.command.velocity_mps).all()
    np.testing.assert_array_equal(answer.command.velocity_mps[1], 0.0)
    assert answer.command.yaw_rad[3] == 0.25


def test_who_raises_for_one_flight_fails_that_flight():
    def act(seen):
        if 12 in seen.flight:
            raise RuntimeError("no idea\nwhat this is")
        return good(seen)

    answer = ask(Scripted(act), question(), 60.0)
    assert answer.failed == {12: "raised RuntimeError: no idea what this is"}
    np.testing.assert_array_equal(answer.command.velocity_mps[:, 0], [1.0, 1.0, 0.0, 1.0])
    assert answer.depth_m is None  # one of the four said nothing


@pytest.mark.parametrize(
    ("answer", "reason"),
    [
        (None, "answered NoneType instead of a Decision with a Command"),
        (misshapen(np.zeros((2, 3)), np.zeros(4)), "velocity_mps of shape (2, 3) instead of (1, 3)"),
        (
            misshapen(np.zeros((1, 3)), np.zeros((1, 1))),
            "yaw_rad of shape (1, 1) instead of (1,)",
        ),
    ],
)
def test_an_answer_of_the_wrong_form_fails_with_its_form(answer, reason):
    told = ask(Scripted(lambda seen: answer), question(), 60.0)
    assert told.failed == dict.fromkeys(range(10, 14), reason)
    np.testing.assert_array_equal(told.command.velocity_mps, 0.0)


def test_exit_in_a_pilot_does_not_end_the_campaign():
    def act(seen):
        raise SystemExit(3)

    assert ask(Scripted(act), question(2), 60.0).failed == dict.fromkeys((10, 11), "raised SystemExit: 3")


def test_who_stalls_fails():
    never = threading.Event()

    def act(seen):
        never.wait()
        return good(seen)

    answer = ask(Scripted(act), question(), 0.15)
    never.set()
    assert answer.failed == dict.fromkeys(range(10, 14), "stalled: no answer within 0.15 s")


def test_a_latency_beyond_patience_is_a_stall_too():
    def act(seen):
        decision = good(seen)
        return Decision(decision.command, None, np.array([0.1, 900.0, -1.0, np.nan]))

    failed = ask(Scripted(act), question(), 60.0).failed
    assert failed == {
        11: "stalled: a latency beyond 60 s",
        12: "latency_s is not a time",
        13: "latency_s is not a time",
    }


def test_depth_of_another_shape_is_not_kept():
    def act(seen):
        return Decision(good(seen).command, np.ones((4, 2, 2), np.float32))

    answer = ask(Scripted(act), question(), 60.0)
    assert answer.failed == {}
    assert answer.depth_m is None
