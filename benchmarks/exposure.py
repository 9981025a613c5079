"""What one world costs before its first frame: build, load, exposure by stage, and one thermal state.

CPU time of one thread, beside the reference floor F at 256 x 256 on the same mesh, and the peak memory of the process.

    python benchmarks/exposure.py [--directions 64] [--worlds 2]
"""

from __future__ import annotations

import argparse
import resource
import time
from collections.abc import Callable
from functools import partial
from typing import TypeVar

import numpy as np
from floor import rays_of
from places import BAND_UM, HFOV_DEG, cpu_ms, machine

from scenegen.climate.season import Season
from scenegen.climate.weather import Weather
from scenegen.exposure import Exposure
from scenegen.foundation.rng import stream
from scenegen.heat.emitters import group_sites
from scenegen.heat.solve import HeatModel
from scenegen.maps.registry import build_world, map_family
from scenegen_render.bake import bake
from scenegen_render.camera import Camera
from scenegen_render.exposure.expose import expose
from scenegen_render.exposure.facets import FacetAverage
from scenegen_render.exposure.hemisphere import gather_list
from scenegen_render.exposure.knobs import ExposureKnobs
from scenegen_render.exposure.rays import SiteRays
from scenegen_render.exposure.sun import SunSteps, sun_beam
from scenegen_render.exposure.views import shares
from scenegen_render.reference_scenes import looking
from scenegen_render.scene import LoadedWorld, load

SEASON = Season(40.0, 7, 15)
WEATHER = Weather(294.0, 7.0, 15.0, 284.0, 3.0, cloud_fraction=0.3, linke_turbidity=3.0)
BAR_S = {"build + expose": 10.0, "state + bake": 0.5}
Result = TypeVar("Result")


class Stages:
    """CPU seconds by stage, in the order they ran."""

    def __init__(self) -> None:
        self.spent: dict[str, float] = {}

    def __call__(self, name: str, call: Callable[[], Result]) -> Result:
        start = time.process_time()
        result = call()
        self.spent[name] = time.process_time() - start
        return result


def floor_ms(loaded: LoadedWorld) -> float:
    """F at 256 x 256, median over four directions 40 m above the middle."""
    camera, rng, spent = Camera.from_fov(256, 256, HFOV_DEG), stream(0, "floor"), []
    for heading in (0.0, 90.0, 180.0, 270.0):
        bare = partial(
            rays_of(loaded, camera, looking((0.0, 0.0, 40.0), heading, -20.0), rng).cast, loaded.scene
        )
        bare()
        spent += [cpu_ms(bare) for _ in range(3)]
    return float(np.median(spent))


def stages_of_exposure(loaded: LoadedWorld, knobs: ExposureKnobs, stages: Stages) -> None:
    """The parts of `expose`, one by one."""
    world = loaded.world
    for_sun, rays = stages("  rays", lambda: SiteRays.of(world))
    steps = stages("  sun positions", lambda: SunSteps.of(SEASON, knobs.sun_step_min))
    stages("  sun visibility", lambda: sun_beam(loaded, for_sun, steps))
    turn = stream(0, "turn").random(len(world.sites.area), dtype=np.float32)
    gather = stages("  gather list", lambda: gather_list(loaded, rays, knobs.directions, turn))
    stages("  shares", lambda: shares(gather, *group_sites(world)))
    stages("  facet average", lambda: FacetAverage.of(world, gather))


def states(loaded: LoadedWorld, exposure: Exposure, knobs: ExposureKnobs, stages: Stages) -> None:
    """Heat and bake, the first of a world and a later one."""
    model = stages("heat model (once a world)", lambda: HeatModel.of(loaded.world, exposure))
    for hour in (4.0, 15.0):
        state = stages("  heat", lambda h=hour: model.solve(WEATHER, h))
        stages("  bake", lambda s=state: bake(loaded, exposure, s, BAND_UM))
    stages.spent["state + bake"] = stages.spent["  heat"] + stages.spent["  bake"]


def main() -> None:
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    parser.add_argument("--directions", type=int, default=ExposureKnobs().directions)
    parser.add_argument("--worlds", type=int, default=2)
    asked = parser.parse_args()
    knobs = ExposureKnobs(directions=asked.directions)
    print(machine())
    for index in range(asked.worlds):
        stages = Stages()
        rng = stream(0, "benchmark", "world", index)
        world = stages("build", lambda g=rng: build_world("city", map_family("city").knobs(), SEASON, g))
        loaded = stages("load", lambda w=world: load(w))
        exposure = stages(
            "expose", lambda k=loaded, i=index: expose(k, SEASON, stream(0, "exposure", i), knobs)
        )
        stages.spent["build + expose"] = sum(stages.spent[s] for s in ("build", "load", "expose"))
        stages_of_exposure(loaded, knobs, stages)
        states(loaded, exposure, knobs, stages)
        floor = floor_ms(loaded)
        peak = resource.getrusage(resource.RUSAGE_SELF).ru_maxrss / 1024
        print(
            f"world {index}: {len(world.mesh.faces):,} triangles, {len(world.sites.area):,} sites,", end=" "
        )
        print(f"{asked.directions} directions, F {floor:.1f} ms, peak {peak:.0f} MiB")
        for name, seconds in stages.spent.items():
            bar = f"  (bar {BAR_S[name]:g} s)" if name in BAR_S else ""
            print(f"  {name:26s} {seconds:7.2f} s {seconds * 1e3 / floor:8.1f} F{bar}")
        loaded.release()


if __name__ == "__main__":
    main()
