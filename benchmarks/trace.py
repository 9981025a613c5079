"""Cost of tracing one frame with all default layers, as a multiple of the reference floor F.

Floor and tracer take turns, pose by pose, in one process and thread; the figure is the median of the ratios.

    python benchmarks/trace.py [--place boxes]
"""

from __future__ import annotations

from functools import partial

import numpy as np
from floor import rays_of
from places import HFOV_DEG, SIZES, Place, chosen, cpu_ms

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
    place = chosen(__doc__)
    for width, height in SIZES:
        tracer = Tracer(Camera.from_fov(width, height, HFOV_DEG), RenderKnobs())
        turns = take_turns(place, tracer, stream(0, "floor", width))
        bare, traced = np.median(turns, axis=0)
        ratio = np.median(turns[:, 1] / turns[:, 0])
        print(
            f"{width}x{height}: trace {traced:.1f} ms, F {bare:.1f} ms of CPU; ratio {ratio:.2f} (bar {BAR})"
        )


if __name__ == "__main__":
    main()
