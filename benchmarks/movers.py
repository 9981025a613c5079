"""Cost of movers: CPU a frame more than without, for about 8,000 triangles of traffic and people near the camera.

Floor F, frames of an empty street and frames of the same poses with movers take turns in one process and thread.
Every frame is of another time, so each pays for one new acceleration structure: the next instant's; this one's is kept.

    python benchmarks/movers.py
"""

from __future__ import annotations

from dataclasses import replace
from functools import partial
from itertools import pairwise

import numpy as np
from floor import rays_of
from places import HFOV_DEG, SEASON, SIZES, Place, boxes, cpu_ms, machine

from scenegen.foundation.rng import stream
from scenegen.geometry.builder import GeometryBuilder
from scenegen.materials.palette import PaletteBuilder
from scenegen.movers.company import Company
from scenegen.movers.drive import drive
from scenegen.movers.stroll import stroll
from scenegen.parts.workshop import Workshop
from scenegen_render.camera import Camera
from scenegen_render.knobs import RenderKnobs
from scenegen_render.reference_scenes import looking
from scenegen_render.scene import load
from scenegen_render.trace import Tracer
from scenegen_render.trace.casting import choose

BAR_MS = 5.0
TRIANGLES = 8_000
FRAMES = 24
_FIRST_ID = 1_000_000


def street() -> Place:
    """The city of boxes with movers around its middle block, and a camera that flies along one of its streets."""
    place, rng = boxes(), stream(0, "benchmark", "movers")
    builder, palette = GeometryBuilder(), PaletteBuilder(rng)
    builder.new_objects(_FIRST_ID)
    shop = Workshop(lambda xy: np.zeros(len(xy)), palette, builder, SEASON)
    lane = np.array([[-2.0, -2.0], [-2.0, 52.0], [52.0, 52.0], [52.0, -2.0]])
    way = np.array([[2.0, 2.0], [48.0, 2.0], [48.0, 48.0], [2.0, 48.0]])
    movers = [*drive([lane], 7.0, shop, rng), *stroll([way], 7.0, shop, rng)]
    first = len(place.loaded.world.palette)
    shifted = [replace(m, body=replace(m.body, surface=m.body.surface + first)) for m in movers]
    world = replace(
        place.loaded.world,
        palette=place.loaded.world.palette + palette.surfaces(),
        movers=tuple(shifted),
    )
    texture = np.array([s.material.texture_K for s in world.palette], np.float32)
    warm = np.full(len(Company.of(world.movers).site_surface), 305.0, np.float32)
    path = [looking((-5.0, -20.0 + k, 7.0), 70.0, -12.0) for k in range(FRAMES + 1)]
    return Place(
        "boxes with traffic",
        load(world),
        replace(place.state, texture_K=texture, moving_K=warm),
        place.irradiance,
        list(pairwise(path)),
    )


def main() -> None:
    place = street()
    world = place.loaded.world
    print(machine())
    times = 0.1 * np.arange(FRAMES + 1)
    path = np.stack([pose for pose, _ in place.poses] + [place.poses[-1][1]])
    for width, height in SIZES:
        camera = Camera.from_fov(width, height, HFOV_DEG)
        tracer, rng = Tracer(camera, RenderKnobs()), stream(0, "floor", width)
        cast = choose(world.movers, camera, path, times, TRIANGLES)
        peopled = tracer.light(place.loaded, place.state, place.irradiance, cast)
        empty = tracer.light(place.loaded, place.state, place.irradiance)
        turns, share = [], []
        for _ in range(3):
            for k, (pose, ahead) in enumerate(place.poses):
                when = float(times[k]), float(times[k + 1]), 0.0
                bare = partial(rays_of(place.loaded, camera, pose, rng).cast, place.loaded.scene)
                without = partial(tracer.frame, empty, pose, ahead, None, when)
                moving = partial(tracer.frame, peopled, pose, ahead, None, when)
                bare()
                turns.append((cpu_ms(bare), cpu_ms(without), cpu_ms(moving)))
                share.append((tracer.frame(peopled, pose, ahead, None, when).instance > _FIRST_ID).mean())
        floor, without_ms, with_ms = np.median(turns[2:], axis=0)
        more = np.median([b - a for _, a, b in turns[2:]])
        triangles = sum(len(world.movers[k].body.faces) for k in cast)
        print(
            f"{width}x{height}: {len(cast)} movers of {triangles:,} triangles over {np.mean(share):.1%} of the image;"
            f" with {with_ms:.1f} ms, without {without_ms:.1f} ms, {more:.1f} ms more (bar {BAR_MS});"
            f" F {floor:.1f} ms, ratios {with_ms / floor:.2f} and {without_ms / floor:.2f}"
        )


if __name__ == "__main__":
    main()
