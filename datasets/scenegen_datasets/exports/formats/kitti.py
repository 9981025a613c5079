"""KITTI: sequences as in the odometry benchmark, depth as in the benchmark of 2017, flow as in that of 2015.

Encodings after the development kits: depth PNG16 is metres times 256 and 0 where there is none; flow PNG16 holds u and
v as ``64 px + 2^15`` and a third channel that is 1 where there is a value. Poses are rows of a 3x4 matrix from the
camera to that of the first frame. A calibration counts the centre of the first pixel as (0, 0), ours as (0.5, 0.5).

The flow benchmark has a directory of its own, since its readers (RAFT's ``KITTI``, torchvision's ``KittiFlow``) pair
files by name: ``X_10.png`` and ``X_11.png`` are a frame and the next, so that a picture is there up to three times.
"""

from __future__ import annotations

import numpy as np

from scenegen.foundation.canonical import pretty
from scenegen_datasets.exports.clip import Clip, Picture
from scenegen_datasets.exports.format import Format, Written
from scenegen_datasets.exports.gain import CHOICES, CLIPPED, CLIPPING, gain_of
from scenegen_datasets.exports.integers import FAR, FLOW_OUTSIDE, NEAR, add, depth_u16, flow_u16
from scenegen_datasets.exports.options import Options
from scenegen_datasets.exports.png import colour_png, png
from scenegen_datasets.exports.poses import integer_centres, numbers, relative_pose
from scenegen_datasets.exports.stage import Stage

UNIT_M = 1.0 / 256.0
"""What one step of depth is worth [m]."""

INVALID = {
    **CLIPPING,
    FAR: "pixels with a surface beyond 255.99 m became 0 (no depth)",
    NEAR: "pixels with a surface nearer than 2 mm became 0 (no depth)",
}


def write(clip: Clip, stage: Stage, options: Options) -> Written:
    """Write one clip as a sequence, a drive with depth, and pairs of pictures with flow."""
    split, drive = clip.job.split, clip.job.name
    home, flows = f"{split}/sequences/{drive}", f"{split}/KittiFlow/training"
    gain = gain_of(clip, options)
    counts: dict[str, int] = {}
    poses, times = [], []
    optional = [name for name in ("flow", "covisible") if name in clip.layers]
    first = None
    for picture in clip.pictures("thermal", "depth", *optional):
        image = colour_png(gain.grey(picture["thermal"]))
        stage.put(f"{home}/image_2/{picture.frame:06d}.png", image)
        depth, misfits = depth_u16(picture["depth"], UNIT_M)
        stage.put(f"{split}/{drive}/proj_depth/groundtruth/image_02/{picture.frame:010d}.png", png(depth))
        add(counts, {**misfits, CLIPPED: gain.clipped(picture["thermal"])})
        if "flow" in optional and picture.frame > 0:
            stage.put(f"{flows}/image_2/{clip.job.key(picture.frame - 1)}_11.png", image)
        if "flow" in optional and picture.frame + 1 < clip.job.frames:
            stage.put(f"{flows}/image_2/{picture.key}_10.png", image)
            add(counts, _write_flow(picture, stage, flows))
        first = picture if first is None else first
        poses.append(numbers(relative_pose(first.world_from_camera, picture.world_from_camera)[:3]))
        times.append(f"{picture.time_s:.6e}")
    assert first is not None
    stage.put(f"{split}/poses/{drive}.txt", "\n".join(poses) + "\n")
    stage.put(f"{home}/times.txt", "\n".join(times) + "\n")
    stage.put(f"{home}/calib.txt", calibration(first.K))
    stage.put(f"{home}/gain.json", pretty(dict(gain.facts)))
    return Written(counts)


def calibration(K: np.ndarray) -> str:
    """``calib.txt`` of the odometry benchmark: one camera in the place of all four, and no laser scanner."""
    P = numbers(np.column_stack([integer_centres(K), np.zeros(3)]))
    return "".join(f"P{camera}: {P}\n" for camera in range(4)) + f"Tr: {numbers(np.eye(3, 4))}\n"


def _write_flow(picture: Picture, stage: Stage, home: str) -> dict[str, int]:
    """Flow of all pixels, and of those that the next frame sees too."""
    name = f"{picture.key}_10.png"
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
    readers="KITTI odometry (pykitti, evo), depth and flow (RAFT, torchvision) readers",
    layout=(
        "`SPLIT/sequences/CLIP/image_2/N.png`, `calib.txt`, `times.txt`, `gain.json`; `SPLIT/poses/CLIP.txt`; "
        "`SPLIT/CLIP/proj_depth/groundtruth/image_02/N.png`; "
        "`SPLIT/KittiFlow/training/image_2/KEY_10.png`, `KEY_11.png`, `flow_occ/KEY_10.png`, `flow_noc/KEY_10.png`"
    ),
    range="depth to 255.99 m; flow -512 to 511.98 px",
    step="depth 1/256 m; flow 1/64 px; thermal 8 bits",
    lost="thermal beyond the gain; ids, temperature, radiance; flow of the last frame",
    sky="depth 0; flow of the rotation",
    needs=("thermal", "depth"),
    takes=("flow", "covisible"),
    bytes_per_pixel=8.0,
    write=write,
    heeds=CHOICES,
    invalid={**INVALID, FLOW_OUTSIDE: "pixels whose flow is unknown or beyond 512 px became invalid"},
)
