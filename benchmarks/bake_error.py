"""How far the exposure is from the truth, in the image: the random part of the radiance and the bias of the bounce.

Random part: two exposures with different seeds, each with its own temperatures and irradiance, photographed from the
same poses; difference of the frames over the square root of two, in mK of brightness temperature, sky left out. Split
into what comes through the temperatures (sky view, neighbours) and through the reflected irradiance.

Bias of the bounce: baked irradiance, interpolated where pixel centres meet matt surfaces, against 4,096 bounce rays
from that very place that meet the same warm surfaces; what the difference does to the radiance, in mK.

    python benchmarks/bake_error.py [--directions 64 128] [--hits 1500] [--bias-only]
"""

from __future__ import annotations

import argparse
from dataclasses import dataclass

import numpy as np
from places import BAND_UM, HFOV_DEG, machine, of_map

from scenegen.classes import Semantic
from scenegen.climate.season import Season
from scenegen.climate.weather import Weather
from scenegen.exposure import sky_bin_sin_elevation
from scenegen.foundation.rng import stream
from scenegen.heat.solve import HeatModel
from scenegen.radiometry.planck import band_radiance, band_radiance_slope
from scenegen.radiometry.sky import sky_radiance
from scenegen.thermal_state import ThermalState
from scenegen_render import backend
from scenegen_render.bake import bake
from scenegen_render.camera import Camera
from scenegen_render.exposure.directions import cosine_directions, tangents
from scenegen_render.exposure.expose import expose
from scenegen_render.exposure.hemisphere import sky_bin
from scenegen_render.exposure.knobs import ExposureKnobs
from scenegen_render.knobs import RenderKnobs
from scenegen_render.scene import LoadedWorld
from scenegen_render.trace import Tracer, pixels
from scenegen_render.trace.pose import device_pose

SEASON = Season(40.0, 7, 15)
CLEAR = Weather(294.0, 7.0, 15.0, 284.0, 3.0, cloud_fraction=0.0, linke_turbidity=3.0)
HOURS = (4.0, 14.0, 20.0)
SLOPE = float(band_radiance_slope(np.array([289.0]), BAND_UM)[0])
BOUNCES = 4096


@dataclass(frozen=True, eq=False)
class Lighting:
    """One thermal state and the irradiance baked from it."""

    state: ThermalState
    irradiance: np.ndarray


def lightings(loaded: LoadedWorld, seed: int, knobs: ExposureKnobs) -> dict[float, Lighting]:
    """States of a clear July day, all from one exposure."""
    exposure = expose(loaded, SEASON, stream(seed, "bake error"), knobs)
    model = HeatModel.of(loaded.world, exposure)
    states = {hour: model.solve(CLEAR, hour) for hour in HOURS}
    return {hour: Lighting(s, bake(loaded, exposure, s, BAND_UM, knobs)) for hour, s in states.items()}


def frames(
    tracer: Tracer, loaded: LoadedWorld, state: ThermalState, irradiance: np.ndarray, poses: list
) -> np.ndarray:
    """Radiance of all surfaces seen from all poses; NaN in the sky."""
    lit = tracer.light(loaded, state, irradiance)
    shot = [tracer.frame(lit, pose, ahead) for pose, ahead in poses]
    return np.stack([np.where(f.instance > 0, f.radiance, np.nan) for f in shot])


def random_part(
    tracer: Tracer, loaded: LoadedWorld, poses: list, knobs: ExposureKnobs
) -> dict[float, Lighting]:
    """Print the random part at each hour; returns the first exposure's lightings."""
    first, second = (lightings(loaded, seed, knobs) for seed in (1, 2))
    for hour in HOURS:
        a, b = first[hour], second[hour]
        whole = frames(tracer, loaded, a.state, a.irradiance, poses)
        parts = {
            "all": frames(tracer, loaded, b.state, b.irradiance, poses),
            "temperature": frames(tracer, loaded, b.state, a.irradiance, poses),
            "bounce": frames(tracer, loaded, a.state, b.irradiance, poses),
        }
        told = []
        for name, other in parts.items():
            error = (other - whole)[np.isfinite(whole)].astype(np.float64) / np.sqrt(2.0) / SLOPE * 1e3
            told.append(f"{name} {np.sqrt(np.mean(error**2)):.1f} rms, {np.median(np.abs(error)):.1f} median")
        print(f"  random part, {hour:g} h [mK]: " + "; ".join(told) + "  (bar 20 rms)")
    return first


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


def bounce_bias(loaded: LoadedWorld, camera: Camera, poses: list, lighting: Lighting, count: int) -> None:
    """Print the error of the baked bounce."""
    world = loaded.world
    face, uv = places_seen(loaded, camera, poses, count)
    baked = between_corners(lighting.irradiance.astype(np.float64) / np.pi, world.corner_site[face], uv)
    eps = np.array([s.emissivity for s in world.palette])[world.face_surface[face]]
    error = (1 - eps) * (baked - bounced(loaded, lighting, face, uv)) / SLOPE * 1e3
    leaf = np.isin(world.face_semantic[face], (int(Semantic.TREE), int(Semantic.SHRUB)))
    print(f"  baked bounce against {BOUNCES:,} rays at {len(face):,} places [mK]: {told(error)}")
    print(f"    without crowns, {np.count_nonzero(~leaf):,} places: {told(error[~leaf])}")
    for line in worst_groups(loaded, face, error):
        print(f"    {line}")


def main() -> None:
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    parser.add_argument("--directions", type=int, nargs="+", default=[ExposureKnobs().directions])
    parser.add_argument("--hits", type=int, default=1500)
    parser.add_argument("--bias-only", action="store_true", help="leave out the random part")
    asked = parser.parse_args()
    place = of_map("city")
    camera = Camera.from_fov(256, 256, HFOV_DEG)
    tracer = Tracer(camera, RenderKnobs())
    print(machine())
    for directions in asked.directions:
        print(
            f"{directions} directions, {len(place.loaded.world.sites.area):,} sites, {len(place.poses)} poses"
        )
        knobs = ExposureKnobs(directions=directions)
        if asked.bias_only:
            first = lightings(place.loaded, 1, knobs)
        else:
            first = random_part(tracer, place.loaded, place.poses, knobs)
        for hour in (4.0, 14.0):
            bounce_bias(place.loaded, camera, place.poses, first[hour], asked.hits)


if __name__ == "__main__":
    main()
