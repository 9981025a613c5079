"""The reference floor F: what bare ray casts cost, to quote every other figure against.

F is Mitsuba's ``ray_intersect_preliminary`` on rays that were evaluated beforehand, and nothing else: four primary
(``coherent=True``) and four cosine-distributed secondary rays (``coherent=False``, only where a primary ray met a
surface) per pixel, on the mesh and at the poses of the benchmark, in CPU time of one thread.

    python benchmarks/floor.py [--place boxes]
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import partial
from typing import Any

import numpy as np
from places import HFOV_DEG, SIZES, chosen, cpu_ms

from scenegen.foundation.rng import stream
from scenegen_render import backend
from scenegen_render.camera import Camera
from scenegen_render.scene import LoadedWorld
from scenegen_render.trace import pixels
from scenegen_render.trace.pose import device_pose


@dataclass
class Rays:
    """Pre-evaluated rays of one pose."""

    primary: Any
    secondary: Any
    live: Any

    def cast(self, scene: Any) -> None:
        _, dr = backend.modules()
        first = scene.ray_intersect_preliminary(self.primary, coherent=True)
        second = scene.ray_intersect_preliminary(self.secondary, coherent=False, active=self.live)
        dr.eval(first.t, first.prim_index, second.t, second.prim_index)
        dr.sync_thread()


def rays_of(loaded: LoadedWorld, camera: Camera, pose: np.ndarray, rng: np.random.Generator) -> Rays:
    """Four rays per pixel and a cosine-distributed one from each place they hit."""
    mi, dr = backend.modules()
    plane = pixels.on_device(pixels.image_plane(camera, pixels.subsample_pattern(4)))
    moved, count = device_pose(pose), dr.width(plane.x)
    primary = mi.Ray3f(moved.translation, moved.turn(plane.x, plane.y, mi.Float(1.0)))
    hit = loaded.scene.ray_intersect(primary)
    frame = mi.Frame3f(dr.mulsign(hit.n, -dr.dot(hit.n, primary.d)))
    square = rng.random((2, count), dtype=np.float32)
    sample = mi.Point2f(backend.upload(square[0]), backend.upload(square[1]))
    secondary = mi.Ray3f(hit.p + 2e-3 * frame.n, frame.to_world(mi.warp.square_to_cosine_hemisphere(sample)))
    live = hit.is_valid()
    primary.o = mi.Point3f(*(dr.repeat(c, count) for c in moved.translation))
    dr.eval(primary, secondary, live)
    return Rays(primary, secondary, live)


def main() -> None:
    place = chosen(__doc__)
    for width, height in SIZES:
        camera, rng, spent = Camera.from_fov(width, height, HFOV_DEG), stream(0, "floor", width), []
        for pose, _ in place.poses:
            bare = partial(rays_of(place.loaded, camera, pose, rng).cast, place.loaded.scene)
            bare()
            spent += [cpu_ms(bare) for _ in range(4)]
        print(f"{width}x{height}: F {np.median(spent):.1f} ms of CPU a frame")


if __name__ == "__main__":
    main()
