"""What a drone's eyes cost in closed loop: CPU a step of n drones that are traced together, and of each of them.

World 0 of a map with all its traffic and people; drones spread over default flights, a metre further at every step, the
world a ninth of a second later. Depth alone needs no thermal state; radiance comes with four sub-samples, and with all
movers of the world, because mirrors show what no camera sees.

    python benchmarks/views.py [--map city] [--size 256x144] [--drones 1 8 25]
"""

from __future__ import annotations

import argparse
from collections.abc import Callable
from functools import partial

import numpy as np
from places import HFOV_DEG, Place, cpu_ms, machine, of_map

from scenegen.foundation.rng import stream
from scenegen.maps.registry import MAPS
from scenegen_flythrough.airspace import Airspace
from scenegen_flythrough.fly import fly
from scenegen_flythrough.knobs import FlightKnobs
from scenegen_render.camera import Camera
from scenegen_render.sensor.flock import Flock
from scenegen_render.sensor.knobs import SensorKnobs
from scenegen_render.trace.lit import Lit, light
from scenegen_render.trace.scenery import scenery
from scenegen_render.trace.views import Layer, Views

FLIGHTS, FRAMES, STEPS, WARM = 8, 24, 12, 4
STEP_S = 1.0 / 9.0


def paths(place: Place) -> np.ndarray:
    """Poses of some default flights (flights, frames, 4, 4)."""
    world = place.loaded.world
    airspace = Airspace(world)
    flown = [
        fly(world, FlightKnobs(), FRAMES - 2, stream(0, "benchmark", "views", k), airspace)
        for k in range(FLIGHTS)
    ]
    return np.stack([flight.world_from_camera for flight in flown])


def drones(path: np.ndarray, count: int, step: int) -> np.ndarray:
    """Where so many drones are; those on one flight follow each other."""
    return np.stack([path[k % FLIGHTS, (5 * (k // FLIGHTS) + step) % FRAMES] for k in range(count)])


def median_ms(call: Callable[[int], object]) -> float:
    """CPU of a step; the first ones compile kernels and warm the mesh."""
    return float(np.median([cpu_ms(partial(call, step)) for step in range(STEPS)][WARM:]))


def costs(views: Views, lit: Lit, path: np.ndarray, count: int) -> dict[str, float]:
    """CPU ms of a step by stage."""
    loaded, camera = lit.loaded, views.camera
    shape, empty = scenery(loaded), scenery(loaded, ())
    flock = Flock(camera, SensorKnobs(), {k: stream(0, "views", k) for k in range(count)})
    both: tuple[Layer, ...] = ("depth", "radiance")
    radiance = views.look(lit, drones(path, count, 0), 0.0, both).radiance

    def at(step: int) -> tuple[np.ndarray, float]:
        return drones(path, count, step), 60.0 + step * STEP_S

    def place(step: int) -> object:
        """Without the rest of `look`; at other times than it, whose instants are kept."""
        poses, time_s = at(step)
        return shape.troupe.seen_by_all(time_s + 30.0, camera, poses, mirrors=False)

    return {
        "depth, empty": median_ms(lambda step: views.look(empty, *at(step))),
        "depth": median_ms(lambda step: views.look(shape, *at(step))),
        "of it movers": median_ms(place),
        "and radiance": median_ms(lambda step: views.look(lit, *at(step), both)),
        "sense": median_ms(lambda step: flock.read(np.arange(count), radiance, step * STEP_S)),
    }


def main() -> None:
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    parser.add_argument("--map", choices=sorted(MAPS), default="city")
    parser.add_argument("--size", default="256x144")
    parser.add_argument("--drones", nargs="+", type=int, default=[1, 8, 25])
    asked = parser.parse_args()
    width, height = map(int, asked.size.split("x"))
    camera, place = Camera.from_fov(width, height, HFOV_DEG), of_map(asked.map)
    world, path, views = place.loaded.world, paths(place), Views(camera)
    lit = light(place.loaded, place.state, place.irradiance, camera.band_um, range(len(world.movers)))
    print(machine())
    moving = sum(len(m.body.faces) for m in world.movers)
    print(f"{asked.map}: {len(world.mesh.faces):,} triangles, {len(world.movers)} movers of {moving:,} more")
    print(f"CPU ms of a step at {asked.size}, in brackets a drone's share")
    for count in asked.drones:
        stages = costs(views, lit, path, count)
        print(f"{count:>3} drones: " + "; ".join(f"{k} {v:.1f} ({v / count:.2f})" for k, v in stages.items()))


if __name__ == "__main__":
    main()
