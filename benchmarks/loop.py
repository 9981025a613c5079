"""Closed-loop flights of a pilot on each map: how they end, what they hit, and the CPU time of a decision step.

Depth alone is traced, no heat: enough for the oracle (true depth) and the blind (constant depth). Missions, winds and
movers are the same for every pilot. For each collision the class that was hit is told, whether it moved, and how far
beside the camera's axis it lay when the last picture was taken.

    python benchmarks/loop.py [--map city] [--pilot oracle blind] [--planner waypoint] [--flights 50] [--speed 6]
"""

from __future__ import annotations

import argparse
import time
from collections import Counter
from dataclasses import dataclass, field

import numpy as np
from places import SEASON, machine

from scenegen.foundation.rng import stream
from scenegen.maps.registry import MAPS, build_world, map_family
from scenegen.movers.clock import Clock
from scenegen_flythrough.airspace import Airspace
from scenegen_flythrough.loop.arena import Arena
from scenegen_flythrough.loop.asking import ask
from scenegen_flythrough.loop.contact import Obstacles
from scenegen_flythrough.loop.knobs import DroneLimits, LoopKnobs, MissionKnobs, WindKnobs
from scenegen_flythrough.loop.missions import draw_missions
from scenegen_flythrough.loop.outcome import Outcome
from scenegen_flythrough.loop.pilots import ConstantDepth, DepthPilot, TrueDepth
from scenegen_flythrough.planners.registry import planner
from scenegen_render.camera import Camera
from scenegen_render.scene import load
from scenegen_render.trace.scenery import scenery
from scenegen_render.trace.views import Views

BATCH = 25
SOURCES = {"oracle": TrueDepth, "blind": ConstantDepth}


@dataclass
class Tally:
    """What came of the flights of one pilot on one map."""

    outcomes: list[Outcome] = field(default_factory=list)
    obstructed: int = 0
    steps: int = 0
    cpu_s: Counter[str] = field(default_factory=Counter)
    aside_deg: dict[int, float] = field(default_factory=dict)


class Place:
    """A world to fly in."""

    def __init__(self, name: str, world: int, camera: Camera) -> None:
        built = build_world(name, map_family(name).knobs(), SEASON, stream(world, "benchmark", "world"))
        self.airspace = Airspace(built)
        self.obstacles = Obstacles(built, self.airspace.proximity)
        self.views, self.scenery, self.camera = Views(camera), scenery(load(built)), camera

    def fly(self, asked: argparse.Namespace, pilot: str) -> Tally:
        knobs = LoopKnobs(
            cruise_mps=asked.speed,
            latency_ms=asked.latency,
            drone=DroneLimits(speed_mps=max(asked.speed, DroneLimits().speed_mps)),
            wind=WindKnobs(mean_mps=asked.wind),
        )
        tally = Tally()
        for batch in range(asked.flights // BATCH):
            clock = Clock.draw(stream(asked.seed, "clock", batch))
            rng = stream(asked.seed, "missions", batch)
            wanted = MissionKnobs(difficulty=asked.difficulty)
            missions = draw_missions(
                self.airspace, self.obstacles, clock, wanted, knobs.radius_m, BATCH, rng, batch * BATCH
            )
            flown = DepthPilot(SOURCES[pilot](), planner(asked.planner, knobs))
            flown.begin(missions.flight, 0)
            tally.obstructed += int(missions.obstructed.sum())
            self._batch(Arena(self.obstacles, clock, missions, knobs), flown, knobs, tally)
        return tally

    def _batch(self, arena: Arena, pilot: DepthPilot, knobs: LoopKnobs, tally: Tally) -> None:
        while len(arena.flying):
            flying, poses = arena.flying, arena.poses()
            tally.steps += len(flying)
            marks = [time.process_time()]
            depth = None
            if "depth" in pilot.needs:
                depth = self.views.look(self.scenery, poses, arena.world_time_s).depth
            marks.append(time.process_time())
            answer = ask(pilot, arena.observe(self.camera, depth_m=depth), knobs.patience_s)
            marks.append(time.process_time())
            arena.advance(answer)
            marks.append(time.process_time())
            tally.cpu_s.update(dict(zip(("depth", "pilot", "arena"), np.diff(marks).tolist(), strict=True)))
            for outcome in arena.outcomes():
                if outcome.flight in flying:
                    pose = poses[np.flatnonzero(flying == outcome.flight)[0]]
                    way = np.array(outcome.place_m) - pose[:3, 3]
                    cosine = way @ pose[:3, 2] / max(float(np.linalg.norm(way)), 1e-9)
                    tally.aside_deg[outcome.flight] = float(np.degrees(np.arccos(np.clip(cosine, -1.0, 1.0))))
        tally.outcomes += arena.outcomes()


def told(name: str, pilot: str, tally: Tally, movers: set[int]) -> None:
    """Print one line of rates, one of costs, and one for each flight of an oracle that failed."""
    ends = Counter(o.kind for o in tally.outcomes)
    count = len(tally.outcomes)
    rates = ", ".join(
        f"{kind} {ends[kind] / count:.1%}" for kind in ("collision", "goal", "timeout", "pilot")
    )
    speed = [o.mean_speed_mps for o in tally.outcomes if o.kind == "goal"]
    print(f"{name}, {pilot}: {count} flights, {tally.obstructed} obstructed: {rates}", end="")
    print(f"; {np.mean(speed) if speed else 0.0:.1f} m/s to goals")
    cost = ", ".join(f"{what} {1e3 * s / tally.steps:.2f}" for what, s in tally.cpu_s.items())
    print(f"  {tally.steps} decision steps, ms of CPU each: {cost}")
    hit = Counter(o.class_name for o in tally.outcomes if o.kind == "collision")
    if hit:
        print("  hit: " + ", ".join(f"{what} {n}" for what, n in hit.most_common()))
    for o in tally.outcomes if pilot == "oracle" else ():
        if o.kind != "goal":
            place = ", ".join(f"{x:.1f}" for x in o.place_m)
            what = (
                f"{o.class_name}{' (moving)' if o.object in movers else ''}" if o.kind == "collision" else ""
            )
            print(
                f"  flight {o.flight}: {o.kind} {what} at ({place}) after {o.time_s:.1f} s, progress {o.progress:.2f},"
                f" {tally.aside_deg[o.flight]:.0f} deg beside the axis {o.reason}"
            )


def main() -> None:
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    parser.add_argument("--map", choices=sorted(MAPS), nargs="+", default=sorted(MAPS))
    parser.add_argument("--pilot", choices=sorted(SOURCES), nargs="+", default=["oracle", "blind"])
    parser.add_argument("--planner", default="waypoint")
    parser.add_argument("--flights", type=int, default=50, help="per map and pilot, in batches of 25")
    parser.add_argument("--speed", type=float, default=LoopKnobs().cruise_mps, help="cruise [m/s]")
    parser.add_argument("--wind", type=float, default=WindKnobs().mean_mps, help="mean wind [m/s]")
    parser.add_argument("--latency", type=float, default=LoopKnobs().latency_ms, help="fixed delay [ms]")
    parser.add_argument("--difficulty", type=float, default=MissionKnobs().difficulty)
    parser.add_argument("--seed", type=int, default=0)
    parser.add_argument("--world", type=int, default=0)
    asked = parser.parse_args()
    print(machine(), flush=True)
    camera = Camera.from_fov(256, 144, 90.0)
    for name in asked.map:
        place = Place(name, asked.world, camera)
        movers = {mover.object for mover in place.obstacles.company.movers}
        for pilot in asked.pilot:
            told(name, pilot, place.fly(asked, pilot), movers)


if __name__ == "__main__":
    main()
