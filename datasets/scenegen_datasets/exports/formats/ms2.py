"""MS2 (KAIST multi-spectral stereo): sequences of 16-bit thermal with depth and odometry, as its loaders read them.

The loaders want a right picture for every left one. Ours has one camera: the right picture is the left one, and the
calibration says so with a baseline of zero, so that disparity is zero too. Near-infrared and colour are not there.
Thermal is 14-bit counts as they are, or those that a FLIR A65C would report, which recorded MS2: ``raw = R / (exp(B /
T) - F) + O`` with the constants of MS2's own ``Raw2Celsius``.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from typing import Any

import numpy as np
from jaxtyping import UInt16

from scenegen_datasets.exports.clip import Clip
from scenegen_datasets.exports.format import Exported, Format, Written
from scenegen_datasets.exports.formats.kitti import INVALID, UNIT_M
from scenegen_datasets.exports.formats.ms2_calibration import calibration_npy
from scenegen_datasets.exports.integers import FAR, NEAR, add, depth_u16
from scenegen_datasets.exports.options import Options
from scenegen_datasets.exports.png import png
from scenegen_datasets.exports.poses import integer_centres, numbers, relative_pose
from scenegen_datasets.exports.stage import Stage
from scenegen_datasets.job import SPLITS
from scenegen_datasets.layers import MAX_COUNT
from scenegen_datasets.scale import scale_of

PLANCK_R, PLANCK_B, PLANCK_F, PLANCK_O = 380_747.0, 1428.0, 1.0, -88.539
"""Of the FLIR A65C; SupDepth4Thermal, ``dataloaders/utils.py``, as quoted by MS2's tools."""

Encoding = Callable[[UInt16[np.ndarray, "rows columns"]], UInt16[np.ndarray, "rows columns"]]


def write(clip: Clip, stage: Stage, options: Options) -> Written:
    """Write one clip as a sequence."""
    name = clip.job.name
    encode = _a65c(clip) if options.encoding == "a65c" else _as_they_are
    counts: dict[str, int] = {}
    first = None
    for picture in clip.pictures("thermal", "depth"):
        number = f"{picture.frame:06d}"
        data = png(encode(picture["thermal"]))
        for side in ("left", "right"):
            stage.put(f"sync_data/{name}/thr/img_{side}/{number}.png", data)
        depth, misfits = depth_u16(picture["depth"], UNIT_M)
        stage.put(f"proj_depth/{name}/thr/depth_filtered/{number}.png", png(depth))
        first = picture if first is None else first
        pose = relative_pose(first.world_from_camera, picture.world_from_camera)
        stage.put(f"odom/{name}/thr/{number}.txt", numbers(pose) + "\n")
        add(counts, misfits)
    stage.put(f"sync_data/{name}/calib.npy", calibration_npy(calibration(picture.K)))
    return Written(counts, {"sun_elevation_deg": float(clip.facts["sun_elevation_deg"])})


def calibration(K: np.ndarray) -> dict[str, np.ndarray]:
    """What MS2's loaders look up: one camera, in every place; translations in millimetres."""
    camera = integer_centres(K)
    sensors = {f"K_{sensor}{side}": camera for sensor in ("rgb", "nir", "thr") for side in ("L", "R")}
    steps = ("rgbR", "nirR", "thrR", "nir2thr", "nir2rgb")
    rotations = {f"R_{step}": np.eye(3) for step in steps}
    return {**sensors, **rotations, **{f"T_{step}": np.zeros((3, 1)) for step in steps}}


def finish(stage: Stage, clips: Sequence[Exported], description: Mapping[str, Any], options: Options) -> None:
    """Write the lists of sequences; the test sequences also by day and night, of the sun above or below the horizon."""
    for split in SPLITS:
        stage.put(f"{split}_list.txt", _lines([clip for clip in clips if clip.split == split]))
    test = [clip for clip in clips if clip.split == "test"]
    day = [clip for clip in test if clip.facts["sun_elevation_deg"] > 0.0]
    stage.put("test_day_list.txt", _lines(day))
    stage.put("test_night_list.txt", _lines([clip for clip in test if clip not in day]))


def _lines(clips: Sequence[Exported]) -> str:
    return "".join(f"{clip.name}\n" for clip in clips)


def _as_they_are(counts: UInt16[np.ndarray, "rows columns"]) -> UInt16[np.ndarray, "rows columns"]:
    return counts


def _a65c(clip: Clip) -> Encoding:
    """Counts of the A65C by counts of ours, through brightness temperature."""
    from scenegen_render.sensor.scale import counts_to_brightness_K

    T = counts_to_brightness_K(np.arange(MAX_COUNT + 1, dtype=np.uint16), scale_of(clip.facts))
    raw = PLANCK_R / (np.exp(PLANCK_B / T.astype(np.float64)) - PLANCK_F) + PLANCK_O
    table = np.clip(np.rint(raw), 0, MAX_COUNT).astype(np.uint16)
    return lambda counts: np.asarray(table[counts])


FORMAT = Format(
    name="ms2",
    readers="MS2 loaders (SupDepth4Thermal, MS2-MultiSpectralStereoDataset)",
    layout=(
        "`sync_data/CLIP/thr/img_left/N.png`, `img_right/`, `calib.npy`; `proj_depth/CLIP/thr/depth_filtered/N.png`; "
        "`odom/CLIP/thr/N.txt`; `SPLIT_list.txt`, `test_day_list.txt`, `test_night_list.txt`"
    ),
    range="depth to 255.99 m; thermal 14 bits",
    step="depth 1/256 m; thermal none (counts) or one count of the A65C (`--encoding a65c`, about 20 mK)",
    lost="flow, times, ids, temperature, radiance; right pictures repeat the left ones (baseline 0)",
    sky="depth 0",
    needs=("thermal", "depth"),
    bytes_per_pixel=4.5,
    write=write,
    finish=finish,
    heeds=frozenset({"encoding"}),
    invalid={name: INVALID[name] for name in (FAR, NEAR)},
)
