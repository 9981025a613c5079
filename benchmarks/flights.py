"""A thousand flights through real worlds, judged by arithmetic that shares nothing with what drew them.

    python benchmarks/flights.py [--map city coastline] [--each 36] [--worlds 2]

Limits: finite differences of places and attitudes every 2 ms. Clearance: the closest point of every triangle near the
way (Ericson, Real-Time Collision Detection, 2005, section 5.1.5), from places 5 cm apart, in float64, without the tree;
movers by all their vertices, every 20 ms. Prints what each style costs and why draws are rejected. Exits 1 if a flight
breaks a promise.
"""

from __future__ import annotations

import argparse
import sys
import time
from collections import Counter, defaultdict

import numpy as np

from scenegen.climate.season import Season
from scenegen.foundation.errors import RejectedDrawError
from scenegen.foundation.rng import stream
from scenegen.maps.registry import MAPS, build_world, map_family
from scenegen.movers.clock import Clock
from scenegen.movers.company import Company
from scenegen.world import World
from scenegen_flythrough.airspace import Airspace
from scenegen_flythrough.fly import fly
from scenegen_flythrough.knobs import STYLES, FlightKnobs
from scenegen_flythrough.trajectory import Trajectory

SEASON = Season(43.0, 7, 15)
FRAMES = 65
DENSE_S = 0.002
WISHES: tuple[dict[str, object], ...] = (
    {},
    {"speed_mps": (15.0, 22.2), "wind_mps": (6.0, 12.0)},
    {"height_m": (2.0, 6.0), "clearance_m": 0.5, "speed_mps": (2.0, 8.0)},
    {"height_m": (20.0, 120.0), "speed_mps": (3.0, 22.2)},
)
"""The default; fast and windy; low and near; high."""


def main() -> int:
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    parser.add_argument("--map", nargs="+", default=list(MAPS), choices=list(MAPS))
    parser.add_argument("--each", type=int, default=36, help="flights per map and style")
    parser.add_argument("--worlds", type=int, default=2)
    asked = parser.parse_args()
    broken = 0
    print(
        "map           style           flights  cpu s  rejected  worst share of v, a, j, tilt, yaw   slack m"
    )
    for name in asked.map:
        rows: dict[str, list[tuple[float, np.ndarray, float, Trajectory]]] = defaultdict(list)
        missing: Counter[str] = Counter()
        for number in range(asked.worlds):
            world = build_world(name, map_family(name).knobs(), SEASON, stream(number, "flights", name))
            airspace, triangles = Airspace(world), Triangles(world)
            for k in range(number, asked.each * len(STYLES[:-1]), asked.worlds):
                style, wish = STYLES[k % 7], WISHES[k // 7 % len(WISHES)]
                knobs = FlightKnobs.model_validate({"styles": style, **wish})
                start, clock = time.process_time(), Clock(17.0 * k)
                try:
                    flight = fly(world, knobs, FRAMES, stream(number, name, k), airspace, clock)
                except RejectedDrawError:
                    missing[style] += 1
                    continue
                cost = time.process_time() - start
                slack = min(triangles.clearance(flight), beside_movers(world, flight, clock))
                rows[style].append((cost, shares(flight, knobs), slack - knobs.clearance_m, flight))
        for style, flights in rows.items():
            broken += tell(name, style, flights, missing[style])
    print(f"{broken} flights break a promise")
    return 1 if broken else 0


def tell(
    name: str, style: str, flights: list[tuple[float, np.ndarray, float, Trajectory]], missing: int
) -> int:
    """Print one line; the number of flights that break a promise."""
    worst = np.max([share for _, share, _, _ in flights], axis=0)
    slack = np.array([s for _, _, s, _ in flights])
    why: Counter[str] = Counter()
    for *_, flight in flights:
        why.update(dict(flight.rejections))
    cost = np.mean([c for c, *_ in flights])
    reasons = ", ".join(f"{n} {key}" for key, n in why.most_common())
    print(
        f"{name:13} {style:15} {len(flights):7}  {cost:5.2f}  {why.total() / len(flights):8.1f}  "
        f"{'  '.join(f'{s:5.3f}' for s in worst)}   {slack.min():7.3f}   "
        f"({reasons}{f'; {missing} clips without a place' if missing else ''})",
        flush=True,
    )
    return sum(bool((share > 1.0 + 1e-3).any() or s < -1e-5) for _, share, s, _ in flights)


def shares(flight: Trajectory, knobs: FlightKnobs) -> np.ndarray:
    """Largest share of each limit that is used: speed, acceleration, jerk, tilt, yaw rate."""
    limits = knobs.limits
    t = np.arange(flight.time_s[0], flight.time_s[-1], DENSE_S) + flight.zero_s
    place = flight.motion.position.at(t)
    body = flight.motion.attitude(t).world_from_body
    yaw = np.unwrap(np.arctan2(-body[:, 0, 1], body[:, 1, 1]))
    size = [np.linalg.norm(np.diff(place, k, axis=0), axis=1).max() / DENSE_S**k for k in (1, 2, 3)]
    tilt = np.degrees(np.arccos(np.clip(body[:, 2, 2], -1.0, 1.0))).max()
    rate = np.degrees(np.abs(np.diff(yaw)).max() / DENSE_S)
    return np.array(
        [
            size[0] / limits.speed_mps,
            size[1] / limits.acceleration_mps2,
            size[2] / limits.jerk_mps3,
            tilt / limits.tilt_deg,
            rate / limits.yaw_rate_dps,
        ]
    )


def places(flight: Trajectory, step_m: float) -> tuple[np.ndarray, np.ndarray]:
    """Clip times at most a step of way apart, and places."""
    fastest = np.linalg.norm(flight.motion.position.differences(1), axis=1).max()
    count = int(np.ceil((flight.time_s[-1] - flight.time_s[0]) * fastest / step_m)) + 1
    time_s = np.linspace(flight.time_s[0], flight.time_s[-1], count)
    return time_s, flight.motion.position.at(time_s + flight.zero_s)


class Triangles:
    """The mesh as it is, with the bounds of each triangle."""

    def __init__(self, world: World) -> None:
        self._corners = world.mesh.vertices[world.mesh.faces]
        self._low, self._high = self._corners.min(axis=1), self._corners.max(axis=1)

    def clearance(self, flight: Trajectory, reach_m: float = 3.0) -> float:
        """Smallest distance of places 5 cm apart to any triangle, up to a reach."""
        path = places(flight, 0.05)[1]
        near = self._near(np.arange(len(self._low)), path, reach_m)
        best = reach_m
        for part in np.array_split(path, max(len(path) // 60, 1)):
            corners = self._corners[self._near(near, part, reach_m)].astype(np.float64)
            if len(corners):
                best = min(best, float(to_triangles(part, corners).min()))
        return best

    def _near(self, among: np.ndarray, path: np.ndarray, reach_m: float) -> np.ndarray:
        low, high = path.min(axis=0) - reach_m, path.max(axis=0) + reach_m
        for axis in range(3):
            among = among[(self._low[among, axis] <= high[axis]) & (self._high[among, axis] >= low[axis])]
        return among


def to_triangles(points: np.ndarray, corners: np.ndarray) -> np.ndarray:
    """Distances (points, triangles): the nearest of the three sides, or the foot of the plumb line if it is inside."""
    p = points[:, None, None]
    start, along = corners, np.roll(corners, -1, axis=1) - corners
    length2 = np.maximum((along**2).sum(axis=-1), 1e-30)
    t = np.clip(((p - start) * along).sum(axis=-1) / length2, 0.0, 1.0)
    sides = np.linalg.norm(p - start - t[..., None] * along, axis=-1).min(axis=2)
    normal = np.cross(along[:, 0], along[:, 1])
    area = np.linalg.norm(normal, axis=1)
    normal = normal / np.maximum(area, 1e-30)[:, None]
    inside = (np.cross(along, p - start) * normal[:, None]).sum(axis=-1) >= 0.0
    height = np.abs(((p[:, :, 0] - corners[:, 0]) * normal).sum(axis=-1))
    return np.where(inside.all(axis=2) & (area > 1e-12), height, sides)


def beside_movers(world: World, flight: Trajectory, clock: Clock, reach_m: float = 3.0) -> float:
    """Smallest distance to any vertex of a mover at the same instant, up to a reach."""
    if not world.movers:
        return reach_m
    time_s = np.arange(flight.time_s[0], flight.time_s[-1], 0.02)
    path = flight.motion.position.at(time_s + flight.zero_s)
    company, best = Company.of(world.movers), reach_m
    size = np.abs(company.box).max(axis=(1, 2)) * np.sqrt(3.0)
    gap = np.linalg.norm(company.poses_over(clock.at(time_s))[:, :, :3, 3] - path[:, None], axis=2) - size
    for k in np.flatnonzero((gap < reach_m).any(axis=0)):
        alone = Company.of([world.movers[k]])
        for i in np.flatnonzero(gap[:, k] < reach_m):
            here = alone.vertices(float(clock.at(time_s[i : i + 1])[0]))
            best = min(best, float(np.linalg.norm(here - path[i], axis=1).min()))
    return best


if __name__ == "__main__":
    sys.exit(main())
