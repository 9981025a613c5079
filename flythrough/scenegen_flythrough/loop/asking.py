"""Asking a pilot for a decision, so that a pilot that fails costs its flights and nothing else."""

from __future__ import annotations

import queue
import threading
import time
from collections.abc import Callable
from dataclasses import dataclass, field

import numpy as np
from jaxtyping import Float32, Float64

from scenegen_flythrough.loop.pilot import Command, Decision, Observation, Pilot


@dataclass(frozen=True, eq=False)
class Answer:
    """What came of asking.

    Attributes
    ----------
    command : Command
        For every flight asked about; a failed flight is told to hover.
    depth_m : float32 (n, rows, columns) or None
        What the pilot took for the depth, if it says so and it has the right shape.
    latency_s : float64 (n,)
        What the pilot says it took, else its share of the time the answer took.
    failed : dict of int to str
        Reason for each flight whose pilot raised, stalled or gave no usable answer.
    """

    command: Command
    depth_m: Float32[np.ndarray, "n rows columns"] | None
    latency_s: Float64[np.ndarray, "n"]
    failed: dict[int, str] = field(default_factory=dict)


def ask(pilot: Pilot, seen: Observation, patience_s: float) -> Answer:
    """Ask for all flights at once and, where that fails, one by one, so that only those at fault are blamed.

    A pilot that stalls is left alone in its thread; whatever it still says is not listened to. It is not asked again
    for the other flights: all that were in the same question have failed.
    """
    decision, reason, took_s = _asked(lambda: pilot.act(seen), seen, patience_s)
    if decision is not None:
        return _answer(seen, decision, took_s, patience_s)
    if reason.startswith(_STALLED) or len(seen.flight) == 1:
        return _hover(seen, reason, took_s)
    single = [ask(pilot, seen.rows(np.array([k])), patience_s) for k in range(len(seen.flight))]
    return _together(single)


_STALLED = "stalled"


def _asked(
    act: Callable[[], Decision], seen: Observation, patience_s: float
) -> tuple[Decision | None, str, float]:
    """Decision, or the reason why there is none; and the time it took."""
    said: queue.SimpleQueue[Decision | BaseException] = queue.SimpleQueue()

    def work() -> None:
        try:
            said.put(act())
        except BaseException as error:  # a pilot is foreign code: SystemExit must not end the campaign either
            said.put(error)

    start = time.perf_counter()
    threading.Thread(target=work, daemon=True, name="pilot").start()
    try:
        answer = said.get(timeout=patience_s)
    except queue.Empty:
        return None, f"{_STALLED}: no answer within {patience_s:g} s", patience_s
    took_s = time.perf_counter() - start
    if isinstance(answer, BaseException):
        return None, f"raised {type(answer).__name__}: {_one_line(str(answer))}", took_s
    wrong = _wrong_shape(answer, len(seen.flight))
    return (None, wrong, took_s) if wrong else (answer, "", took_s)


def _wrong_shape(answer: object, count: int) -> str:
    """What is wrong with the form of an answer; empty if nothing is."""
    if not isinstance(answer, Decision) or not isinstance(answer.command, Command):
        return f"answered {type(answer).__name__} instead of a Decision with a Command"
    for name, array, shape in (
        ("velocity_mps", answer.command.velocity_mps, (count, 3)),
        ("yaw_rad", answer.command.yaw_rad, (count,)),
    ):
        if np.shape(array) != shape:
            return f"{name} of shape {np.shape(array)} instead of {shape}"
        if np.asarray(array).dtype.kind not in "fiu":
            return f"{name} of type {np.asarray(array).dtype}, not of numbers"
    if answer.latency_s is not None and np.shape(answer.latency_s) != (count,):
        return f"latency_s of shape {np.shape(answer.latency_s)} instead of {(count,)}"
    return ""


def _answer(seen: Observation, decision: Decision, took_s: float, patience_s: float) -> Answer:
    """Replace what is not finite by hovering, and blame those flights."""
    velocity = np.array(decision.command.velocity_mps, np.float64)
    yaw = np.array(decision.command.yaw_rad, np.float64)
    latency = np.full(len(yaw), took_s / len(yaw))
    if decision.latency_s is not None:
        latency = np.array(decision.latency_s, np.float64)
    failed: dict[int, str] = {}
    checks = (
        ("velocity_mps is not finite", np.isfinite(velocity).all(axis=1)),
        ("yaw_rad is not finite", np.isfinite(yaw)),
        ("latency_s is not a time", np.isfinite(latency) & (latency >= 0.0)),
        (f"{_STALLED}: a latency beyond {patience_s:g} s", ~(latency > patience_s)),
    )
    for what, passed in checks:
        good = np.asarray(passed)
        for k in np.flatnonzero(~good):
            failed.setdefault(int(seen.flight[k]), what)
        velocity[~good] = 0.0
        yaw[~good] = seen.yaw_rad[~good]
        latency[~good] = 0.0
    shape = (len(yaw), seen.camera.height_px, seen.camera.width_px)
    depth = decision.depth_m
    if depth is not None and np.shape(depth) != shape:
        depth = None
    return Answer(Command(velocity, yaw), depth, latency, failed)


def _hover(seen: Observation, reason: str, took_s: float) -> Answer:
    count = len(seen.flight)
    return Answer(
        command=Command(np.zeros((count, 3)), seen.yaw_rad.copy()),
        depth_m=None,
        latency_s=np.full(count, took_s / count),
        failed={int(flight): reason for flight in seen.flight},
    )


def _together(parts: list[Answer]) -> Answer:
    depths = [part.depth_m for part in parts if part.depth_m is not None]
    return Answer(
        command=Command(
            np.concatenate([part.command.velocity_mps for part in parts]),
            np.concatenate([part.command.yaw_rad for part in parts]),
        ),
        depth_m=np.concatenate(depths) if len(depths) == len(parts) else None,
        latency_s=np.concatenate([part.latency_s for part in parts]),
        failed={flight: reason for part in parts for flight, reason in part.failed.items()},
    )


def _one_line(text: str) -> str:
    return " ".join(text.split())[:200]
