"""Where clips are made: a worker that keeps one world standing and films it clip by clip."""

from __future__ import annotations

import gc
from collections.abc import Callable, Mapping
from dataclasses import asdict
from pathlib import Path
from typing import Any

import numpy as np
from jaxtyping import Float64

from scenegen.climate.sun import sun_direction
from scenegen.foundation.rng import stream
from scenegen.movers.clock import Clock
from scenegen.thermal_state import ThermalState
from scenegen_datasets.clip import ClipRecord
from scenegen_datasets.commit import ShardWriter
from scenegen_datasets.encode import FrameMeta, encode_frame
from scenegen_datasets.job import ClipJob
from scenegen_datasets.recipe import Recipe
from scenegen_datasets.scale import sensor_facts
from scenegen_datasets.splits.draw import draw_conditions
from scenegen_datasets.stage import Stage, set_stage
from scenegen_datasets.stopwatch import Stopwatch
from scenegen_flythrough.fly import fly
from scenegen_flythrough.trajectory import Trajectory
from scenegen_render.bake import bake
from scenegen_render.exposure.closer import look_closer
from scenegen_render.scene import release_memory
from scenegen_render.sensor.sense import Microbolometer
from scenegen_render.trace.lit import Lit
from scenegen_render.trace.tracer import Tracer

Told = Callable[[dict[str, Any]], None]
"""Hears how far a clip is; called once per stage and frame."""


class Studio:
    """Makes the clips of one dataset.

    Parameters
    ----------
    recipe : Recipe
    root : Path
        Dataset directory.
    fingerprint : str
        Id of the render fingerprint, for the receipts.
    """

    def __init__(self, recipe: Recipe, root: Path, fingerprint: str) -> None:
        self._recipe, self._root, self._fingerprint = recipe, root, fingerprint
        self._camera, self._held_out = recipe.camera.camera(), recipe.splits.held_out
        self._tracer = Tracer(self._camera, recipe.tracing)
        self._watch = Stopwatch()
        self._stage: Stage | None = None
        self._standing: tuple[str, int] | None = None

    def make(self, job: ClipJob, told: Told) -> dict[str, Any]:
        """Film and commit one clip.

        Returns
        -------
        dict
            What it cost: ``stages`` (see `Stopwatch.take`), ``bytes``, ``rejected`` flights.
        """
        watch = self._watch
        stage = self._at(job, told)
        path = ("clip", job.map, job.world, job.clip)
        with watch("weather"):
            weather, hour = draw_conditions(
                self._recipe.climate, self._held_out, stage.exposure.season, self._recipe.seed, job
            )
        clock = self._clock(path)
        with watch("fly"):
            rng = stream(self._recipe.seed, *path, "flight")
            flight = fly(stage.world, self._recipe.flight, job.frames, rng, stage.airspace, clock)
        with watch("look closer"):
            rng, frames = stream(self._recipe.seed, *path, "closer look"), flight.world_from_camera[1:-1]
            exposure = look_closer(
                stage.loaded, stage.exposure, self._camera, frames, rng, self._recipe.exposure
            )
        with watch("solve"):
            state = stage.heat.seeing(exposure).solve(weather, hour)
        with watch("bake"):
            irradiance = bake(stage.loaded, exposure, state, self._camera.band_um)
        world_s = clock.at(flight.time_s)
        with watch("light"):
            cast = self._tracer.cast(stage.world, flight.world_from_camera, world_s)
            lit = self._tracer.light(stage.loaded, state, irradiance, cast)
        size = self._film(job, lit, flight, world_s, self._record(job, stage, state, flight), told)
        del lit
        return {"stages": watch.take(), "bytes": size, "rejected": flight.rejected}

    def leave(self) -> None:
        """Tear the standing world down and give its memory back."""
        if self._stage is not None:
            self._stage.release()
        self._stage = self._standing = None
        gc.collect()
        release_memory()

    def _at(self, job: ClipJob, told: Told) -> Stage:
        wanted = (job.map, job.world)
        if self._stage is None or self._standing != wanted:
            self.leave()
            told({"stage": f"building {job.map} {job.world}"})
            self._stage = set_stage(self._recipe, job.map, job.world, self._watch)
            self._standing = wanted
        return self._stage

    def _clock(self, path: tuple[str, str, int, int]) -> Clock:
        """When in the life of its world a clip takes place."""
        if not self._recipe.movers:
            return Clock.stopped()
        return Clock.draw(stream(self._recipe.seed, *path, "clock"))

    def _film(
        self,
        job: ClipJob,
        lit: Lit,
        flight: Trajectory,
        world_s: Float64[np.ndarray, "poses"],
        record: ClipRecord,
        told: Told,
    ) -> int:
        rng = stream(self._recipe.seed, "clip", job.map, job.world, job.clip, "sensor")
        detector = Microbolometer(self._camera, self._recipe.sensor, rng)
        layers, watch, poses = self._recipe.stored_layers, self._watch, flight.world_from_camera
        with ShardWriter(self._root, job) as shard:
            for k in range(job.frames):
                time_s = float(flight.time_s[k + 1])
                with watch("trace"):
                    times_s = float(world_s[k + 1]), float(world_s[k + 2]), float(world_s[k])
                    frame = self._tracer.frame(lit, poses[k + 1], poses[k + 2], poses[k], times_s)
                with watch("sense"):
                    reading = detector.read(frame.radiance, time_s)
                with watch("encode"):
                    saturated = {"saturated": reading.saturated}
                    imu = flight.imu.between(time_s, float(flight.time_s[k + 2])) if "imu" in layers else None
                    meta = FrameMeta(
                        time_s, poses[k + 1], self._camera.matrix, saturated, _motion(flight, k + 1), imu
                    )
                    encoded = encode_frame(job.key(k), frame, reading, meta, layers)
                with watch("write"):
                    shard.add(encoded)
                told({"frame": k})
            with watch("commit"):
                return shard.commit(record, fingerprint=self._fingerprint).size

    def _record(self, job: ClipJob, stage: Stage, state: ThermalState, flight: Trajectory) -> ClipRecord:
        season = state.season
        towards_sun = sun_direction(season, np.array([state.hour]))[0]
        return ClipRecord(
            job=job,
            latitude_deg=season.latitude_deg,
            month=season.month,
            day=season.day,
            hour=state.hour,
            sun_elevation_deg=float(np.degrees(np.arcsin(np.clip(towards_sun[2], -1.0, 1.0)))),
            weather=asdict(state.weather),
            width_px=self._camera.width_px,
            height_px=self._camera.height_px,
            K=tuple((float(a), float(b), float(c)) for a, b, c in self._camera.matrix),
            band_um=self._camera.band_um,
            sensor=sensor_facts(self._recipe.sensor, self._camera.band_um),
            speed_mps=flight.speed_mps,
            spacing_m=self._recipe.flight.spacing_m,
            clearance_m=flight.clearance_m,
            rejected=flight.rejected,
            extra={
                "world": dict(stage.world.counts),
                "air_K": state.atmosphere.air_K,
                "style": flight.style,
                "rejections": dict(flight.rejections),
                "wind_mps": list(flight.wind_mps),
                "body_from_camera": flight.body_from_camera.tolist(),
            },
        )


def _motion(flight: Trajectory, k: int) -> dict[str, Any]:
    """What the JSON member says about the way of the camera past pose `k`."""
    return {
        "style": flight.style,
        "velocity_mps": flight.velocity_mps[k].tolist(),
        "previous_time_s": float(flight.time_s[k - 1]),
        "next_time_s": float(flight.time_s[k + 1]),
        "previous_from_camera": flight.relative(k - 1, k).tolist(),
        "next_from_camera": flight.relative(k + 1, k).tolist(),
    }


def worker(setup: Mapping[str, Any]) -> Callable[[dict[str, Any], Told], dict[str, Any]]:
    """Factory for `scenegen.foundation.pool.Pool`: a studio in a process of its own."""
    import cv2

    from scenegen_render import backend

    cv2.setNumThreads(1)
    backend.set_threads(1)
    studio = Studio(Recipe.model_validate(setup["recipe"]), Path(setup["root"]), setup["fingerprint"])

    def make(payload: dict[str, Any], told: Told) -> dict[str, Any]:
        value = studio.make(ClipJob(**payload), told)
        return {**value, "memory": memory_MiB()}

    return make


def memory_MiB() -> dict[str, int]:
    """Resident memory of this process now and at its peak [MiB], where the system tells."""
    try:
        lines = Path("/proc/self/status").read_text(encoding="ascii").splitlines()
    except OSError:
        return {}
    fields = dict(line.split(":", 1) for line in lines if ":" in line)
    return {name: int(fields[key].split()[0]) // 1024 for name, key in (("now", "VmRSS"), ("peak", "VmHWM"))}
