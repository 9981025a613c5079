"""The reference floor F: what bare ray casts cost, to quote every other figure against.

F is Mitsuba's ``ray_intersect_preliminary`` on rays that were evaluated beforehand, and nothing else: four primary
(``coherent=True``) and four cosine-distributed secondary rays (``coherent=False``) per pixel, on the mesh and at the
poses of the benchmark, in CPU time of one thread.

    python benchmarks/floor.py
"""

from __future__ import annotations

import platform
import time
from dataclasses import dataclass
from typing import Any

import numpy as np

from scenegen.foundation.rng import stream
from scenegen.materials.material import Surface
from scenegen.materials.table import material
from scenegen.world import World
from scenegen_render import backend, reference_scenes
from scenegen_render.camera import Camera
from scenegen_render.reference_scenes import looking
from scenegen_render.scene import LoadedWorld, load
from scenegen_render.trace import pixels
from scenegen_render.trace.pose import device_pose

SIZES = ((256, 256), (640, 512))
HFOV_DEG = 90.0


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
    moved = device_pose(pose)
    primary = mi.Ray3f(moved.translation, moved.turn(plane.x, plane.y, mi.Float(1.0)))
    hit = loaded.scene.ray_intersect(primary)
    frame = mi.Frame3f(dr.mulsign(hit.n, -dr.dot(hit.n, primary.d)))
    sample = mi.Point2f(rng.random((2, dr.width(plane.x)), dtype=np.float32))
    secondary = mi.Ray3f(hit.p + 2e-3 * frame.n, frame.to_world(mi.warp.square_to_cosine_hemisphere(sample)))
    live = hit.is_valid()
    primary.o = mi.Point3f(*(dr.repeat(c, dr.width(plane.x)) for c in moved.translation))
    dr.eval(primary, secondary, live)
    return Rays(primary, secondary, live)


def city(seed: int = 0) -> World:
    """Box city of about 540,000 triangles."""
    names = ("asphalt_aged", "brick_red", "bitumen_felt_roof", "window_glass")
    rows = [material(name) for name in names]
    ground, wall, roof, glass = (Surface(m, m.emissivity, m.solar_absorptance) for m in rows)
    return reference_scenes.box_city((ground, wall, roof, glass), stream(seed, "floor"))


def poses(rng: np.random.Generator, count: int = 12, extent_m: float = 250.0) -> list[np.ndarray]:
    """Places 20 to 60 m above the streets, looking ahead and 5 to 35 degrees down."""
    drawn = []
    for _ in range(count):
        x, y = rng.uniform(-extent_m, extent_m, 2)
        place = (float(x), float(y), float(rng.uniform(20.0, 60.0)))
        drawn.append(looking(place, float(rng.uniform(0.0, 360.0)), -float(rng.uniform(5.0, 35.0))))
    return drawn


def cpu_ms(call: Any) -> float:
    start = time.process_time()
    call()
    return (time.process_time() - start) * 1e3


def machine() -> str:
    """One line that says what the figures were measured with."""
    b = backend.describe()
    versions = ", ".join(f"{name} {version}" for name, version in b.versions)
    cpu = f"{b.cpu_model} ({b.cpu_class}), {b.threads} thread"
    return f"{cpu}, LLVM {b.llvm_version}, {versions}, {platform.platform()}"


def main() -> None:
    print(machine())
    loaded = load(city())
    for width, height in SIZES:
        camera, rng = Camera.from_fov(width, height, HFOV_DEG), stream(0, "floor", width)
        rays = [rays_of(loaded, camera, pose, rng) for pose in poses(rng)]
        rays[0].cast(loaded.scene)
        spent = [cpu_ms(lambda r=r: r.cast(loaded.scene)) for _ in range(3) for r in rays]
        print(f"F at {width}x{height}: {np.median(spent):.1f} ms of CPU a frame")


if __name__ == "__main__":
    main()
