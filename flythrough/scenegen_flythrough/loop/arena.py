"""All flights of a batch in one world: where they are, what they touch, how they ended."""

from __future__ import annotations

import numpy as np
from jaxtyping import Float32, Float64, Int64, UInt16

from scenegen.classes import Semantic
from scenegen.movers.clock import Clock
from scenegen_flythrough.loop.asking import Answer
from scenegen_flythrough.loop.contact import Obstacles
from scenegen_flythrough.loop.drone import DroneState, advance, camera_poses
from scenegen_flythrough.loop.knobs import LoopKnobs
from scenegen_flythrough.loop.log import FlightLog
from scenegen_flythrough.loop.missions import Missions
from scenegen_flythrough.loop.outcome import End, Outcome
from scenegen_flythrough.loop.pilot import Command, Observation
from scenegen_flythrough.loop.wind import Gusts
from scenegen_render.camera import Camera

_SUB_STEP_S = 0.05
"""Longest step of the dynamics: at 6 m/s^2 the path bends less than 2 mm off its chord, which is what is swept."""
_CLOSEST_M = 3.0
"""How far away anything is looked for when the closest approach is noted."""


class Arena:
    """Flights that advance together.

    Parameters
    ----------
    obstacles : Obstacles
    clock : Clock
        World time of flight time zero.
    missions : Missions
    knobs : LoopKnobs

    Attributes
    ----------
    flying : int64 (n,)
        Ids of the flights that have not ended, increasing: the rows of everything asked and answered.
    time_s : float
        Since the start.
    """

    def __init__(self, obstacles: Obstacles, clock: Clock, missions: Missions, knobs: LoopKnobs) -> None:
        self._obstacles, self._clock, self._missions, self._knobs = obstacles, clock, missions, knobs
        self._gusts = Gusts.draw(knobs.wind, [np.random.Generator(np.random.PCG64(s)) for s in missions.wind])
        self._alive = np.ones(len(missions.flight), np.bool_)
        self._state = DroneState.resting(missions.start_m, missions.yaw_rad)
        self._command = Command(np.zeros_like(missions.start_m), missions.yaw_rad.copy())
        self._log = [FlightLog(*ends) for ends in zip(missions.start_m, missions.goal_m, strict=True)]
        self._limit_s = knobs.time_factor / knobs.cruise_mps * np.array([log.way_m for log in self._log])
        self._outcomes: dict[int, Outcome] = {}

    @property
    def flying(self) -> Int64[np.ndarray, "n"]:
        """Ids of the flights that have not ended."""
        return self._missions.flight[self._alive]

    @property
    def time_s(self) -> float:
        """Since the start of all flights."""
        return self._state.time_s

    @property
    def world_time_s(self) -> float:
        """What the movers go by."""
        return self._world_time(self.time_s)

    def poses(self) -> Float64[np.ndarray, "n 4 4"]:
        """`world_from_camera` of the flights that have not ended, now."""
        poses = camera_poses(self._state, self._knobs.mount_pitch_deg, stabilised=self._knobs.stabilised)
        return poses[self._alive]

    def observe(
        self,
        camera: Camera,
        depth_m: Float32[np.ndarray, "n rows columns"] | None = None,
        counts: UInt16[np.ndarray, "n rows columns"] | None = None,
        previous_counts: UInt16[np.ndarray, "n rows columns"] | None = None,
    ) -> Observation:
        """What the pilot is shown now; images row by row as `flying` and `poses` are."""
        alive = self._alive
        return Observation(
            flight=self.flying,
            time_s=self.time_s,
            position_m=self._state.position_m[alive],
            velocity_mps=self._state.velocity_mps[alive],
            yaw_rad=self._state.yaw_rad[alive],
            goal_m=self._missions.goal_m[alive],
            ceiling_m=self._missions.ceiling_m[alive],
            camera=camera,
            world_from_camera=self.poses(),
            counts=counts,
            previous_counts=previous_counts,
            depth_m=depth_m,
        )

    def advance(self, answer: Answer) -> None:
        """Fly until the next decision; ends the flights whose pilot failed where they are.

        The new command acts after the latency, rounded up to a sub-step; until then the old one does. A latency beyond
        the decision period makes the step that long: a slow pilot sees fewer frames.
        """
        rows = np.flatnonzero(self._alive)
        latency = np.zeros(len(self._alive))
        latency[rows] = self._latency(answer)
        new = Command(self._command.velocity_mps.copy(), self._command.yaw_rad.copy())
        new.velocity_mps[rows], new.yaw_rad[rows] = answer.command.velocity_mps, answer.command.yaw_rad
        for row in rows.tolist():
            self._log[row].decided(float(latency[row]))
            reason = answer.failed.get(int(self._missions.flight[row]))
            if reason is not None:
                self._end(row, "pilot", self.time_s, reason=reason)
        step_s = max([self._knobs.decision_s, *latency[self._alive].tolist()])
        count = int(np.ceil(step_s / _SUB_STEP_S - 1e-9))
        for k in range(count):
            acts = latency <= k * (step_s / count) + 1e-9
            velocity = np.where(acts[:, None], new.velocity_mps, self._command.velocity_mps)
            yaw = np.where(acts, new.yaw_rad, self._command.yaw_rad)
            self._fly(Command(velocity, yaw), step_s / count)
        self._command = new
        for row in np.flatnonzero(self._alive).tolist():
            self._log[row].mark(self.time_s)

    def outcomes(self) -> tuple[Outcome, ...]:
        """Of the flights that have ended, by id."""
        return tuple(self._outcomes[flight] for flight in sorted(self._outcomes))

    def _fly(self, command: Command, dt_s: float) -> None:
        """One sub-step of all drones; those that touch something or arrive end on the way."""
        before = self._state
        after = advance(before, command, self._knobs.drone, self._gusts.at(before.time_s), dt_s)
        self._state = after
        rows = np.flatnonzero(self._alive)
        starts, ends = before.position_m[rows], after.position_m[rows]
        t0, t1 = self._world_time(before.time_s), self._world_time(after.time_s)
        contacts = self._obstacles.first_contacts(starts, ends, t0, t1, self._knobs.radius_m)
        arrival = _first_within(starts, ends, self._missions.goal_m[rows], self._knobs.goal_radius_m)
        closest = self._obstacles.distance(ends, t1, _CLOSEST_M)
        for k, row in enumerate(rows.tolist()):
            share = min(float(contacts.share[k]), float(arrival[k]))
            time_s = before.time_s + min(share, 1.0) * dt_s
            hit = contacts.share[k] <= arrival[k] and np.isfinite(share)
            place = starts[k] + min(share, 1.0) * (ends[k] - starts[k])
            self._log[row].moved(place, self._knobs.radius_m if hit else float(closest[k]))
            if hit:
                self._end(row, "collision", time_s, int(contacts.object[k]), int(contacts.semantic[k]))
            elif np.isfinite(share):
                self._end(row, "goal", time_s)
            elif time_s >= self._limit_s[row]:
                self._end(row, "timeout", time_s)

    def _end(
        self, row: int, kind: End, time_s: float, object: int = 0, semantic: int = 0, reason: str = ""
    ) -> None:
        log, flight = self._log[row], int(self._missions.flight[row])
        log.mark(time_s)
        east, north, up = log.path[-1, 1:].tolist()
        self._alive[row] = False
        self._outcomes[flight] = Outcome(
            flight=flight,
            kind=kind,
            time_s=time_s,
            place_m=(east, north, up),
            object=object,
            semantic=semantic,
            class_name=Semantic(semantic).name.lower() if kind == "collision" else "",
            progress=1.0 if kind == "goal" else log.progress,
            mean_speed_mps=log.length_m / time_s if time_s > 0.0 else 0.0,
            closest_m=log.closest_m,
            latency_s=log.latency_s,
            decisions=log.decisions,
            path=log.path,
            reason=reason,
        )

    def _latency(self, answer: Answer) -> Float64[np.ndarray, "n"]:
        """Delay of each answer [s]."""
        if self._knobs.latency == "measured":
            return answer.latency_s
        return np.full(len(answer.latency_s), self._knobs.latency_ms / 1e3)

    def _world_time(self, time_s: float) -> float:
        return float(self._clock.at(np.array([time_s]))[0])


def _first_within(
    starts: Float64[np.ndarray, "n 3"],
    ends: Float64[np.ndarray, "n 3"],
    centre: Float64[np.ndarray, "n 3"],
    radius_m: float,
) -> Float64[np.ndarray, "n"]:
    """Share 0..1 of each segment where it enters a ball; 0 if it starts inside, +inf if it stays outside."""
    along, off = ends - starts, starts - centre
    a, b = (along * along).sum(axis=1), (along * off).sum(axis=1)
    c = (off * off).sum(axis=1) - radius_m**2
    under = b * b - a * c
    root = (-b - np.sqrt(np.maximum(under, 0.0))) / np.where(a > 0.0, a, 1.0)
    enters = (under >= 0.0) & (a > 0.0) & (root >= 0.0) & (root <= 1.0)
    return np.where(c <= 0.0, 0.0, np.where(enters, root, np.inf))
