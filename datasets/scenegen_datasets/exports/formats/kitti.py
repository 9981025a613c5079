"""KITTI: drives as in the raw data, depth as in the depth benchmark of 2017, flow as in the flow benchmarks.

Encodings after the development kits: depth PNG16 is metres times 256 and 0 where there is none; flow PNG16 holds u and
v as ``64 px + 2^15`` and a third channel that is 1 where there is a value. Poses are those of the odometry benchmark:
rows of a 3x4 matrix from the camera to that of the first frame. A calibration counts the centre of the first pixel
as (0, 0), ours as (0.5, 0.5).
"""

from __future__ import annotations

from typing import Any

import numpy as np

from scenegen.foundation.canonical import pretty
from scenegen_datasets.exports.clip import Clip, Picture
from scenegen_datasets.exports.format import Format, Written
from scenegen_datasets.exports.gain import CLIPPED, gain_of
from scenegen_datasets.exports.integers import FAR, FLOW_OUTSIDE, NEAR, add, depth_u16, flow_u16, png
from scenegen_datasets.exports.options import Options
from scenegen_datasets.exports.poses import integer_centres, numbers, relative_pose
from scenegen_datasets.exports.stage import Stage

UNIT_M = 1.0 / 256.0
"""What one step of depth is worth [m]."""

INVALID = {
    CLIPPED: "thermal pixels beyond the gain became black or white",
    FAR: "pixels with a surface beyond 255.99 m became 0 (no depth)",
    NEAR: "pixels with a surface nearer than 2 mm became 0 (no depth)",
}


def write(clip: Clip, stage: Stage, options: Options) -> Written:
    """Write one clip as a drive."""
    home = f"{clip.job.split}/{clip.job.name}"
    gain = gain_of(clip, options)
    counts: dict[str, int] = {}
    poses, times = [], []
    optional = [name for name in ("flow", "covisible") if name in clip.layers]
    first = None
    for picture in clip.pictures("thermal", "depth", *optional):
        name = f"{picture.frame:010d}.png"
        stage.put(f"{home}/image_02/data/{name}", png(gain.grey(picture["thermal"])))
        depth, misfits = depth_u16(picture["depth"], UNIT_M)
        stage.put(f"{home}/proj_depth/groundtruth/image_02/{name}", png(depth))
        add(counts, {**misfits, CLIPPED: gain.clipped(picture["thermal"])})
        if "flow" in optional and picture.frame + 1 < clip.job.frames:
            add(counts, _write_flow(picture, stage, home))
        first = picture if first is None else first
        pose = relative_pose(first.world_from_camera, picture.world_from_camera)
        poses.append(numbers(pose[:3]))
        times.append(f"{picture.time_s:.6e}")
    assert first is not None
    stage.put(f"{home}/poses.txt", "\n".join(poses) + "\n")
    stage.put(f"{home}/times.txt", "\n".join(times) + "\n")
    stage.put(f"{home}/calib_cam_to_cam.txt", calibration(first, clip.shape))
    stage.put(f"{home}/gain.json", pretty(dict(gain.facts)))
    return Written(counts)


def calibration(picture: Picture, shape: tuple[int, int]) -> str:
    """``calib_cam_to_cam.txt`` of one rectified camera, number 02."""
    K = integer_centres(picture.K)
    size = f"{shape[1]:e} {shape[0]:e}"
    P = np.column_stack([K, np.zeros(3)])
    rows: dict[str, Any] = {
        "S_02": size,
        "K_02": numbers(K),
        "D_02": numbers(np.zeros(5)),
        "R_02": numbers(np.eye(3)),
        "T_02": numbers(np.zeros(3)),
        "S_rect_02": size,
        "R_rect_02": numbers(np.eye(3)),
        "P_rect_02": numbers(P),
    }
    return "corner_dist: 0.0\n" + "".join(f"{name}: {value}\n" for name, value in rows.items())


def _write_flow(picture: Picture, stage: Stage, home: str) -> dict[str, int]:
    """Flow of all pixels, and of those that the next frame sees too."""
    name = f"{picture.frame:010d}.png"
    flow = picture["flow"]
    values, kept, outside = flow_u16(flow)
    stage.put(f"{home}/flow_occ/{name}", png(_channels(values, kept)))
    if "covisible" in picture.arrays:
        values, kept, _ = flow_u16(flow, picture["covisible"])
        stage.put(f"{home}/flow_noc/{name}", png(_channels(values, kept)))
    return {FLOW_OUTSIDE: outside}


def _channels(values: np.ndarray, kept: np.ndarray) -> np.ndarray:
    """Red u, green v, blue valid; OpenCV writes blue first."""
    return np.dstack([kept.astype(np.uint16), values[..., 1], values[..., 0]])


FORMAT = Format(
    name="kitti",
    readers="KITTI raw, depth, odometry and flow readers",
    layout=(
        "`SPLIT/CLIP/image_02/data/N.png`, `proj_depth/groundtruth/image_02/N.png`, `flow_occ/N.png`, "
        "`flow_noc/N.png`, `poses.txt`, `times.txt`, `calib_cam_to_cam.txt`, `gain.json`"
    ),
    range="depth to 255.99 m; flow -512 to 511.98 px",
    step="depth 1/256 m; flow 1/64 px; thermal 8 bits",
    lost="thermal beyond the gain; ids, temperature, radiance; flow of the last frame",
    sky="depth 0; flow of the rotation",
    needs=("thermal", "depth"),
    takes=("flow", "covisible"),
    bytes_per_pixel=5.0,
    write=write,
    heeds=frozenset({"gain", "gain_K"}),
    invalid={**INVALID, FLOW_OUTSIDE: "pixels whose flow is unknown or beyond 512 px became invalid"},
)
