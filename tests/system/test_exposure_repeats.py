"""Exposures and baked irradiance are the same bytes in every process, and compile no kernel for another world."""

from __future__ import annotations

import hashlib
import subprocess
import sys

import numpy as np

from scenegen.climate.season import Season
from scenegen.exposure import Exposure
from scenegen.foundation.rng import stream
from scenegen.materials.material import Surface
from scenegen.materials.table import material
from scenegen.radiometry.atmosphere import Atmosphere
from scenegen.world import World
from scenegen_render import backend
from scenegen_render.bake import bake
from scenegen_render.exposure.expose import expose
from scenegen_render.exposure.knobs import ExposureKnobs
from scenegen_render.reference_scenes import box_city, uniform_state
from scenegen_render.scene import load

BAND = (8.0, 14.0)
AIR = Atmosphere(air_K=285.0, vapour_pressure_hPa=9.0)


def _world(seed: int, blocks: int) -> World:
    rows = [material(name) for name in ("asphalt_aged", "brick_red", "bitumen_felt_roof", "window_glass")]
    ground, wall, roof, glass = (Surface(m, m.emissivity, m.solar_absorptance) for m in rows)
    return box_city((ground, wall, roof, glass), stream(seed, "boxes"), blocks=blocks, cell_m=5.0)


def _all(world: World, seed: int, season: Season, directions: int = 64) -> tuple[Exposure, np.ndarray]:
    loaded, knobs = load(world), ExposureKnobs(directions=directions, sun_step_min=60.0)
    exposure = expose(loaded, season, stream(seed, "exposure"), knobs)
    return exposure, bake(loaded, exposure, uniform_state(world, 291.0, AIR), BAND)


def digest_of_all(seed: int) -> str:
    exposure, irradiance = _all(_world(3, 2), seed, Season(40.0, 7, 15))
    found = hashlib.sha256()
    parts = (
        exposure.beam, exposure.sky_view, exposure.gather, exposure.neighbour_share, exposure.sun_hour,
        exposure.sun_direction, irradiance,
    )  # fmt: skip
    for array in parts:
        found.update(f"{array.dtype}{array.shape}".encode() + np.ascontiguousarray(array).tobytes())
    return found.hexdigest()


def test_same_bytes_in_another_process_and_other_bytes_for_another_seed() -> None:
    code = (
        "import runpy; print(runpy.run_path(r'"
        + __file__
        + "')['digest_of_all'](5))"  # no pytest, own process
    )
    other = subprocess.run(
        [sys.executable, "-c", code], capture_output=True, text=True, check=True, timeout=600
    )
    own = digest_of_all(5)
    assert other.stdout.strip().splitlines()[-1] == own
    assert digest_of_all(5) == own
    assert digest_of_all(6) != own


def _kernels(world: World, seed: int, season: Season, directions: int) -> set[str]:
    """Hashes of all kernels that ran."""
    _, dr = backend.modules()
    with dr.scoped_set_flag(dr.JitFlag.KernelHistory, True):
        dr.kernel_history_clear()
        _all(world, seed, season, directions)
        return {kernel["hash"] for kernel in dr.kernel_history([dr.KernelType.JIT])}


def test_another_world_season_and_direction_count_run_the_same_kernels() -> None:
    first = _kernels(_world(1, 2), 1, Season(40.0, 7, 15), 64)
    assert len(first) >= 8
    assert _kernels(_world(2, 3), 2, Season(-20.0, 1, 3), 80) == first
    assert _kernels(_world(3, 2), 3, Season(60.0, 10, 3), 33) == first
