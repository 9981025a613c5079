"""How far the exposure is from the truth, in the image: the random part of the radiance and the bias of the bounce.

Random part: two exposures with different seeds, each looked at more closely along four default flights of 65 frames
and with its own temperatures and irradiance, photographed from the same poses; difference of the frames over the square
root of two, in mK of brightness temperature, sky left out. Split into what comes through the temperatures (sky view,
neighbours) and through the reflected irradiance.

Bias of the bounce: baked irradiance, interpolated where pixel centres meet matt surfaces, against 4,096 bounce rays
from that very place that meet the same warm surfaces; what the difference does to the radiance, in mK.

    python benchmarks/bake_error.py [--directions 64 128] [--closer-rays 60000] [--hits 1500] [--bias-only]
"""

from __future__ import annotations

import argparse
import time
from dataclasses import dataclass

import numpy as np
from places import BAND_UM, HFOV_DEG, machine

from scenegen.classes import Semantic
from scenegen.climate.season import Season
from scenegen.climate.weather import Weather
from scenegen.exposure import sky_bin_sin_elevation
from scenegen.foundation.rng import stream
from scenegen.heat.solve import HeatModel
from scenegen.maps.registry import build_world, map_family
from scenegen.radiometry.planck import band_radiance, band_radiance_slope
from scenegen.radiometry.sky import sky_radiance
from scenegen.thermal_state import ThermalState
from scenegen_flythrough.airspace import Airspace
from scenegen_flythrough.fly import fly
from scenegen_flythrough.knobs import FlightKnobs
from scenegen_render import backend
from scenegen_render.bake import bake
from scenegen_render.camera import Camera
from scenegen_render.exposure.closer import look_closer
from scenegen_render.exposure.directions import cosine_directions, tangents
from scenegen_render.exposure.expose import expose
from scenegen_render.exposure.hemisphere import sky_bin
from scenegen_render.exposure.knobs import ExposureKnobs
from scenegen_render.knobs import RenderKnobs
from scenegen_render.scene import LoadedWorld, load
from scenegen_render.trace import Tracer, pixels
from scenegen_render.trace.pose import device_pose

SEASON = Season(40.0, 7, 15)
CLEAR = Weather(294.0, 7.0, 15.0, 284.0, 3.0, cloud_fraction=0.0, linke_turbidity=3.0)
HOURS = (4.0, 14.0, 20.0)
SLOPE = float(band_radiance_slope(np.array([289.0]), BAND_UM)[0])
BOUNCES = 4096
FRAMES, EVERY = 65, 12


@dataclass(frozen=True, eq=False)
class Lighting:
    """One thermal state and the irradiance baked from it."""

    state: ThermalState
    irradiance: np.ndarray


@dataclass(frozen=True, eq=False)
class Flight:
    """Poses (frames + 2, 4, 4) flown through a world, and the ones photographed with what follows each."""

    path: np.ndarray

    @property
    def poses(self) -> list:
        return [(self.path[k], self.path[k + 1]) for k in range(1, FRAMES + 1, EVERY)]


def city() -> tuple[LoadedWorld, list[Flight]]:
    """World 0 of the city and four default flights."""
    world = build_world("city", map_family("city").knobs(), SEASON, stream(0, "benchmark", "world"))
    airspace = Airspace(world)
    flights = [
        fly(world, FlightKnobs(), FRAMES, stream(0, "benchmark", "flight", k), airspace) for k in range(4)
    ]
    return load(world), [Flight(flight.world_from_camera) for flight in flights]


def lightings(
    loaded: LoadedWorld, camera: Camera, flights: list[Flight], seed: int, knobs: ExposureKnobs
) -> list[dict[float, Lighting]]:
    """States of a clear July day for each flight, all from one exposure."""
    exposure = expose(loaded, SEASON, stream(seed, "bake error"), knobs)
    model, spent, found = HeatModel.of(loaded.world, exposure), [], []
    for k, flight in enumerate(flights):
        start = time.process_time()
        closer = look_closer(
            loaded, exposure, camera, flight.path[1:-1], stream(seed, "closer look", k), knobs
        )
        spent.append(time.process_time() - start)
        states = {hour: model.seeing(closer).solve(CLEAR, hour) for hour in HOURS}
        found.append({hour: Lighting(s, bake(loaded, closer, s, BAND_UM)) for hour, s in states.items()})
    print(f"  closer look at {FRAMES} frames: {np.median(spent):.2f} s of CPU")
    return found


def frames(
    tracer: Tracer, loaded: LoadedWorld, state: ThermalState, irradiance: np.ndarray, poses: list
) -> np.ndarray:
    """Radiance of all surfaces seen from all poses; NaN in the sky."""
    lit = tracer.light(loaded, state, irradiance)
    shot = [tracer.frame(lit, pose, ahead) for pose, ahead in poses]
    return np.stack([np.where(f.instance > 0, f.radiance, np.nan) for f in shot])


def differences(
    tracer: Tracer, loaded: LoadedWorld, flight: Flight, a: Lighting, b: Lighting
) -> dict[str, np.ndarray]:
    """Random part [mK] of every pixel of a flight: all of it, and what comes through temperatures and reflection."""
    whole = frames(tracer, loaded, a.state, a.irradiance, flight.poses)
    others = {
        "all": frames(tracer, loaded, b.state, b.irradiance, flight.poses),
        "temperature": frames(tracer, loaded, b.state, a.irradiance, flight.poses),
        "bounce": frames(tracer, loaded, a.state, b.irradiance, flight.poses),
    }
    solid = np.isfinite(whole)
    return {
        name: (other - whole)[solid].astype(np.float64) / np.sqrt(2.0) / SLOPE * 1e3
        for name, other in others.items()
    }


def random_part(
    tracer: Tracer,
    loaded: LoadedWorld,
    flights: list[Flight],
    first: list[dict[float, Lighting]],
    second: list[dict[float, Lighting]],
) -> None:
    """Print the random part at each hour."""
    for hour in HOURS:
        errors = [
            differences(tracer, loaded, flight, a[hour], b[hour])
            for flight, a, b in zip(flights, first, second, strict=True)
        ]
        told = []
        for name in errors[0]:
            error = np.concatenate([e[name] for e in errors])
            told.append(f"{name} {rms(error):.1f} rms, {np.median(np.abs(error)):.1f} median")
        each = ", ".join(f"{rms(e['all']):.0f}" for e in errors)
        print(f"  random part, {hour:g} h [mK]: " + "; ".join(told) + f"; flights {each}  (bar 20 rms)")


def rms(values: np.ndarray) -> float:
    """Root of the mean square."""
    return float(np.sqrt(np.mean(values**2)))


def places_seen(
    loaded: LoadedWorld, camera: Camera, poses: list, count: int
) -> tuple[np.ndarray, np.ndarray]:
    """Faces and barycentric coordinates of matt places met by randomly chosen pixel centres."""
    mi, _ = backend.modules()
    rng, faces, where = stream(0, "hits"), [], []
    for pose, _ in poses:
        pixel = rng.integers(0, (camera.width_px, camera.height_px), (count // len(poses), 2)) + 0.5
        plane = ((pixel - camera.centre_px) / camera.focal_px).astype(np.float32)
        moved, on_device = device_pose(pose), pixels.on_device(plane)
        ray = mi.Ray3f(moved.translation, moved.turn(on_device.x, on_device.y, mi.Float(1.0)))
        hit = loaded.scene.ray_intersect_preliminary(ray)
        met = hit.is_valid().numpy()
        faces.append(hit.prim_index.numpy()[met])
        where.append(np.stack([hit.prim_uv.x.numpy()[met], hit.prim_uv.y.numpy()[met]], axis=1))
    face, uv = np.concatenate(faces), np.concatenate(where).astype(np.float64)
    mirror = np.array([s.material.mirror is not None or s.material.mirror_reflectance is not None
                       for s in loaded.world.palette])  # fmt: skip
    matt = ~mirror[loaded.world.face_surface[face]]
    return face[matt], uv[matt]


def between_corners(values: np.ndarray, corner: np.ndarray, uv: np.ndarray) -> np.ndarray:
    """Values at corners, interpolated."""
    weight = np.stack([1 - uv.sum(axis=1), uv[:, 0], uv[:, 1]], axis=1)
    return np.einsum("pk,pk...->p...", weight, values[corner])


def normals_at(loaded: LoadedWorld, face: np.ndarray, uv: np.ndarray) -> np.ndarray:
    """Unit normals (places, 3) of the facets met; in crowns those of the sites, since leaves stand for a volume."""
    world = loaded.world
    smooth = between_corners(world.sites.normal.astype(np.float64), world.corner_site[face], uv)
    a, b, c = (world.mesh.vertices[world.mesh.faces[face][:, k]].astype(np.float64) for k in range(3))
    leaf = np.isin(world.face_semantic[face], (int(Semantic.TREE), int(Semantic.SHRUB)))
    normal = np.where(leaf[:, None], smooth, np.cross(b - a, c - a))
    return (normal / np.linalg.norm(normal, axis=1, keepdims=True)).astype(np.float32)


def told(error: np.ndarray) -> str:
    """Median, rms and 99th percentile of errors [mK]."""
    size = np.abs(error)
    return (
        f"median {np.median(size):.1f} (bar 20), rms {np.sqrt(np.mean(error**2)):.1f} (bar 40), "
        f"p99 {np.percentile(size, 99):.0f} (bar 300), mean {error.mean():+.1f}"
    )


def worst_groups(loaded: LoadedWorld, face: np.ndarray, error: np.ndarray, count: int = 6) -> list[str]:
    """Which classes and materials carry the squared error."""
    world = loaded.world
    pairs = np.column_stack([world.face_semantic[face], world.face_surface[face]])
    names = np.array(
        [f"{Semantic(int(s)).name.lower()}, {world.palette[int(p)].material.name}" for s, p in pairs]
    )
    kinds, which = np.unique(names, return_inverse=True)
    total = np.bincount(which, error**2)
    many = np.bincount(which)
    return [
        f"{total[k] / total.sum():4.0%} {kinds[k]}: {many[k]} places, rms {np.sqrt(total[k] / many[k]):.0f}"
        for k in np.argsort(-total)[:count]
    ]


def bounced(loaded: LoadedWorld, lighting: Lighting, face: np.ndarray, uv: np.ndarray) -> np.ndarray:
    """Mean radiance [W m^-2 sr^-1] over 4,096 cosine-distributed rays from each place."""
    mi, dr = backend.modules()
    world = loaded.world
    eps = np.array([s.emissivity for s in world.palette])[world.sites.surface]
    leaving = (
        eps * band_radiance(lighting.state.temperature_K, BAND_UM) + (1 - eps) * lighting.irradiance / np.pi
    )
    sine = sky_bin_sin_elevation()
    sine[0] = -1.0
    above = sky_radiance(sine, lighting.state.atmosphere, BAND_UM)
    glow, sky = backend.upload(leaving.astype(np.float32)), backend.upload(above.astype(np.float32))
    point = between_corners(world.mesh.vertices.astype(np.float64), world.mesh.faces[face], uv)
    normal = normals_at(loaded, face, uv)
    turn = stream(0, "bounces").random(len(face), dtype=np.float32)
    first, second = tangents(normal, turn)
    local = cosine_directions(BOUNCES).astype(np.float32)
    mean = np.empty(len(face))
    for k in range(len(face)):
        toward = local[:, :1] * first[k] + local[:, 1:2] * second[k] + local[:, 2:] * normal[k]
        direction = dr.gather(mi.Vector3f, backend.upload(toward), dr.arange(mi.UInt, BOUNCES))
        origin = mi.Point3f(*(dr.opaque(mi.Float, float(c)) for c in point[k] + 2e-3 * normal[k]))
        hit = loaded.scene.ray_intersect_preliminary(mi.Ray3f(origin, direction))
        met = hit.is_valid()
        face_met = dr.select(met, hit.prim_index, 0)
        a, b, c = (
            dr.gather(mi.Float, glow, dr.gather(mi.UInt, loaded.face_record, face_met * 4 + n))
            for n in range(3)
        )
        u, v = hit.prim_uv.x, hit.prim_uv.y
        seen = dr.select(met, (1 - u - v) * a + u * b + v * c, dr.gather(mi.Float, sky, sky_bin(direction.z)))
        mean[k] = float(np.mean(seen.numpy(), dtype=np.float64))
    return mean


def bounce_errors(
    loaded: LoadedWorld, camera: Camera, flight: Flight, lighting: Lighting, count: int
) -> tuple[np.ndarray, np.ndarray]:
    """Faces of places seen on a flight, and the error of the baked bounce there [mK]."""
    world = loaded.world
    face, uv = places_seen(loaded, camera, flight.poses, count)
    baked = between_corners(lighting.irradiance.astype(np.float64) / np.pi, world.corner_site[face], uv)
    eps = np.array([s.emissivity for s in world.palette])[world.face_surface[face]]
    return face, (1 - eps) * (baked - bounced(loaded, lighting, face, uv)) / SLOPE * 1e3


def bounce_bias(
    loaded: LoadedWorld, camera: Camera, flights: list[Flight], lit: list[Lighting], count: int
) -> None:
    """Print the error of the baked bounce."""
    pairs = [
        bounce_errors(loaded, camera, flight, lighting, count // len(flights))
        for flight, lighting in zip(flights, lit, strict=True)
    ]
    face, error = (np.concatenate(part) for part in zip(*pairs, strict=True))
    leaf = np.isin(loaded.world.face_semantic[face], (int(Semantic.TREE), int(Semantic.SHRUB)))
    print(f"  baked bounce against {BOUNCES:,} rays at {len(face):,} places [mK]: {told(error)}")
    print(f"    without crowns, {np.count_nonzero(~leaf):,} places: {told(error[~leaf])}")
    for line in worst_groups(loaded, face, error):
        print(f"    {line}")


def main() -> None:
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    parser.add_argument("--directions", type=int, nargs="+", default=[ExposureKnobs().directions])
    parser.add_argument("--closer-rays", type=int, default=ExposureKnobs().closer_rays, help="a frame")
    parser.add_argument("--hits", type=int, default=1500)
    parser.add_argument("--bias-only", action="store_true", help="leave out the random part")
    parser.add_argument("--random-only", action="store_true", help="leave out the bias of the bounce")
    asked = parser.parse_args()
    loaded, flights = city()
    camera = Camera.from_fov(256, 256, HFOV_DEG)
    tracer = Tracer(camera, RenderKnobs())
    print(machine())
    for directions in asked.directions:
        print(f"{directions} directions, {asked.closer_rays:,} closer rays a frame", end=", ")
        print(f"{len(loaded.world.sites.area):,} sites, {len(flights)} flights")
        knobs = ExposureKnobs(directions=directions, closer_rays=asked.closer_rays)
        first = lightings(loaded, camera, flights, 1, knobs)
        if not asked.bias_only:
            second = lightings(loaded, camera, flights, 2, knobs)
            random_part(tracer, loaded, flights, first, second)
        for hour in () if asked.random_only else (4.0, 14.0):
            bounce_bias(loaded, camera, flights, [lit[hour] for lit in first], asked.hits)


if __name__ == "__main__":
    main()
