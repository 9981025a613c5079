"""Goal-directed flight by the depth map: look for the direction that leads on, go as fast as one can still stop.

Of all directions around the drone those that are seen to be free far enough are weighed: how far they turn away from
the goal, how far from where the drone was going (hysteresis), how soon they end. The best few are then flown ahead in
thought with the drone's own dynamics, each at several speeds: the old command for the latency, the new one for a
period, then full brakes. A motion is taken only if the drone's ball, widened by a margin, is known to be free all
along it; if none is, the drone brakes, which the decision before has kept possible.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass, field

import numpy as np
from jaxtyping import Bool, Float32, Float64, Int64

from scenegen_flythrough.loop.knobs import LoopKnobs
from scenegen_flythrough.loop.pilot import Command, Observation
from scenegen_flythrough.planners.detour import Detour, next_detour
from scenegen_flythrough.planners.fan import fan
from scenegen_flythrough.planners.foresight import stopping_speed, then_stop
from scenegen_flythrough.planners.sight import Seen, sights

_MARGIN_M = 0.2
"""Kept around the drone: gusts, the gaps between pixels, and what the controller leaves."""
_NEAR_RADII = 2.4
"""A ball nearer than this many radii does not fit into the picture."""
_SPACING_M, _TURN_DEG, _KEEP = 1.0, 20.0, 10
"""Pictures kept: one a metre or 20 degrees, ten of them,"""
_FRESH_S = 0.9
"""among them all that are younger than this: a wire may show in one and fall between the pixels of the next."""
_HIT_S = 2.5
"""How long a surface that was seen is believed to be there, whatever newer pictures say: wires fall between pixels."""
_CHOSEN = 10
"""Directions flown ahead in thought."""
_SHARES = (1.0, 0.6, 0.3)
"""Speeds tried, as shares of the fastest from which one can stop."""
_AHEAD = 5.0
"""A direction that is free for so many stopping ways is as good as one without end."""
_DEAD_END, _SWERVE, _SLOW = 1.5, 0.3, 0.5
"""What weighs against a direction, beside its angle off the goal [rad]: that it ends here, each radian off the last
decision, and standing still instead of cruising."""
_SEARCH = 0.35
"""How much more slowly the drone flies across its way."""
_GLANCE_RAD = math.radians(25.0)
"""How far the nose turns from the way flown towards the goal, so that gaps beside the way are seen."""
_LOOK_RAD = math.radians(40.0)
"""How far the nose turns in one decision when nothing is free [rad]."""


@dataclass(eq=False)
class WaypointMemory:
    """What the planner keeps of one flight.

    Attributes
    ----------
    seen : Seen
    heading : float64 (3,) or None
        Direction chosen last.
    told_mps : float64 (3,)
        Command given last.
    side : float
        +1 or -1: to which side it turns when nothing is free; 0 before it first had to.
    stuck : int
        Decisions in a row without a free motion.
    detour : Detour or None
    """

    seen: Seen = field(default_factory=lambda: Seen(_KEEP, _SPACING_M, np.deg2rad(_TURN_DEG), _FRESH_S))
    heading: Float64[np.ndarray, "3"] | None = None
    told_mps: Float64[np.ndarray, "3"] = field(default_factory=lambda: np.zeros(3))
    side: float = 0.0
    stuck: int = 0
    detour: Detour | None = None


@dataclass(frozen=True, eq=False)
class _Choice:
    """Motions weighed for one flight, best first.

    Attributes
    ----------
    velocity_mps : float64 (motions, 3)
    cost : float64 (motions,)
    """

    velocity_mps: Float64[np.ndarray, "motions 3"]
    cost: Float64[np.ndarray, "motions"]


@dataclass(frozen=True)
class Waypoint:
    """See the module."""

    knobs: LoopKnobs
    name: str = "waypoint"

    def memory(self) -> WaypointMemory:
        """Nothing seen yet."""
        return WaypointMemory()

    def plan(
        self,
        depth_m: Float32[np.ndarray, "n rows columns"],
        seen: Observation,
        memory: Sequence[WaypointMemory],
    ) -> Command:
        """One decision for each flight."""
        for own, sight in zip(
            memory, sights(depth_m, seen.camera, seen.world_from_camera, seen.time_s), strict=True
        ):
            own.seen.add(sight)
        told = np.array([own.told_mps for own in memory]).reshape(-1, 3)
        # Where the drone will be when the command reaches it.
        from_m = seen.position_m + seen.velocity_mps * (self.knobs.latency_ms / 1e3)
        choices = [self._weigh(k, from_m[k], seen, own) for k, own in enumerate(memory)]
        safe = self._safe(seen, told, choices, memory)
        velocity, yaw = np.zeros_like(told), seen.yaw_rad.copy()
        for k, (own, choice) in enumerate(zip(memory, choices, strict=True)):
            good = np.flatnonzero(safe[k])
            if len(good):
                velocity[k] = choice.velocity_mps[good[0]]
                own.heading = velocity[k] / np.linalg.norm(velocity[k])
                own.stuck, own.side = 0, own.side if own.stuck else 0.0
                way = seen.goal_m[k] - seen.position_m[k]
                left = float(np.linalg.norm(way))
                own.detour = next_detour(own.detour, velocity[k], way, left, seen.time_s)
                yaw[k] = _look(velocity[k], way, float(yaw[k]))
            else:
                yaw[k] = self._look_round(k, seen, own)
            own.told_mps = velocity[k]
        return Command(velocity, yaw)

    def _weigh(
        self, k: int, from_m: Float64[np.ndarray, "3"], seen: Observation, own: WaypointMemory
    ) -> _Choice:
        """The best few directions, each at several speeds."""
        knobs = self.knobs
        way = seen.goal_m[k] - from_m
        left = float(np.linalg.norm(way))
        direction = fan(float(seen.yaw_rad[k]), way / max(left, 1e-9), own.heading)
        range_m = self._range(direction, from_m, own)
        room = np.where(
            direction[:, 2] > 1e-3,
            (seen.ceiling_m[k] - from_m[2]) / np.maximum(direction[:, 2], 1e-3),
            np.inf,
        )
        range_m = np.minimum(range_m, np.maximum(room, 0.0))
        enough = min(left, _AHEAD * self._reach_m)
        off = np.arccos(np.clip(direction @ way / max(left, 1e-9), -1.0, 1.0))
        cost = off + _DEAD_END * np.maximum(1.0 - range_m / enough, 0.0)
        if own.detour is not None:
            cost += own.detour.cost(direction, way)
        if own.heading is not None:
            cost += _SWERVE * np.arccos(np.clip(direction @ own.heading, -1.0, 1.0))
        # Beside the way one searches: slowly enough to see what opens.
        cruise = min(knobs.cruise_mps, max(1.5, left)) * (
            1.0 - _SEARCH * np.minimum(off / (0.5 * np.pi), 1.0) ** 2
        )
        speed = np.minimum(stopping_speed(range_m, knobs), cruise)
        cost[speed < 0.2] = np.inf
        best = np.argsort(cost, kind="stable")[:_CHOSEN]
        best = best[np.isfinite(cost[best])]
        share = np.array(_SHARES)
        velocity = (direction[best] * speed[best, None])[:, None] * share[:, None]
        total = cost[best, None] + _SLOW * (1.0 - share * speed[best, None] / knobs.cruise_mps)
        order = np.argsort(total.ravel(), kind="stable")
        return _Choice(velocity.reshape(-1, 3)[order], total.ravel()[order])

    @property
    def _reach_m(self) -> float:
        """Way on which the drone comes to rest from cruise speed."""
        knobs = self.knobs
        late = knobs.latency_ms / 1e3 + knobs.decision_s + 0.3
        return knobs.cruise_mps * late + 0.5 * knobs.cruise_mps**2 / knobs.drone.acceleration_mps2

    @property
    def _ball_m(self) -> float:
        return self.knobs.radius_m + _MARGIN_M

    def _range(
        self, direction: Float64[np.ndarray, "fan 3"], from_m: Float64[np.ndarray, "3"], own: WaypointMemory
    ) -> Float64[np.ndarray, "fan"]:
        """How far each direction is known to be free [m]."""
        far = max(30.0, 2.5 * self._reach_m)
        mark = np.geomspace(_NEAR_RADII * self._ball_m, far, 14)
        points = from_m + mark[:, None] * direction[:, None]
        free = self._free(points.reshape(-1, 3), own).reshape(len(direction), -1)
        known = np.cumprod(free, axis=1).sum(axis=1)
        return np.asarray(np.concatenate([[0.0], mark])[known])

    def _free(
        self, points: Float64[np.ndarray, "points 3"], own: WaypointMemory
    ) -> Bool[np.ndarray, "points"]:
        return own.seen.free(points, self._ball_m, _NEAR_RADII * self._ball_m, _HIT_S)

    def _safe(
        self,
        seen: Observation,
        told_mps: Float64[np.ndarray, "n 3"],
        choices: Sequence[_Choice],
        memory: Sequence[WaypointMemory],
    ) -> list[Bool[np.ndarray, "motions"]]:
        """Which motions stay in free space until the drone has come to rest."""
        count = [len(choice.cost) for choice in choices]
        if not sum(count):
            return [np.zeros(0, np.bool_) for _ in count]
        row: Int64[np.ndarray, "motions"] = np.repeat(np.arange(len(count)), count)
        velocity = np.concatenate([choice.velocity_mps for choice in choices])
        places = then_stop(seen.position_m[row], seen.velocity_mps[row], told_mps[row], velocity, self.knobs)
        safe = []
        for k, own in enumerate(memory):
            mine = _thinned(places[row == k], 0.5 * self._ball_m)
            free = self._free(mine.reshape(-1, 3), own).reshape(mine.shape[:2])
            # The drone is where it is: the ball around it is free, whatever the pictures tell.
            free |= np.linalg.norm(mine - seen.position_m[k], axis=2) < 0.3
            safe.append(np.asarray(free.all(axis=1)))
        return safe

    def _look_round(self, k: int, seen: Observation, own: WaypointMemory) -> float:
        """Heading when nothing is free: on to the side begun with, first the one the goal lies on."""
        own.stuck += 1
        yaw = float(seen.yaw_rad[k])
        if own.side == 0.0:
            way = seen.goal_m[k] - seen.position_m[k]
            off = float(np.angle(np.exp(1j * (np.arctan2(way[1], way[0]) - yaw))))
            own.side = 1.0 if off >= 0.0 else -1.0
        return yaw + own.side * _LOOK_RAD


def _look(velocity_mps: Float64[np.ndarray, "3"], way: Float64[np.ndarray, "3"], yaw_rad: float) -> float:
    """Heading along the flight, with a glance towards the goal; the old one if the flight is upright."""
    if np.hypot(velocity_mps[0], velocity_mps[1]) < 0.2:
        return yaw_rad
    course = float(np.arctan2(velocity_mps[1], velocity_mps[0]))
    off = float(np.angle(np.exp(1j * (np.arctan2(way[1], way[0]) - course))))
    return course + min(max(off, -_GLANCE_RAD), _GLANCE_RAD)


def _thinned(
    places: Float64[np.ndarray, "motions steps 3"], spacing_m: float
) -> Float64[np.ndarray, "motions s 3"]:
    """Every so many places, so that none is further from the next than a spacing; the last is kept."""
    step = float(np.linalg.norm(np.diff(places, axis=1), axis=2).max(initial=1e-9))
    stride = max(1, int(spacing_m / step))
    keep = np.unique(np.append(np.arange(stride - 1, places.shape[1], stride), places.shape[1] - 1))
    return places[:, keep]
