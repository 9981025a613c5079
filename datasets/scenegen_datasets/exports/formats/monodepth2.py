"""monodepth2: KITTI drives, split files and ground truth as its KITTIDepthDataset and ``evaluate_depth.py`` read them.

A line of a split file is ``folder frame side``. Frames at the ends of a clip are left out: training needs both
neighbours. The repository's intrinsics are constants of its dataset class; those of this dataset, divided by the size
of the image and with integer pixel centres, stand in ``intrinsics.json``.
"""

from __future__ import annotations

import zipfile
from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np

from scenegen.foundation.canonical import pretty
from scenegen_datasets.exports.clip import Clip
from scenegen_datasets.exports.format import Exported, Format, Written
from scenegen_datasets.exports.formats.kitti import INVALID, UNIT_M
from scenegen_datasets.exports.gain import CHOICES, CLIPPED, gain_of
from scenegen_datasets.exports.integers import add, depth_u16
from scenegen_datasets.exports.options import Options
from scenegen_datasets.exports.png import colour_png, png
from scenegen_datasets.exports.poses import integer_centres
from scenegen_datasets.exports.stage import Stage
from scenegen_datasets.job import SPLITS

_SPLITS = "splits/scenegen"


def write(clip: Clip, stage: Stage, options: Options) -> Written:
    """Write one clip as a drive."""
    home = f"{clip.job.split}/{clip.job.name}"
    gain = gain_of(clip, options)
    counts: dict[str, int] = {}
    for picture in clip.pictures("thermal", "depth"):
        name = f"{picture.frame:010d}.png"
        stage.put(f"{home}/image_02/data/{name}", colour_png(gain.grey(picture["thermal"])))
        depth, misfits = depth_u16(picture["depth"], UNIT_M)
        stage.put(f"{home}/proj_depth/groundtruth/image_02/{name}", png(depth))
        add(counts, {**misfits, CLIPPED: gain.clipped(picture["thermal"])})
    stage.put(f"{home}/gain.json", pretty(dict(gain.facts)))
    K = np.eye(4)
    K[:3, :3] = integer_centres(picture.K)
    K[0] /= clip.shape[1]
    K[1] /= clip.shape[0]
    return Written(counts, {"K": K.tolist()})


def finish(stage: Stage, clips: Sequence[Exported], description: Mapping[str, Any], options: Options) -> None:
    """Write split files, normalised intrinsics, and the ground truth of what is to be evaluated."""
    grid = description["grid"]
    intrinsics = {"K": clips[0].facts["K"], "full_res_shape": [grid["width_px"], grid["height_px"]]}
    stage.put(f"{_SPLITS}/intrinsics.json", pretty(intrinsics))
    for split in SPLITS:
        mine = [clip for clip in clips if clip.split == split]
        lines = [f"{split}/{clip.name} {frame} l\n" for clip in mine for frame in range(1, clip.frames - 1)]
        stage.put(f"{_SPLITS}/{split}_files.txt", "".join(lines))
    evaluated = [clip for clip in clips if clip.split == "test"]
    if sum(max(clip.frames - 2, 0) for clip in evaluated):
        _write_ground_truth(stage, evaluated, (grid["height_px"], grid["width_px"]))


def _write_ground_truth(stage: Stage, clips: Sequence[Exported], shape: tuple[int, int]) -> None:
    """``gt_depths.npz``: depth [m] of the test frames in the order of the split file; written picture by picture."""
    import cv2

    frames = [(clip, frame) for clip in clips for frame in range(1, clip.frames - 1)]
    header = {"descr": "<f4", "fortran_order": False, "shape": (len(frames), *shape)}
    member = zipfile.ZipInfo("data.npy", (1980, 1, 1, 0, 0, 0))
    with (
        zipfile.ZipFile(stage.path(f"{_SPLITS}/gt_depths.npz"), "w", zipfile.ZIP_STORED) as archive,
        archive.open(member, "w", force_zip64=True) as file,
    ):
        np.lib.format.write_array_header_1_0(file, header)
        for clip, frame in frames:
            path = stage.final(f"test/{clip.name}/proj_depth/groundtruth/image_02/{frame:010d}.png")
            steps = np.asarray(cv2.imread(str(path), cv2.IMREAD_UNCHANGED))
            file.write((steps.astype("<f4") * np.float32(UNIT_M)).tobytes())


FORMAT = Format(
    name="monodepth2",
    readers="monodepth2 and what grew from it (`KITTIDepthDataset`, `--png`)",
    layout=(
        "`SPLIT/CLIP/image_02/data/N.png`, `proj_depth/groundtruth/image_02/N.png`, `gain.json`; "
        "`splits/scenegen/SPLIT_files.txt`, `gt_depths.npz`, `intrinsics.json`"
    ),
    range="depth to 255.99 m",
    step="depth 1/256 m; thermal 8 bits",
    lost="thermal beyond the gain; flow, poses, times, ids, temperature, radiance",
    sky="depth 0",
    needs=("thermal", "depth"),
    bytes_per_pixel=3.5,
    one_camera=True,
    write=write,
    finish=finish,
    heeds=CHOICES,
    invalid=INVALID,
)
