"""Self-check: renders 16x16 pixels in a child process and compares them with the closed form.

A child, because a wrong LLVM does not raise: it ends the process. The parent always survives and says what to do.
"""

from __future__ import annotations

import dataclasses
import json
import math
import signal
import subprocess
import sys
import time
from dataclasses import dataclass
from typing import Any

import numpy as np

from scenegen.foundation.errors import BackendError
from scenegen.materials.material import Surface
from scenegen.materials.table import material
from scenegen.radiometry.atmosphere import Atmosphere
from scenegen.radiometry.planck import band_radiance
from scenegen_render.backend import LLVM_ADVICE, Backend, describe
from scenegen_render.camera import Camera

TOLERANCE = 1e-4
"""Largest relative deviation from the closed form that counts as right."""
_PATIENCE_S = 120.0
_SIZE_PX = 16
_HEIGHT_M = 12.0


@dataclass(frozen=True)
class DoctorReport:
    """What the self-check found.

    Attributes
    ----------
    healthy : bool
        The renderer works and its pixels are right.
    backend : Backend or None
        What renders here; None if it did not start.
    radiance_error, depth_error : float
        Largest relative deviation of a pixel from the closed form; NaN if nothing was rendered.
    seconds : float
        Time the first frame took, kernels compiled or read from the cache.
    problem : str
        One line, empty when healthy.
    advice : str
        What to do next, empty when healthy.
    """

    healthy: bool
    backend: Backend | None
    radiance_error: float
    depth_error: float
    seconds: float
    problem: str
    advice: str


def self_check(timeout_s: float = _PATIENCE_S) -> DoctorReport:
    """Render a plate under a uniform sky in a child process and judge the pixels.

    Never raises for a broken renderer and never dies with it.
    """
    command = [
        sys.executable,
        "-c",
        "from scenegen_render.doctor import report_to_stdout; report_to_stdout()",
    ]
    try:
        child = subprocess.run(command, capture_output=True, text=True, timeout=timeout_s, check=False)
    except subprocess.TimeoutExpired:
        return _broken(
            f"the renderer did not answer within {timeout_s:.0f} s", "try again on a quieter machine"
        )
    if child.returncode < 0:
        name = signal.Signals(-child.returncode).name
        return _broken(f"the renderer died of {name}{_last_line(child.stderr)}", LLVM_ADVICE)
    try:
        answer = json.loads(child.stdout.splitlines()[-1])
    except (IndexError, ValueError):
        return _broken(f"the renderer failed{_last_line(child.stderr)}", "reinstall the package")
    return _judge(answer)


def report_to_stdout() -> None:
    """Child's half: print the findings as one JSON line."""
    try:
        found = _render()
    except (BackendError, ImportError) as error:
        found = {"problem": str(error)}
    sys.stdout.write(json.dumps(found) + "\n")


def _render() -> dict[str, Any]:
    """Look down on a plate of emissivity 0.6 at 300 K under a blackbody sky of 250 K, without air."""
    from scenegen_render import reference_scenes
    from scenegen_render.knobs import RenderKnobs
    from scenegen_render.scene import load
    from scenegen_render.trace import Tracer

    backend = dataclasses.asdict(describe())
    camera = Camera.from_fov(_SIZE_PX, _SIZE_PX, 60.0)
    world = reference_scenes.plate(Surface(material("asphalt_aged"), 0.6, 0.9))
    air = Atmosphere(air_K=290.0, vapour_pressure_hPa=10.0, uniform_sky_K=250.0, path=False)
    sky, own = (float(band_radiance(np.array(T), camera.band_um)) for T in (250.0, 300.0))
    irradiance = np.full(len(world.sites.area), math.pi * sky, np.float32)
    start = time.perf_counter()
    tracer = Tracer(camera, RenderKnobs())
    lit = tracer.light(load(world), reference_scenes.uniform_state(world, 300.0, air), irradiance)
    pose = np.diag([1.0, -1.0, -1.0, 1.0])
    pose[2, 3] = _HEIGHT_M
    frame = tracer.frame(lit, pose, pose)
    return {
        "backend": backend,
        "seconds": time.perf_counter() - start,
        "radiance_error": float(np.abs(frame.radiance / (0.6 * own + 0.4 * sky) - 1.0).max()),
        "depth_error": float(np.abs(frame.depth / _HEIGHT_M - 1.0).max()),
    }


def _judge(answer: dict[str, Any]) -> DoctorReport:
    if "problem" in answer:
        problem, _, advice = answer["problem"].partition("; ")
        return _broken(problem, advice)
    fields = answer["backend"]
    versions = tuple((name, version) for name, version in fields.pop("versions"))
    backend = Backend(**fields, versions=versions)
    radiance, depth = answer["radiance_error"], answer["depth_error"]
    healthy = radiance <= TOLERANCE and depth <= TOLERANCE
    problem = (
        "" if healthy else f"pixels are wrong: radiance by {radiance:.1e}, depth by {depth:.1e} (relative)"
    )
    advice = (
        "" if healthy else "install exactly the pinned versions of mitsuba and drjit in a fresh environment"
    )
    return DoctorReport(healthy, backend, radiance, depth, answer["seconds"], problem, advice)


def _broken(problem: str, advice: str) -> DoctorReport:
    return DoctorReport(False, None, math.nan, math.nan, math.nan, problem, advice)


def _last_line(text: str) -> str:
    lines = [line.strip() for line in text.splitlines() if line.strip()]
    return f": {lines[-1]}" if lines else ""
