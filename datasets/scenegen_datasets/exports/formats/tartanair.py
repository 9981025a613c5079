"""TartanAir V2: environments, trajectories and encodings as tartanairpy's ``docs/modalities.rst`` describes them.

An environment is a world, a trajectory a clip; the one difficulty is called ``easy``. Depth is the float32 itself, its
four bytes as the channels of a PNG. Flow is the older 16-bit kind with a mask (0 seen in the next frame, 1 hidden
there, 100 outside of it). Poses are NED. TartanAir's camera is always 640x640 with 90 degrees; ours stands in
``intrinsics.json`` of each trajectory. tartanairpy's data cacher finds frames by data files, which list them: one
below ``analyze`` for each trajectory, and for use without tartanairpy one for each split.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np

from scenegen.foundation.canonical import pretty
from scenegen_datasets.exports.clip import Clip, Picture
from scenegen_datasets.exports.format import Exported, Format, Written
from scenegen_datasets.exports.gain import CHOICES, CLIPPED, CLIPPING, gain_of
from scenegen_datasets.exports.integers import FLOW_OUTSIDE, add, flow_u16
from scenegen_datasets.exports.options import Options
from scenegen_datasets.exports.png import colour_png, png
from scenegen_datasets.exports.poses import ned_pose, numbers, quaternion_xyzw
from scenegen_datasets.exports.stage import Stage
from scenegen_datasets.job import SPLITS

SKY_M = 100_000.0
"""Depth of the sky: "usually a very large value"; no surface of a world is as far."""

SEEN, HIDDEN, OUTSIDE = 0, 1, 100
"""Values of the mask of flow."""

_CAMERA = "lcam_front"


def write(clip: Clip, stage: Stage, options: Options) -> Written:
    """Write one clip as a trajectory."""
    home = home_of(clip.job.map, clip.job.world, clip.job.clip)
    gain = gain_of(clip, options)
    counts: dict[str, int] = {}
    poses = []
    optional = [name for name in ("flow", "covisible", "semantic") if name in clip.layers]
    for picture in clip.pictures("thermal", "depth", *optional):
        name = f"{picture.frame:06d}_{_CAMERA}"
        stage.put(f"{home}/image_{_CAMERA}/{name}.png", colour_png(gain.grey(picture["thermal"])))
        stage.put(f"{home}/depth_{_CAMERA}/{name}_depth.png", depth_png(picture["depth"]))
        if "semantic" in optional:
            stage.put(f"{home}/seg_{_CAMERA}/{name}_seg.png", png(picture["semantic"]))
        if "flow" in optional and picture.frame + 1 < clip.job.frames:
            number = f"{picture.frame:06d}_{picture.frame + 1:06d}"
            data, outside = _flow(picture)
            stage.put(f"{home}/flow_{_CAMERA}/{number}_flow.png", data)
            add(counts, {FLOW_OUTSIDE: outside})
        pose = ned_pose(picture.world_from_camera)
        poses.append(f"{numbers(pose[:3, 3])} {numbers(quaternion_xyzw(pose))}")
        add(counts, {CLIPPED: gain.clipped(picture["thermal"])})
    stage.put(f"{home}/pose_{_CAMERA}.txt", "\n".join(poses) + "\n")
    stage.put(f"{home}/gain.json", pretty(dict(gain.facts)))
    rows, columns = clip.shape
    camera = {"K": picture.K.tolist(), "height_px": rows, "width_px": columns}
    stage.put(f"{home}/intrinsics.json", pretty(camera))
    world, *rest = home.split("/")
    stage.put(f"{world}/analyze/data_{world}_{'_'.join(rest)}.txt", data_file(home, clip.job.frames))
    return Written(counts)


def home_of(map_name: str, world: int, clip: int) -> str:
    """Directory of a trajectory."""
    return f"{map_name}-{world:05d}/Data_easy/P{clip:03d}"


def data_file(home: str, frames: int) -> str:
    """What the data cacher reads of a trajectory: where it is, how many frames it has, and their names."""
    return f"{home} {frames}\n" + "".join(f"{frame:06d}\n" for frame in range(frames))


def depth_png(depth: np.ndarray) -> bytes:
    """Bytes of the float32 values as four channels."""
    values = np.where(np.isinf(depth), np.float32(SKY_M), depth).astype("<f4")
    return png(values[..., None].view(np.uint8))


def _flow(picture: Picture) -> tuple[bytes, int]:
    flow = picture["flow"]
    values, kept, outside = flow_u16(flow)
    rows, columns = kept.shape
    place = flow + np.stack(np.meshgrid(np.arange(columns) + 0.5, np.arange(rows) + 0.5), axis=-1)
    inside = ((place >= 0) & (place <= (columns, rows))).all(axis=2)
    seen = picture["covisible"] if "covisible" in picture.arrays else inside
    mask = np.where(inside & kept, np.where(seen, SEEN, HIDDEN), OUTSIDE)
    return png(np.dstack([values, mask.astype(np.uint16)])), outside


def finish(stage: Stage, clips: Sequence[Exported], description: Mapping[str, Any], options: Options) -> None:
    """Write which environments and trajectories belong to which split, and what the segments mean."""
    environments = {
        split: sorted({f"{c.map}-{c.world:05d}" for c in clips if c.split == split}) for split in SPLITS
    }
    stage.put("splits.json", pretty(environments))
    for split in SPLITS:
        files = (data_file(home_of(c.map, c.world, c.clip), c.frames) for c in clips if c.split == split)
        stage.put(f"data_{split}.txt", "".join(files))
    stage.put(
        "seg_label_map.json", pretty({"name_map": {c["name"]: c["id"] for c in description["classes"]}})
    )


FORMAT = Format(
    name="tartanair",
    readers="TartanAir V2 (tartanairpy) and what trains on it",
    layout=(
        "`MAP-WORLD/Data_easy/PCLIP/image_lcam_front/N_lcam_front.png`, `depth_lcam_front/`, `flow_lcam_front/`, "
        "`seg_lcam_front/`, `pose_lcam_front.txt` (NED), `intrinsics.json`, `gain.json`; "
        "`MAP-WORLD/analyze/data_MAP-WORLD_Data_easy_PCLIP.txt`; `splits.json`, `data_SPLIT.txt`, `seg_label_map.json`"
    ),
    range="depth any; flow -512 to 511.98 px",
    step="depth none; flow 1/64 px; thermal 8 bits",
    lost="thermal beyond the gain; times, instances, materials, temperature, radiance; flow of the last frame",
    sky="depth 100,000 m; flow of the rotation",
    needs=("thermal", "depth"),
    takes=("flow", "covisible", "semantic"),
    bytes_per_pixel=5.5,
    write=write,
    finish=finish,
    heeds=CHOICES,
    invalid={
        **CLIPPING,
        FLOW_OUTSIDE: "pixels whose flow is unknown or beyond 512 px are masked with 100",
    },
)
