"""Worlds by the dozen: what they cost, whether they are sound, and how much two seeds differ.

For each seed of a map: CPU time of building, loading, exposing and baking on one thread, triangles, thermal sites, and
what the audit finds (floating, buried, overlapping things; faces without area; numbers that are not). Then, over all
pairs of seeds, the overlap of what stands there (intersection over union of footprints on a 2 m grid) and the distance
of their height distributions (Kolmogorov-Smirnov); and whether the same seed gives the same bytes.

    python benchmarks/worlds.py [--map city coastline] [--seeds 50] [--exposed 2]
"""

from __future__ import annotations

import argparse
import dataclasses
import hashlib
import itertools
import resource
import time
from collections import Counter
from collections.abc import Callable
from typing import TypeVar

import numpy as np
from places import BAND_UM, SEASON, machine
from scipy import stats

from scenegen.climate.season import Season
from scenegen.climate.weather import Weather
from scenegen.foundation.rng import stream
from scenegen.heat.solve import HeatModel
from scenegen.maps.registry import MAPS, build_world, map_family
from scenegen.world import World
from scenegen_render.audit import GROUND, audit
from scenegen_render.bake import bake
from scenegen_render.exposure.expose import expose
from scenegen_render.scene import load

T = TypeVar("T")
CELL_M = 2.0
HALF_M = 300.0
CLEAR = Weather(294.0, 7.0, 15.0, 284.0, 3.0, cloud_fraction=0.0, linke_turbidity=3.0)


def timed(call: Callable[[], T]) -> tuple[T, float]:
    """Result and CPU time [s]."""
    start = time.process_time()
    return call(), time.process_time() - start


def built(name: str, seed: int) -> World:
    """World of a seed, in a season of its own."""
    season = Season.from_day_of_year(40.0, 1 + (97 * seed) % 365)
    return build_world(name, map_family(name).knobs(), season, stream(seed, "benchmark", name))


def digest(world: World) -> str:
    """Hash of every array of a world."""
    found = hashlib.sha256()

    def add(value: object) -> None:
        if isinstance(value, np.ndarray):
            found.update(np.ascontiguousarray(value).data)
        elif dataclasses.is_dataclass(value):
            for field in dataclasses.fields(value):
                add(getattr(value, field.name))
        elif isinstance(value, tuple):
            for item in value:
                add(item)
        else:
            found.update(repr(value).encode())

    add(world)
    return found.hexdigest()


def raised(world: World) -> tuple[np.ndarray, np.ndarray]:
    """What stands on the ground: occupied cells of a 2 m grid, and heights [m] above ground of its vertices."""
    stands = ~np.isin(world.face_semantic, GROUND)
    points = world.mesh.vertices[world.mesh.faces[stands]].mean(axis=1).astype(np.float64)
    height = points[:, 2] - world.ground.at(points[:, :2])
    inside = (np.abs(points[:, :2]) < HALF_M).all(axis=1) & (height > 1.0)
    cell = ((points[inside, :2] + HALF_M) / CELL_M).astype(int)
    grid = np.zeros((int(2 * HALF_M / CELL_M),) * 2, bool)
    grid[cell[:, 1], cell[:, 0]] = True
    return grid, height[inside]


def cost(name: str, seed: int) -> None:
    """Print what one world costs from nothing to the first irradiance."""
    world, build_s = timed(lambda: built(name, seed))
    loaded, load_s = timed(lambda: load(world))
    exposure, expose_s = timed(lambda: expose(loaded, SEASON, stream(seed, "exposure")))
    state, solve_s = timed(lambda: HeatModel.of(world, exposure).solve(CLEAR, 15.0))
    _, bake_s = timed(lambda: bake(loaded, exposure, state, BAND_UM))
    total = build_s + load_s + expose_s + solve_s + bake_s
    print(
        f"  seed {seed}: build {build_s:.2f} + load {load_s:.2f} + expose {expose_s:.2f} + solve {solve_s:.2f} + bake"
        f" {bake_s:.2f} = {total:.2f} s CPU (bar 12); peak memory of the process "
        f"{resource.getrusage(resource.RUSAGE_SELF).ru_maxrss / 1024:.0f} MiB (bar 1,536)"
    )
    loaded.release()


def sound(name: str, seeds: int) -> tuple[list[np.ndarray], list[np.ndarray]]:
    """Audit many worlds and print what was found; returns their footprints and heights."""
    triangles, sites, cpu, grids, heights = [], [], [], [], []
    problems: Counter[tuple[str, str]] = Counter()
    for seed in range(seeds):
        world, build_s = timed(lambda s=seed: built(name, s))
        triangles.append(len(world.mesh.faces))
        sites.append(len(world.sites.area))
        cpu.append(build_s)
        loaded = load(world)
        found = audit(loaded)
        problems.update((f.problem, f.semantic) for f in found.findings)
        for f in found.findings[:3]:
            print(
                f"    seed {seed}: {f.semantic} {f.object} {f.problem} at "
                + "{:.1f} {:.1f} {:.1f}".format(*f.position_m)
            )
        problems.update(
            {("not finite", "vertex"): found.non_finite, ("without area", "face"): found.degenerate}
        )
        grid, height = raised(world)
        grids.append(grid)
        heights.append(height)
        loaded.release()

    def span(values: list[int] | list[float], form: str) -> str:
        return f"{min(values):{form}} to {max(values):{form}}, median {np.median(values):{form}}"

    print(f"  {seeds} seeds: triangles {span(triangles, ',.0f')}; sites {span(sites, ',.0f')} (bar 350,000)")
    print(f"  build {span(cpu, '.2f')} s CPU")
    told = {k: n for k, n in problems.items() if n}
    print(
        "  audit: "
        + ("nothing found" if not told else "; ".join(f"{n} {k[1]} {k[0]}" for k, n in told.items()))
    )
    return grids, heights


def different(grids: list[np.ndarray], heights: list[np.ndarray]) -> None:
    """Print how much pairs of seeds overlap and how far their heights are apart; nothing for a single seed."""
    pairs = list(itertools.combinations(range(len(grids)), 2))[:200]
    if not pairs:
        return
    overlap = [(grids[a] & grids[b]).sum() / max((grids[a] | grids[b]).sum(), 1) for a, b in pairs]
    apart = [stats.ks_2samp(heights[a][::7], heights[b][::7]) for a, b in pairs]
    print(
        f"  {len(pairs)} pairs of seeds: footprint IoU at most {max(overlap):.2f} (bar 0.5); heights: KS distance "
        f"{min(k.statistic for k in apart):.3f} to {max(k.statistic for k in apart):.3f}, largest p "
        f"{max(k.pvalue for k in apart):.1e}"
    )


def main() -> None:
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    parser.add_argument("--map", nargs="+", default=list(MAPS))
    parser.add_argument("--seeds", type=int, default=50)
    parser.add_argument("--exposed", type=int, default=2)
    asked = parser.parse_args()
    print(machine())
    for name in asked.map:
        print(name)
        for seed in range(asked.exposed):
            cost(name, seed)
        different(*sound(name, asked.seeds))
        same = digest(built(name, 0)) == digest(built(name, 0))
        print(f"  the same seed twice: {'identical to the byte' if same else 'DIFFERS'}")


if __name__ == "__main__":
    main()
