"""Flow of a real city with its traffic: what is followed into the next frame and back ends where it began.

Geometry: a small city of the generator, cameras before its cars, buses and people, drifting and turning between frames.
Rationale: the way back starts at the very place the way there leads to, so that it is traced by other rays, from the
other pose, on movers that stand elsewhere.
Expected: at least 99 % of covisible pixels return within a tenth of a pixel, movers' own pixels too.
"""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np
import pytest

from scenegen.climate.season import Season
from scenegen.foundation.rng import stream
from scenegen.maps.city.knobs import CityKnobs
from scenegen.maps.registry import build_world
from scenegen.movers.company import Company
from scenegen.radiometry.atmosphere import Atmosphere
from scenegen_render import reference_scenes
from scenegen_render.camera import Camera
from scenegen_render.knobs import RenderKnobs
from scenegen_render.reference_scenes import looking
from scenegen_render.scene import load
from scenegen_render.trace import Tracer
from scenegen_render.trace.follow import follow
from scenegen_render.trace.scenery import Scenery, scenery

CAMERA = Camera.from_fov(128, 96, 90.0)
STEP_S = 0.1
ROWS, COLUMNS = np.mgrid[0 : CAMERA.height_px, 0 : CAMERA.width_px] + 0.5
CENTRES = np.stack([COLUMNS.ravel(), ROWS.ravel()], axis=-1)


@pytest.fixture(scope="module")
def town() -> Iterator[Scenery]:
    world = build_world("city", CityKnobs(extent_m=400.0), Season(48.0, 7, 15), stream(4, "town"))
    loaded = load(world)
    yield scenery(loaded)
    loaded.release()


def passes(town: Scenery) -> Iterator[tuple[np.ndarray, np.ndarray, tuple[float, float]]]:
    """Two poses some 7 m before a mover and 4 m above its feet, and their times."""
    company, rng = Company.of(town.loaded.world.movers), stream(4, "passes")
    kinds = [m.kind for m in company.movers]
    chosen = [kinds.index(kind) + skip for kind in sorted(set(kinds)) for skip in (0, 3)]
    for k in chosen:
        time = float(rng.uniform(0.0, 600.0))
        pose = company.poses(time)[k]
        place, side = pose[:3, 3], float(np.arctan2(pose[1, 0], pose[0, 0]) + rng.uniform(-0.6, 0.6))
        start = place + np.array([7.0 * np.cos(side), 7.0 * np.sin(side), 4.0])
        later = start + rng.uniform(-0.6, 0.6, 3)
        heading, turn = float(np.degrees(side)) + 180.0, rng.uniform(-2.0, 2.0, 2).tolist()
        yield (
            looking(tuple(start.tolist()), heading, -25.0),
            looking(tuple(later.tolist()), heading + turn[0], -25.0 + turn[1]),
            (time, time + STEP_S),
        )


def test_forward_then_backward_flow_returns_to_its_pixel(town: Scenery) -> None:
    errors, moving = [], []
    for pose, ahead, times in passes(town):
        there = follow(town, CAMERA, CENTRES, pose, ahead, times)
        kept = there.covisible
        place = (CENTRES + there.flow)[kept]
        back = follow(town, CAMERA, place, ahead, pose, times[::-1])
        errors.append(np.linalg.norm(place + back.flow - CENTRES[kept], axis=1))
        moving.append(there.instance[kept] > town.loaded.world.face_object.max())
    returned, mover = np.concatenate(errors) < 0.1, np.concatenate(moving)
    assert len(returned) > 60_000 and mover.sum() > 2_000
    assert returned.mean() >= 0.99
    assert returned[mover].mean() >= 0.99


def test_pixel_centres_are_followed_as_the_layers_of_a_frame_say(town: Scenery) -> None:
    world = town.loaded.world
    state = reference_scenes.uniform_state(world, 295.0, Atmosphere(293.0, 12.0))
    irradiance = np.full(len(world.sites.area), 100.0, np.float32)
    tracer = Tracer(CAMERA, RenderKnobs(sub_samples=1, backward_flow=True))
    lit = tracer.light(town.loaded, state, irradiance, range(len(world.movers)))
    for pose, ahead, (now, then) in list(passes(town))[:3]:
        frame = tracer.frame(lit, pose, ahead, ahead, (now, then, now))
        for name, time in (("flow", then), ("flow_back", now)):
            followed = follow(town, CAMERA, CENTRES, pose, ahead, (now, time))
            np.testing.assert_array_equal(followed.flow, getattr(frame, name).reshape(-1, 2))
            seen = getattr(frame, name.replace("flow", "covisible")).ravel()
            np.testing.assert_array_equal(followed.covisible, seen)
            np.testing.assert_array_equal(followed.depth, frame.depth.ravel())
            np.testing.assert_array_equal(followed.instance, frame.instance.ravel())
    nothing = follow(town, CAMERA, np.zeros((0, 2)), pose, ahead, (now, then))
    assert nothing.flow.shape == (0, 2) and not len(nothing.covisible)
