"""Cost of tracing one frame with all default layers, as a multiple of the reference floor F.

Floor and tracer take turns, pose by pose, in one process and thread; the figure is the median of the ratios.

    python benchmarks/trace.py
"""

from __future__ import annotations

import dataclasses
from functools import partial

import floor
import numpy as np

from scenegen.foundation.rng import stream
from scenegen.radiometry.atmosphere import Atmosphere
from scenegen.thermal_state import ThermalState
from scenegen.world import World
from scenegen_render.camera import Camera
from scenegen_render.knobs import RenderKnobs
from scenegen_render.reference_scenes import uniform_state
from scenegen_render.scene import LoadedWorld, load
from scenegen_render.trace import Lit, Tracer

BAR = 0.5


def afternoon(world: World) -> ThermalState:
    """Plausible temperatures, texture and patchy clouds, so that every branch of the kernel has work."""
    state = uniform_state(world, 295.0, Atmosphere(293.0, 12.0, cloud_fraction=0.3, cloud_K=280.0))
    warm = np.array([300.0, 296.0, 305.0, 297.0], np.float32)
    texture = np.array([s.material.texture_K for s in world.palette], np.float32)
    return dataclasses.replace(state, temperature_K=warm[world.sites.surface], texture_K=texture)


def take_turns(loaded: LoadedWorld, lit: Lit, tracer: Tracer, rng: np.random.Generator) -> np.ndarray:
    """CPU milliseconds of floor and tracer, one row per turn."""
    turns = []
    for pose in floor.poses(rng):
        ahead = pose.copy()
        ahead[:3, 3] += pose[:3, 2]
        rays = floor.rays_of(loaded, tracer.camera, pose, rng)
        bare, traced = partial(rays.cast, loaded.scene), partial(tracer.frame, lit, pose, ahead)
        bare(), traced()  # warm: kernels compiled, mesh in cache
        turns += [(floor.cpu_ms(bare), floor.cpu_ms(traced)) for _ in range(4)]
    return np.array(turns)


def main() -> None:
    print(floor.machine())
    world = floor.city()
    loaded = load(world)
    state, irradiance = afternoon(world), np.full(len(world.sites.area), 38.0 * np.pi, np.float32)
    for width, height in floor.SIZES:
        tracer = Tracer(Camera.from_fov(width, height, floor.HFOV_DEG), RenderKnobs())
        turns = take_turns(loaded, tracer.light(loaded, state, irradiance), tracer, stream(0, "floor", width))
        bare, traced = np.median(turns, axis=0)
        ratio = np.median(turns[:, 1] / turns[:, 0])
        print(
            f"{width}x{height}: trace {traced:.1f} ms, F {bare:.1f} ms of CPU; ratio {ratio:.2f} (bar {BAR})"
        )


if __name__ == "__main__":
    main()
