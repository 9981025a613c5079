"""The same bytes in every process, and no kernel compiled twice."""

from __future__ import annotations

import hashlib
import subprocess
import sys
from collections.abc import Iterator
from dataclasses import replace

import numpy as np

from scenegen.materials.material import Surface
from scenegen.materials.table import material
from scenegen.radiometry.atmosphere import Atmosphere
from scenegen.world import World
from scenegen_render import backend, reference_scenes
from scenegen_render.camera import Camera
from scenegen_render.frame import Frame
from scenegen_render.knobs import RenderKnobs
from scenegen_render.reference_scenes import looking
from scenegen_render.scene import load
from scenegen_render.trace import Tracer

CAMERA = Camera.from_fov(72, 56, 90.0)
KNOBS = RenderKnobs(backward_flow=True, normals=True)


def world(seed: int) -> World:
    names = ("asphalt_aged", "brick_red", "bitumen_felt_roof", "window_glass")
    ground, wall, roof, glass = (Surface(material(n), material(n).emissivity, 0.8) for n in names)
    return reference_scenes.box_city((ground, wall, roof, glass), np.random.default_rng(seed), 3 + seed, 6.0)


def film(tracer: Tracer, seed: int, clips: int, frames: int = 2) -> Iterator[Frame]:
    """A few frames of a few clips in a world; weather, hour and path differ from clip to clip."""
    made = world(seed)
    loaded = load(made)
    for clip in range(clips):
        air = Atmosphere(290.0 + clip, 8.0 + clip, cloud_fraction=clip / 4, visibility_km=10.0 + clip)
        state = reference_scenes.uniform_state(made, 295.0 + clip, air)
        state = replace(state, hour=3.0 * clip, texture_K=np.array([1.0, 0.5, 1.2, 0.1], np.float32) * clip)
        lit = tracer.light(loaded, state, np.full(len(made.sites.area), 100.0 + clip, np.float32))
        poses = [looking((-60.0 + k, 3.0 * clip, 25.0), 5.0 * k, -15.0) for k in range(frames + 2)]
        for k in range(1, frames + 1):
            yield tracer.frame(lit, poses[k], poses[k + 1], poses[k - 1])


def digest() -> str:
    total = hashlib.sha256()
    for frame in film(Tracer(CAMERA, KNOBS), 1, 2):
        for name, layer in sorted(vars(frame).items()):
            total.update(name.encode() + np.ascontiguousarray(layer).tobytes())
    return total.hexdigest()


def test_two_processes_render_the_same_bytes():
    code = (
        "import importlib.util as u, sys; s = u.spec_from_file_location('film', sys.argv[1]);"
        " m = u.module_from_spec(s); s.loader.exec_module(m); print(m.digest())"
    )
    command = [sys.executable, "-c", code, __file__]
    others = [
        subprocess.run(command, capture_output=True, text=True, check=True).stdout.strip() for _ in range(2)
    ]
    assert others == [digest()] * 2


def test_three_worlds_of_four_clips_compile_no_more_kernels_than_one_world_of_one_clip():
    _, dr = backend.modules()
    tracer = Tracer(CAMERA, KNOBS)

    def kernels(worlds: int, clips: int) -> tuple[set[object], int]:
        dr.kernel_history_clear()
        with dr.scoped_set_flag(dr.JitFlag.KernelHistory):
            frames = sum(1 for seed in range(worlds) for _ in film(tracer, seed, clips))
            history = [entry for entry in dr.kernel_history() if entry["type"] == dr.KernelType.JIT]
        return {entry["hash"] for entry in history}, frames

    one, few = kernels(1, 1)
    many, more = kernels(3, 4)
    assert (few, more) == (2, 24)
    assert len(one) >= 2 and many == one
