"""Where the rendering benchmarks take place: a generated world with real flights, or a quick city of plain boxes."""

from __future__ import annotations

import argparse
import dataclasses
import platform
import time
from collections.abc import Callable
from dataclasses import dataclass
from functools import partial

import numpy as np

from scenegen.climate.season import Season
from scenegen.climate.weather import Weather
from scenegen.foundation.rng import stream
from scenegen.heat.solve import HeatModel
from scenegen.maps.registry import MAPS, build_world, map_family
from scenegen.materials.material import Surface
from scenegen.materials.table import material
from scenegen.radiometry.atmosphere import Atmosphere
from scenegen.thermal_state import ThermalState
from scenegen_flythrough.airspace import Airspace
from scenegen_flythrough.fly import fly
from scenegen_flythrough.knobs import FlightKnobs
from scenegen_render import backend, reference_scenes
from scenegen_render.bake import bake
from scenegen_render.exposure.expose import expose
from scenegen_render.scene import LoadedWorld, load

BAND_UM = (8.0, 14.0)
SIZES = ((256, 256), (640, 512))
HFOV_DEG = 90.0
SEASON = Season(40.0, 7, 15)
_AFTERNOON = Weather(294.0, 7.0, 15.0, 284.0, 3.0, cloud_fraction=0.3, linke_turbidity=3.0)


@dataclass(frozen=True, eq=False)
class Place:
    """A lit world and where the camera stands in it.

    Attributes
    ----------
    name : str
    loaded : LoadedWorld
    state : ThermalState
    irradiance : float32 (sites,)
    poses : list of (pose, next pose)
    """

    name: str
    loaded: LoadedWorld
    state: ThermalState
    irradiance: np.ndarray
    poses: list[tuple[np.ndarray, np.ndarray]]


def of_map(name: str) -> Place:
    """World 0 of a map on a July afternoon, twelve poses from four default flights."""
    world = build_world(name, map_family(name).knobs(), SEASON, stream(0, "benchmark", "world"))
    loaded, airspace = load(world), Airspace(world)
    exposure = expose(loaded, SEASON, stream(0, "benchmark", "exposure"))
    state = HeatModel.of(world, exposure).solve(_AFTERNOON, 15.0)
    flights = [
        fly(world, FlightKnobs(), 16, stream(0, "benchmark", "flight", k), airspace).world_from_camera
        for k in range(4)
    ]
    poses = [(path[k], path[k + 1]) for path in flights for k in (2, 8, 14)]
    return Place(name, loaded, state, bake(loaded, exposure, state, BAND_UM), poses)


def boxes() -> Place:
    """About 540,000 triangles of boxes with window bands; twelve drawn poses 20 to 60 m above the streets."""
    rows = [material(name) for name in ("asphalt_aged", "brick_red", "bitumen_felt_roof", "window_glass")]
    ground, wall, roof, glass = (Surface(m, m.emissivity, m.solar_absorptance) for m in rows)
    world = reference_scenes.box_city((ground, wall, roof, glass), stream(0, "benchmark", "boxes"))
    state = reference_scenes.uniform_state(
        world, 295.0, Atmosphere(293.0, 12.0, cloud_fraction=0.3, cloud_K=280.0)
    )
    warm = np.array([300.0, 296.0, 305.0, 297.0], np.float32)[world.sites.surface]
    texture = np.array([s.material.texture_K for s in world.palette], np.float32)
    state = dataclasses.replace(state, temperature_K=warm, texture_K=texture)
    rng, poses = stream(0, "benchmark", "poses"), []
    for _ in range(12):
        x, y, z = map(float, (*rng.uniform(-250.0, 250.0, 2), rng.uniform(20.0, 60.0)))
        pose = reference_scenes.looking(
            (x, y, z), float(rng.uniform(0.0, 360.0)), -float(rng.uniform(5.0, 35.0))
        )
        ahead = pose.copy()
        ahead[:3, 3] += pose[:3, 2]
        poses.append((pose, ahead))
    return Place("boxes", load(world), state, np.full(len(world.sites.area), 120.0, np.float32), poses)


PLACES: dict[str, Callable[[], Place]] = {name: partial(of_map, name) for name in MAPS} | {"boxes": boxes}


def chosen(about: str | None) -> Place:
    """Place asked for on the command line; prints machine and place."""
    parser = argparse.ArgumentParser(description=about, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--place", choices=sorted(PLACES), default="city")
    place = PLACES[parser.parse_args().place]()
    print(machine())
    print(f"{place.name}: {len(place.loaded.world.mesh.faces):,} triangles, {len(place.poses)} poses")
    return place


def cpu_ms(call: Callable[[], object]) -> float:
    """CPU time of one call [ms]."""
    start = time.process_time()
    call()
    return (time.process_time() - start) * 1e3


def machine() -> str:
    """One line that says what the figures were measured with."""
    b = backend.describe()
    versions = ", ".join(f"{name} {version}" for name, version in b.versions)
    cpu = f"{b.cpu_model} ({b.cpu_class}), {b.threads} thread"
    return f"{cpu}, LLVM {b.llvm_version}, {versions}, {platform.platform()}"
