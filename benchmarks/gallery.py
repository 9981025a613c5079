"""Draw docs/pictures/maps/*.webp: every map at noon, at dusk and before sunrise, with its depth.

    python benchmarks/gallery.py [--map city coastline] [--seed 3] [--out docs/pictures/maps]

One clear summer day in the middle latitudes, two places of two flights, 320 x 256 pixels with lens and noise.
"""

from __future__ import annotations

import argparse
from pathlib import Path

import numpy as np
from PIL import Image

from scenegen.climate.season import Season
from scenegen.climate.weather import Weather
from scenegen.foundation.rng import stream
from scenegen.heat.solve import HeatModel
from scenegen.maps.registry import MAPS, build_world, map_family
from scenegen_datasets.pictures import colour
from scenegen_datasets.pictures.canvas import Canvas
from scenegen_flythrough.airspace import Airspace
from scenegen_flythrough.fly import fly
from scenegen_flythrough.knobs import FlightKnobs
from scenegen_render.bake import bake
from scenegen_render.camera import Camera
from scenegen_render.exposure.expose import expose
from scenegen_render.frame import Frame
from scenegen_render.knobs import RenderKnobs
from scenegen_render.scene import LoadedWorld, load
from scenegen_render.sensor.agc import plateau_agc
from scenegen_render.sensor.knobs import SensorKnobs
from scenegen_render.sensor.sense import sense
from scenegen_render.trace.tracer import Tracer

SEASON = Season(latitude_deg=43.0, month=7, day=15)
WEATHER = Weather(295.0, 7.0, 15.0, 285.0, 2.5, cloud_fraction=0.15, linke_turbidity=3.0)
HOURS = ((13.0, "13:00"), (20.5, "20:30, after sunset"), (4.4, "4:24, before sunrise"))
SIZE_PX = (320, 256)
FOV_DEG = 75.0
FRAMES = 24
PLACES = 2
GAP_PX, HEAD_PX = 6, 24

Pose = np.ndarray


def main() -> None:
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    parser.add_argument("--map", nargs="+", default=list(MAPS), choices=list(MAPS))
    parser.add_argument("--seed", type=int, default=3)
    parser.add_argument("--out", type=Path, default=Path(__file__).parents[1] / "docs" / "pictures" / "maps")
    asked = parser.parse_args()
    asked.out.mkdir(parents=True, exist_ok=True)
    for name in asked.map:
        path = asked.out / f"{name}.webp"
        sheet(name, asked.seed).save(path, quality=84, method=6)
        print(f"{path}: {path.stat().st_size / 1024:.0f} kB")


def sheet(name: str, seed: int) -> Image.Image:
    """Rows are places; columns the hours, then depth."""
    world = build_world(name, map_family(name).knobs(), SEASON, stream(seed, "gallery", name))
    loaded, airspace = load(world), Airspace(world)
    exposure = expose(loaded, SEASON, stream(seed, "gallery", "exposure"))
    model = HeatModel.of(world, exposure)
    camera = Camera.from_fov(*SIZE_PX, FOV_DEG)
    tracer = Tracer(camera, RenderKnobs(sub_samples=16))
    flights = [
        fly(world, FlightKnobs(), FRAMES, stream(seed, "gallery", "flight", k), airspace)
        for k in range(PLACES)
    ]
    across = len(HOURS) + 1
    canvas = Canvas(across * (SIZE_PX[0] + GAP_PX) + GAP_PX, HEAD_PX + PLACES * (SIZE_PX[1] + GAP_PX))
    frames: list[Frame] = []
    for column, (hour, words) in enumerate(HOURS):
        x = GAP_PX + column * (SIZE_PX[0] + GAP_PX)
        canvas.text(x, 17, words)
        frames = shots(tracer, loaded, model, exposure, flights, hour)
        for row, frame in enumerate(frames):
            canvas.picture(x, HEAD_PX + row * (SIZE_PX[1] + GAP_PX), thermal(frame, camera, row))
    x = GAP_PX + len(HOURS) * (SIZE_PX[0] + GAP_PX)
    canvas.text(x, 17, "depth")
    span = colour.depth_range([frame.depth for frame in frames])
    for row, frame in enumerate(frames):
        canvas.picture(x, HEAD_PX + row * (SIZE_PX[1] + GAP_PX), colour.depth(frame.depth, *span))
    loaded.release()
    return canvas.image


def shots(
    tracer: Tracer, loaded: LoadedWorld, model: HeatModel, exposure, flights, hour: float
) -> list[Frame]:
    """One frame in the middle of each flight."""
    state = model.solve(WEATHER, hour)
    irradiance = bake(loaded, exposure, state, tracer.camera.band_um)
    taken = []
    for flight in flights:
        poses, times = flight.world_from_camera, flight.time_s
        lit = tracer.light(loaded, state, irradiance, tracer.cast(loaded.world, poses, times))
        k = FRAMES // 2
        taken.append(
            tracer.frame(lit, poses[k], poses[k + 1], poses[k - 1], (times[k], times[k + 1], times[k - 1]))
        )
    return taken


def thermal(frame: Frame, camera: Camera, row: int) -> colour.Picture:
    """What the camera shows: lens, noise, plateau equalisation."""
    (reading,) = sense(
        [frame.radiance], np.zeros(1), camera, SensorKnobs(), stream(0, "gallery", "sensor", row)
    )
    grey = plateau_agc(reading.counts, max_gain=2.5)
    return np.repeat(grey[..., None], 3, axis=2)


if __name__ == "__main__":
    main()
