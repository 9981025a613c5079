"""Forward flow, then the backward flow of the place it leads to: how far from the start does that end?

World 0 of each map with its own traffic and people; frames of default flights, and of cameras that fly past movers from
8 m. A pixel centre is followed into the next frame, and from there, at that very place, back again. For comparison the
same with the stored layers alone, where the way back is interpolated between the four nearest pixels: at silhouettes
that mixes two surfaces. So it is also told where all four show the object that was followed.

    python benchmarks/flow_cycle.py [--maps city coastline neighborhood field]
"""

from __future__ import annotations

import argparse
from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np
from places import HFOV_DEG, SEASON, machine

from scenegen.foundation.rng import stream
from scenegen.maps.registry import MAPS, build_world, map_family
from scenegen.movers.clock import Clock
from scenegen.movers.company import Company
from scenegen.world import World
from scenegen_flythrough.airspace import Airspace
from scenegen_flythrough.fly import fly
from scenegen_flythrough.knobs import FlightKnobs
from scenegen_render.camera import Camera
from scenegen_render.reference_scenes import looking
from scenegen_render.scene import load
from scenegen_render.trace.follow import Followed, follow
from scenegen_render.trace.scenery import Scenery, scenery

CAMERA = Camera.from_fov(256, 256, HFOV_DEG)
BAR_PX, BAR_SHARE = 0.1, 0.99
STEP_S = 0.1
_BEFORE_M, _ABOVE_M = 7.0, 4.0


@dataclass(frozen=True, eq=False)
class Shot:
    """Two poses and their world times."""

    pose: np.ndarray
    ahead: np.ndarray
    times_s: tuple[float, float]


def flights(world: World) -> Iterator[Shot]:
    """Three frames of each of four default flights."""
    airspace = Airspace(world)
    for k in range(4):
        clock = Clock.draw(stream(0, "benchmark", "clock", k))
        flight = fly(world, FlightKnobs(), 16, stream(0, "benchmark", "flight", k), airspace, clock)
        times = clock.at(flight.time_s)
        for n in (2, 8, 14):
            path = flight.world_from_camera
            yield Shot(path[n], path[n + 1], (float(times[n]), float(times[n + 1])))


def passes(world: World, count: int = 12) -> Iterator[Shot]:
    """Cameras before movers of all kinds, drifting and turning a little."""
    company, rng = Company.of(world.movers), stream(0, "benchmark", "passes")
    for k in np.linspace(0, len(world.movers) - 1, count).astype(int).tolist():
        time = float(rng.uniform(0.0, 600.0))
        pose = company.poses(time)[k]
        place, side = pose[:3, 3], float(np.arctan2(pose[1, 0], pose[0, 0]) + rng.uniform(-0.6, 0.6))
        offset = np.array([np.cos(side) * _BEFORE_M, np.sin(side) * _BEFORE_M, _ABOVE_M])
        heading, pitch = np.degrees(side) + 180.0, -25.0
        step = rng.uniform(-0.6, 0.6, 3)
        turn = rng.uniform(-2.0, 2.0, 2)
        yield Shot(
            looking(tuple((place + offset).tolist()), heading, pitch),
            looking(
                tuple((place + offset + step).tolist()), heading + float(turn[0]), pitch + float(turn[1])
            ),
            (time, time + STEP_S),
        )


@dataclass(frozen=True, eq=False)
class Cycle:
    """Covisible pixels of one shot: how far they end from where they began [px], whether they are movers', and whether
    the four pixels between which the way back is interpolated show their object alone."""

    exact_px: np.ndarray
    interpolated_px: np.ndarray
    moving: np.ndarray
    inside: np.ndarray


def cycle(shape: Scenery, shot: Shot) -> Cycle:
    """There and back."""
    rows, columns = np.mgrid[0 : CAMERA.height_px, 0 : CAMERA.width_px] + 0.5
    centres = np.stack([columns.ravel(), rows.ravel()], axis=-1)
    back_s = shot.times_s[::-1]
    there = follow(shape, CAMERA, centres, shot.pose, shot.ahead, shot.times_s)
    kept = there.covisible
    start, place = centres[kept], (centres + there.flow)[kept]
    back = follow(shape, CAMERA, place, shot.ahead, shot.pose, back_s)
    grid = follow(
        shape,
        CAMERA,
        np.stack([columns.ravel(), rows.ravel()], -1),
        shot.ahead,
        shot.pose,
        shot.times_s[::-1],
    )
    stored, inside = interpolated(grid, place, there.instance[kept])
    return Cycle(
        np.linalg.norm(place + back.flow - start, axis=1),
        np.linalg.norm(place + stored - start, axis=1),
        there.instance[kept] > shape.loaded.world.face_object.max(),
        inside,
    )


def interpolated(grid: Followed, place: np.ndarray, instance: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Flow, bilinear between pixel centres, and whether all four of them show the same object as the place."""
    size = np.array([CAMERA.width_px, CAMERA.height_px])
    at = np.clip(place - 0.5, 0.0, size - 1.0)
    low = np.minimum(at.astype(int), size - 2)
    share = at - low
    flow, inside = np.zeros(place.shape), np.ones(len(place), bool)
    for right, down in np.ndindex(2, 2):
        pixel = (low[:, 1] + down) * CAMERA.width_px + low[:, 0] + right
        weight = np.abs(1 - right - share[:, 0]) * np.abs(1 - down - share[:, 1])
        flow += weight[:, None] * grid.flow[pixel]
        inside &= grid.instance[pixel] == instance
    return flow, inside


def share(error_px: np.ndarray) -> str:
    """Of pixels that return; NaN counts as one that does not."""
    return f"{(error_px < BAR_PX).mean():.4%}" if len(error_px) else "none"


def main() -> None:
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    parser.add_argument("--maps", nargs="+", choices=sorted(MAPS), default=list(MAPS))
    print(machine())
    for name in parser.parse_args().maps:
        world = build_world(name, map_family(name).knobs(), SEASON, stream(0, "benchmark", "world"))
        shape = scenery(load(world))
        for title, shots in (("flights", flights(world)), ("past movers", passes(world))):
            all_ = [cycle(shape, shot) for shot in shots]
            exact, stored, moving, inside = (
                np.concatenate([getattr(c, key) for c in all_])
                for key in ("exact_px", "interpolated_px", "moving", "inside")
            )
            print(
                f"{name}, {title}: {len(exact):,} covisible pixels, {moving.sum():,} of movers; within {BAR_PX} px:"
                f" {share(exact)} (bar {BAR_SHARE:.0%}), movers {share(exact[moving])}; 99.9 % within"
                f" {np.nanquantile(exact, 0.999):.2g} px; interpolated {share(stored)}, movers {share(stored[moving])},"
                f" inside objects {share(stored[inside])} of {inside.mean():.0%},"
                f" movers {share(stored[inside & moving])}"
            )
        shape.loaded.release()


if __name__ == "__main__":
    main()
