"""Cost of tracing one frame with all default layers, as a multiple of the reference floor F.

Floor and tracer take turns, pose by pose, in one process and thread; the figure is the median of the ratios. Of several
places the time beside that of the first is printed too: what a richer world costs.

    python benchmarks/trace.py [--places boxes city coastline neighborhood field]
"""

from __future__ import annotations

import argparse
from functools import partial

import numpy as np
from floor import rays_of
from places import HFOV_DEG, PLACES, SIZES, Place, cpu_ms, machine

from scenegen.foundation.rng import stream
from scenegen_render.camera import Camera
from scenegen_render.knobs import RenderKnobs
from scenegen_render.trace import Tracer

BAR = 0.5


def take_turns(place: Place, tracer: Tracer, rng: np.random.Generator) -> np.ndarray:
    """CPU milliseconds of floor and tracer, one row per turn."""
    lit, turns = tracer.light(place.loaded, place.state, place.irradiance), []
    for pose, ahead in place.poses:
        rays = rays_of(place.loaded, tracer.camera, pose, rng)
        bare, traced = partial(rays.cast, place.loaded.scene), partial(tracer.frame, lit, pose, ahead)
        bare(), traced()  # warm: kernels compiled, mesh in cache
        turns += [(cpu_ms(bare), cpu_ms(traced)) for _ in range(4)]
    return np.array(turns)


def main() -> None:
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    parser.add_argument("--places", nargs="+", choices=sorted(PLACES), default=["city"])
    print(machine())
    first: dict[tuple[int, int], float] = {}
    for name in parser.parse_args().places:
        place = PLACES[name]()
        print(f"{name}: {len(place.loaded.world.mesh.faces):,} triangles, {len(place.poses)} poses")
        for size in SIZES:
            tracer = Tracer(Camera.from_fov(*size, HFOV_DEG), RenderKnobs())
            turns = take_turns(place, tracer, stream(0, "floor", size[0]))
            bare, traced = np.median(turns, axis=0)
            ratio, beside = np.median(turns[:, 1] / turns[:, 0]), traced / first.setdefault(size, traced)
            print(
                f"  {size[0]}x{size[1]}: trace {traced:.1f} ms, F {bare:.1f} ms of CPU; ratio {ratio:.2f} (bar {BAR});"
                f" {beside:.2f} times the first place"
            )
        place.loaded.release()


if __name__ == "__main__":
    main()
