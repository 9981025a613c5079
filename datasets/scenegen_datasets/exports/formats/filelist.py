"""Lists of files for Depth-Anything-V2 and ZoeDepth, with pictures in the encodings their loaders expect.

Depth-Anything-V2 (``metric_depth``) trains with its VKITTI2 loader, which divides by 100, and validates with its
KITTI loader, which divides by 256 and takes zero for invalid. ZoeDepth divides by 256 and wants the focal length in
every line. All paths are relative to the export: start Depth-Anything-V2 there, and give it to ZoeDepth as
``data_path`` and ``gt_path``.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from typing import Any

from scenegen.foundation.canonical import pretty
from scenegen_datasets.exports.clip import Clip
from scenegen_datasets.exports.format import Exported, Format, Written
from scenegen_datasets.exports.formats.kitti import INVALID, UNIT_M
from scenegen_datasets.exports.gain import CHOICES, CLIPPED, gain_of
from scenegen_datasets.exports.integers import FAR, add, depth_u16
from scenegen_datasets.exports.options import Options
from scenegen_datasets.exports.png import colour_png, png
from scenegen_datasets.exports.stage import Stage
from scenegen_datasets.job import SPLITS

CENTIMETRE_M, VKITTI_FAR = 0.01, 65535
"""VKITTI 2 stores centimetres, and 65535 for the sky."""

FAR_CENTIMETRES = "depth_too_far_for_centimetres"


def write(clip: Clip, stage: Stage, options: Options) -> Written:
    """Write the pairs of one clip."""
    gain = gain_of(clip, options)
    home = f"{clip.job.split}/{clip.job.name}"
    counts: dict[str, int] = {}
    focal = 0.0
    for picture in clip.pictures("thermal", "depth", pairs_only=True):
        stage.put(f"images/{home}/{picture.key}.png", colour_png(gain.grey(picture["thermal"])))
        kitti, misfits = depth_u16(picture["depth"], UNIT_M)
        stage.put(f"depth_256/{home}/{picture.key}.png", png(kitti))
        centimetres, far = depth_u16(picture["depth"], CENTIMETRE_M, sky=VKITTI_FAR, far=VKITTI_FAR)
        stage.put(f"depth_cm/{home}/{picture.key}.png", png(centimetres))
        add(counts, {**misfits, FAR_CENTIMETRES: far[FAR], CLIPPED: gain.clipped(picture["thermal"])})
        focal = float(picture.K[0, 0])
    stage.put(f"gain/{clip.job.name}.json", pretty(dict(gain.facts)))
    return Written(counts, {"focal_px": focal})


def finish(stage: Stage, clips: Sequence[Exported], description: Mapping[str, Any], options: Options) -> None:
    """Write the lists under the names the two repositories use."""
    for split in SPLITS:
        pairs = list(_pairs([clip for clip in clips if clip.split == split]))
        for name, depth in (("vkitti2", "depth_cm"), ("kitti", "depth_256")):
            lines = (f"images/{home}/{key}.png {depth}/{home}/{key}.png\n" for home, key, _ in pairs)
            stage.put(f"dataset/splits/{name}/{split}.txt", "".join(lines))
        lines = (
            f"images/{home}/{key}.png depth_256/{home}/{key}.png {focal!r}\n" for home, key, focal in pairs
        )
        stage.put(f"train_test_inputs/scenegen_{split}_files_with_gt.txt", "".join(lines))


def _pairs(clips: Sequence[Exported]) -> Iterator[tuple[str, str, float]]:
    """Directory, key and focal length of every pair."""
    for clip in clips:
        for frame in range(1, clip.frames):
            yield f"{clip.split}/{clip.name}", f"{clip.name}-{frame:04d}", float(clip.facts["focal_px"])


FORMAT = Format(
    name="filelist",
    readers="Depth-Anything-V2 `metric_depth`, ZoeDepth, BTS",
    layout=(
        "`images/`, `depth_cm/`, `depth_256/` each `SPLIT/CLIP/KEY.png`; `dataset/splits/vkitti2/SPLIT.txt` (cm), "
        "`dataset/splits/kitti/SPLIT.txt` (1/256 m), `train_test_inputs/scenegen_SPLIT_files_with_gt.txt`; "
        "`gain/CLIP.json`"
    ),
    range="depth to 655.34 m (cm), to 255.99 m (1/256 m)",
    step="depth 1 cm, 1/256 m; thermal 8 bits",
    lost="thermal beyond the gain; flow, poses, ids, temperature, radiance; frame 0 of each clip, which is no pair",
    sky="655.35 m (cm); 0 (1/256 m)",
    needs=("thermal", "depth"),
    bytes_per_pixel=3.0,
    pairs_only=True,
    write=write,
    finish=finish,
    heeds=CHOICES,
    invalid={
        **INVALID,
        FAR_CENTIMETRES: "pixels with a surface beyond 655.34 m became 65535 (sky) in depth_cm",
    },
)
