"""COLMAP: a sparse model as text per clip, pictures, and dense depth maps (https://colmap.github.io/format.html).

Poses are camera from world, quaternions (w, x, y, z); pixel centres are at half-integers, as ours are. The points of
the model are surfaces seen through a grid of pixels, each with the one picture that gave it as its track: a start for
Gaussian splatting, not the result of matching. Depth maps are float32 and exact.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from jaxtyping import Float64, Int64, UInt8

from scenegen.foundation.canonical import pretty
from scenegen_datasets.exports.clip import Clip, Picture
from scenegen_datasets.exports.format import Format, Written
from scenegen_datasets.exports.gain import CHOICES, CLIPPED, CLIPPING, gain_of
from scenegen_datasets.exports.integers import add
from scenegen_datasets.exports.options import Options
from scenegen_datasets.exports.png import colour_png
from scenegen_datasets.exports.poses import inverse, numbers, quaternion_xyzw
from scenegen_datasets.exports.stage import Stage

POINTS_PER_IMAGE = 400
"""About as many points each picture gives to the sparse model."""


def write(clip: Clip, stage: Stage, options: Options) -> Written:
    """Write one clip as a workspace."""
    home = f"{clip.job.split}/{clip.job.name}"
    gain = gain_of(clip, options)
    counts: dict[str, int] = {}
    images, points = [], []
    total = 0
    for picture in clip.pictures("thermal", "depth"):
        name = f"{picture.frame:06d}.png"
        grey = gain.grey(picture["thermal"])
        stage.put(f"{home}/images/{name}", colour_png(grey))
        stage.put(f"{home}/stereo/depth_maps/{name}.geometric.bin", depth_map(picture["depth"]))
        seen = _seen(picture, grey)
        images.append(_image(picture, name, seen, total))
        points.append(_points(picture, seen, total))
        total += len(seen.world)
        add(counts, {CLIPPED: gain.clipped(picture["thermal"])})
    rows, columns = clip.shape
    K = picture.K
    camera = f"1 PINHOLE {columns} {rows} {numbers(np.array([K[0, 0], K[1, 1], K[0, 2], K[1, 2]]))}\n"
    stage.put(f"{home}/sparse/0/cameras.txt", f"# CAMERA_ID, MODEL, WIDTH, HEIGHT, PARAMS[]\n{camera}")
    head = "# IMAGE_ID, QW, QX, QY, QZ, TX, TY, TZ, CAMERA_ID, NAME\n# POINTS2D[] as (X, Y, POINT3D_ID)\n"
    stage.put(f"{home}/sparse/0/images.txt", head + "".join(images))
    head = "# POINT3D_ID, X, Y, Z, R, G, B, ERROR, TRACK[] as (IMAGE_ID, POINT2D_IDX)\n"
    stage.put(f"{home}/sparse/0/points3D.txt", head + "".join(points))
    stage.put(f"{home}/gain.json", pretty(dict(gain.facts)))
    return Written(counts)


def depth_map(depth: np.ndarray) -> bytes:
    """COLMAP's own array file: ``width&height&channels&`` and float32 values, 0 where there is no surface."""
    rows, columns = depth.shape
    values = np.where(np.isinf(depth), np.float32(0), depth).astype("<f4")
    return f"{columns}&{rows}&1&".encode() + values.tobytes()


@dataclass(frozen=True, eq=False)
class _Seen:
    """Surfaces seen through a grid of pixels: where in the picture, where in the world, how grey."""

    pixel: Float64[np.ndarray, "points 2"]
    world: Float64[np.ndarray, "points 3"]
    grey: UInt8[np.ndarray, "points"]


def _seen(picture: Picture, grey: np.ndarray) -> _Seen:
    depth = picture["depth"]
    rows, columns = depth.shape
    step = max(1, round((rows * columns / POINTS_PER_IMAGE) ** 0.5))
    v, u = (axis.ravel() for axis in np.mgrid[step // 2 : rows : step, step // 2 : columns : step])
    u, v = _with_surface(depth, u, v)
    rays = np.linalg.solve(picture.K, np.stack([u + 0.5, v + 0.5, np.ones(u.shape)]))
    pose = picture.world_from_camera
    world = pose[:3, :3] @ (rays * depth[v, u]) + pose[:3, 3:]
    return _Seen(
        np.stack([u + 0.5, v + 0.5], axis=1), np.asarray(world.T, np.float64), np.asarray(grey[v, u])
    )


def _with_surface(
    depth: np.ndarray, u: Int64[np.ndarray, "all"], v: Int64[np.ndarray, "all"]
) -> tuple[np.ndarray, np.ndarray]:
    there = np.isfinite(depth[v, u])
    return u[there], v[there]


def _image(picture: Picture, name: str, seen: _Seen, before: int) -> str:
    """Two lines: pose, and which points are seen where. Identifiers count from 1."""
    pose = inverse(picture.world_from_camera)
    x, y, z, w = quaternion_xyzw(pose)
    head = f"{picture.frame + 1} {numbers(np.array([w, x, y, z]))} {numbers(pose[:3, 3])} 1 {name}\n"
    tail = " ".join(f"{u!r} {v!r} {before + k + 1}" for k, (u, v) in enumerate(seen.pixel.tolist()))
    return f"{head}{tail}\n"


def _points(picture: Picture, seen: _Seen, before: int) -> str:
    rows = zip(seen.world, seen.grey.tolist(), strict=True)
    return "".join(
        f"{before + k + 1} {numbers(place)} {g} {g} {g} 0 {picture.frame + 1} {k}\n"
        for k, (place, g) in enumerate(rows)
    )


FORMAT = Format(
    name="colmap",
    readers="COLMAP, pycolmap, 3D Gaussian splatting, gsplat",
    layout=(
        "`SPLIT/CLIP/images/N.png`, `sparse/0/{cameras,images,points3D}.txt`, "
        "`stereo/depth_maps/N.png.geometric.bin`, `gain.json`"
    ),
    range="depth any",
    step="depth none; thermal 8 bits",
    lost="thermal beyond the gain; flow, times, ids, temperature, radiance",
    sky="depth 0",
    needs=("thermal", "depth"),
    bytes_per_pixel=5.7,
    write=write,
    heeds=CHOICES,
    invalid=CLIPPING,
)
