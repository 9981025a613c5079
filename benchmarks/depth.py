"""Depth of ten million rays against float64 ray-triangle tests on the same mesh, and whether any ray is missed.

Ten frames of 1024x1024 over a city of boxes are compared pixel by pixel with `reference_depth`; ten more inside a
closed room only ask whether a ray escapes. About four minutes.

    python benchmarks/depth.py
"""

from __future__ import annotations

import numpy as np
from places import machine

from scenegen.foundation.rng import stream
from scenegen.materials.material import Surface
from scenegen.materials.table import material
from scenegen.radiometry.atmosphere import Atmosphere
from scenegen.world import World
from scenegen_render import reference_scenes
from scenegen_render.camera import Camera
from scenegen_render.knobs import RenderKnobs
from scenegen_render.reference_depth import reference_depth
from scenegen_render.scene import load
from scenegen_render.trace import Lit, Tracer

BAR = 1e-6
CAMERA = Camera.from_fov(1024, 1024, 90.0)


def lit(tracer: Tracer, world: World) -> Lit:
    state = reference_scenes.uniform_state(world, 290.0, Atmosphere(290.0, 10.0))
    return tracer.light(load(world), state, np.zeros(len(world.sites.area), np.float32))


def city_errors(tracer: Tracer, frames: int) -> None:
    """Print the largest relative error and what could not be decided."""
    names = ("asphalt_aged", "brick_red", "bitumen_felt_roof", "window_glass")
    ground, wall, roof, glass = (Surface(material(n), 0.9, 0.8) for n in names)
    world = reference_scenes.box_city((ground, wall, roof, glass), stream(7, "depth"), blocks=8, cell_m=5.0)
    scene, rng = lit(tracer, world), stream(3, "depth")
    rays = missed = ghosts = doubtful = outside = 0
    worst = 0.0
    for _ in range(frames):
        x, y, z = map(float, (*rng.uniform(-150, 150, 2), rng.uniform(62, 100)))
        pose = reference_scenes.looking((x, y, z), float(rng.uniform(0, 360)), float(rng.uniform(-70, -10)))
        depth = tracer.frame(scene, pose, pose).depth.astype(np.float64)
        truth = reference_depth(world.mesh, CAMERA, pose)
        sure, hit = truth.near == truth.far, np.isfinite(truth.near)
        rays += depth.size
        missed += int((sure & hit & np.isinf(depth)).sum())
        ghosts += int((sure & ~hit & np.isfinite(depth)).sum())
        both = sure & hit & np.isfinite(depth)
        worst = max(worst, float(np.abs(depth[both] / truth.near[both] - 1.0).max()))
        low, high = truth.near[~sure] * (1 - BAR), truth.far[~sure] * (1 + BAR)
        doubtful += int((~sure).sum())
        outside += int(((depth[~sure] < low) | (depth[~sure] > high)).sum())
    print(f"city: {rays:,} rays, {len(world.mesh.faces):,} triangles")
    print(f"  largest relative error {worst:.1e} (bar {BAR:.0e}); {missed} missed, {ghosts} invented")
    print(f"  {doubtful:,} pass an edge within float32 rounding, {outside} of them wrong")


def room_escapes(tracer: Tracer, frames: int) -> None:
    """Print how many rays leave a closed room."""
    brick = Surface(material("brick_red"), 0.9, 0.8)
    scene, rng = lit(tracer, reference_scenes.room((brick,), cell_m=0.25)), stream(5, "room")
    escaped = 0
    for _ in range(frames):
        x, y, z = map(float, rng.uniform((0.5, 0.5, 5.5), (9.5, 9.5, 9.5)))
        pose = reference_scenes.looking((x, y, z), float(rng.uniform(0, 360)), float(rng.uniform(-89, 89)))
        escaped += int(np.isinf(tracer.frame(scene, pose, pose).depth).sum())
    print(f"room: {frames * CAMERA.width_px * CAMERA.height_px:,} rays, {escaped} escaped")


def main() -> None:
    print(machine())
    tracer = Tracer(CAMERA, RenderKnobs(sub_samples=1))
    city_errors(tracer, 10)
    room_escapes(tracer, 10)


if __name__ == "__main__":
    main()
