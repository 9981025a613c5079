"""A world photographed for people: from straight above, from the air beside it, and from a drone inside it."""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np
from jaxtyping import Float32, Float64, UInt16

from scenegen.foundation.errors import RejectedDrawError
from scenegen.foundation.rng import stream
from scenegen.movers.clock import Clock
from scenegen.thermal_state import ThermalState
from scenegen.world import World
from scenegen_datasets.job import ClipJob
from scenegen_datasets.pictures.shot import Shot
from scenegen_datasets.plan import split_of
from scenegen_datasets.recipe import Recipe
from scenegen_datasets.splits.draw import draw_conditions
from scenegen_datasets.stage import Stage
from scenegen_flythrough.fly import fly
from scenegen_render.bake import bake
from scenegen_render.camera import Camera
from scenegen_render.frame import Frame
from scenegen_render.knobs import RenderKnobs
from scenegen_render.sensor.scale import CountScale, counts_to_brightness_K, radiance_to_counts
from scenegen_render.trace.lit import Lit
from scenegen_render.trace.tracer import Tracer

VIEW_PX = 440
"""Side of one picture."""

_PLAN_FOV_DEG = 4.0
_BIRD_FOV_DEG = 40.0
_BIRD_PITCH_DEG = 33.0
_DRONE_FOV_DEG = 90.0
_MARGIN = 1.06
_HAZY_M = 1500.0  # larger worlds are seen from so far that a camera would see little but air
_FLIGHT_FRAMES = 65
_SPREAD_COUNTS = 400.0

Pose = Float64[np.ndarray, "4 4"]


@dataclass(frozen=True, eq=False)
class View:
    """One place to look from, and what is seen there.

    Attributes
    ----------
    title, caption : str
    frame : Frame
        With normals.
    shot : Shot
        The same for the functions that draw; its thermal layer is what `caption` says.
    sees_air : bool
        False where the thermal picture is the temperature of the surfaces themselves.
    """

    title: str
    caption: str
    frame: Frame
    shot: Shot
    sees_air: bool


def photograph(stage: Stage, recipe: Recipe, map: str, index: int) -> tuple[ThermalState, tuple[View, ...]]:
    """Plan, bird's-eye and drone's view of a world, in the weather and at the hour of its first clip.

    Parameters
    ----------
    stage : Stage
        Of world `index` of `map`.
    recipe : Recipe
        Brings seed, climate, what is held out, flight, band and count scale; pictures have a size of their own.
    """
    path, held_out = ("clip", map, index, 0), recipe.splits.held_out
    first = ClipJob(0, map, index, 0, split_of(index, map in held_out.maps), recipe.pairs_per_clip)
    weather, hour = draw_conditions(recipe.climate, held_out, stage.exposure.season, recipe.seed, first)
    state = stage.heat.solve(weather, hour)
    clock = Clock.draw(stream(recipe.seed, *path, "clock")) if recipe.movers else Clock.stopped()
    studio = _Studio(stage, recipe, state, float(clock.at(np.zeros(1))[0]))
    across_m = 2.0 * _half_size_m(stage.world)
    return state, (
        studio.view(
            "plan", f"{across_m:.0f} m across, north up", _PLAN_FOV_DEG, plan_pose(stage.world), False
        ),
        studio.view(
            "bird's eye", "from the south-west", _BIRD_FOV_DEG, bird_pose(stage.world), across_m < _HAZY_M
        ),
        _best_drone_view(studio, stage, recipe, stream(recipe.seed, *path, "flight")),
    )


def _best_drone_view(studio: _Studio, stage: Stage, recipe: Recipe, rng: np.random.Generator) -> View:
    """Of three moments of the flight the one that shows most classes."""
    views = [
        studio.view("drone", words, _DRONE_FOV_DEG, pose, True)
        for pose, words in drone_poses(stage, recipe, rng)
    ]
    return max(views, key=lambda view: np.unique(view.frame.semantic).size)


class _Studio:
    """Takes pictures of one world in one thermal state, all at the same instant."""

    def __init__(self, stage: Stage, recipe: Recipe, state: ThermalState, time_s: float) -> None:
        self._recipe, self._time_s = recipe, time_s
        band = recipe.camera.band_um
        irradiance = bake(stage.loaded, stage.exposure, state, band)
        everyone = range(len(stage.world.movers))
        # What a tracer makes of a state depends on the band alone, not on lens or size.
        self._lit: Lit = self._tracer(_DRONE_FOV_DEG).light(stage.loaded, state, irradiance, everyone)

    def view(self, title: str, caption: str, fov_deg: float, pose: Pose, sees_air: bool) -> View:
        """Photograph from one pose."""
        frame = self._tracer(fov_deg).frame(self._lit, pose, pose, times_s=(self._time_s,) * 3)
        if sees_air:
            scale = CountScale.of(self._recipe.sensor, self._recipe.camera.band_um)
            counts = radiance_to_counts(frame.radiance, scale)
            thermal = counts_to_brightness_K(counts, scale)
        else:
            thermal = np.where(frame.instance > 0, frame.temperature, _coldest(frame)).astype(np.float32)
            counts = _spread(thermal)
        shot = Shot(title, caption, counts, thermal, frame.depth, frame.semantic, frame.instance)
        return View(title, caption, frame, shot, sees_air)

    def _tracer(self, fov_deg: float) -> Tracer:
        camera = Camera.from_fov(VIEW_PX, VIEW_PX, fov_deg, self._recipe.camera.band_um)
        return Tracer(camera, RenderKnobs(normals=True))


def _spread(thermal_K: Float32[np.ndarray, "rows columns"]) -> UInt16[np.ndarray, "rows columns"]:
    """Temperatures as counts that use the greys well, however little they differ."""
    low, high = np.percentile(thermal_K, (0.5, 99.5))
    scaled = (thermal_K - low) * (_SPREAD_COUNTS / max(float(high - low), 0.1)) + _SPREAD_COUNTS
    return np.asarray(np.rint(np.clip(scaled, 0.0, 4.0 * _SPREAD_COUNTS)), np.uint16)


def _coldest(frame: Frame) -> float:
    """Stands for what lies outside the world, so that it does not stretch the greys."""
    seen = frame.temperature[frame.instance > 0]
    return float(seen.min()) if seen.size else 273.15


def plan_pose(world: World) -> Pose:
    """Straight down on the middle of the flight box, north up, from so far that the lens hardly matters."""
    middle = _middle(world)
    distance = _half_size_m(world) / math.tan(math.radians(_PLAN_FOV_DEG) / 2)
    return looking_at(middle + np.array([0.0, 0.0, distance]), middle)


def bird_pose(world: World) -> Pose:
    """From the south-west, high enough that the whole flight box is in the picture."""
    middle = _middle(world)
    pitch = math.radians(_BIRD_PITCH_DEG)
    distance = 1.2 * _half_size_m(world) / math.tan(math.radians(_BIRD_FOV_DEG) / 2)
    away = np.array([-math.cos(pitch) / math.sqrt(2), -math.cos(pitch) / math.sqrt(2), math.sin(pitch)])
    return looking_at(middle + distance * away, middle)


def drone_poses(stage: Stage, recipe: Recipe, rng: np.random.Generator) -> list[tuple[Pose, str]]:
    """Poses of a flight as clips fly it, and a few words about each.

    Where no flight of this recipe fits into the world, the camera stands above its middle and says so.
    """
    world = stage.world
    try:
        flight = fly(world, recipe.flight, _FLIGHT_FRAMES, rng, stage.airspace)
    except RejectedDrawError:
        middle = _middle(world)
        half = _half_size_m(world)
        pose = looking_at(middle + np.array([0.0, -0.5 * half, 0.4 * half]), middle)
        return [(pose, "no flight of this recipe fits in here")]
    poses = flight.world_from_camera[[_FLIGHT_FRAMES // 4, _FLIGHT_FRAMES // 2, 3 * _FLIGHT_FRAMES // 4]]
    heights = poses[:, 2, 3] - world.ground.at(poses[:, :2, 3])
    return [
        (pose, f"{height:.0f} m above ground, {flight.speed_mps:.0f} m/s")
        for pose, height in zip(poses, heights, strict=True)
    ]


def looking_at(eye: Float64[np.ndarray, "3"], target: Float64[np.ndarray, "3"]) -> Pose:
    """`world_from_camera` of a level camera that looks at a point; straight down, north is up."""
    forward = (target - eye) / np.linalg.norm(target - eye)
    right = np.cross(forward, [0.0, 0.0, 1.0])
    length = np.linalg.norm(right)
    right = right / length if length > 1e-6 else np.array([1.0, 0.0, 0.0])
    pose = np.eye(4)
    pose[:3, :3] = np.stack([right, np.cross(forward, right), forward], axis=-1)
    pose[:3, 3] = eye
    return pose


def _half_size_m(world: World) -> float:
    low, high = np.asarray(world.flight_box_m)
    return float(_MARGIN * (high - low)[:2].max() / 2)


def _middle(world: World) -> Float64[np.ndarray, "3"]:
    """Of the flight box, on the ground."""
    low, high = np.asarray(world.flight_box_m)
    xy = (low[:2] + high[:2]) / 2
    return np.array([*xy, float(world.ground.at(xy[None])[0])])
