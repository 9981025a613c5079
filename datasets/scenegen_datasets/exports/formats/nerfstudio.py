"""nerfstudio: ``transforms.json`` per clip, OpenGL cameras in a world with z up, depth in millimetres.

Depth is float32 in an ``.npy`` file, which nerfstudio reads as it reads 16-bit pictures, times its
``depth_unit_scale_factor`` of 0.001: in 16 bits millimetres would end at 65 m. It is planar, not along the ray
(``is_euclidean_depth=False``, the default). nerfstudio shoots the ray of a pixel through its centre at (0.5, 0.5), as
we do.
"""

from __future__ import annotations

import io
from typing import Any

import numpy as np

from scenegen.foundation.canonical import pretty
from scenegen_datasets.exports.clip import Clip, Picture
from scenegen_datasets.exports.format import Format, Written
from scenegen_datasets.exports.gain import CHOICES, CLIPPED, CLIPPING, gain_of
from scenegen_datasets.exports.integers import add
from scenegen_datasets.exports.options import Options
from scenegen_datasets.exports.png import colour_png
from scenegen_datasets.exports.poses import opengl_pose
from scenegen_datasets.exports.stage import Stage

MILLIMETRES = 1000.0


def write(clip: Clip, stage: Stage, options: Options) -> Written:
    """Write one clip as a scene."""
    home = f"{clip.job.split}/{clip.job.name}"
    gain = gain_of(clip, options)
    counts: dict[str, int] = {}
    frames = []
    for picture in clip.pictures("thermal", "depth"):
        name = f"frame_{picture.frame:05d}"
        stage.put(f"{home}/images/{name}.png", colour_png(gain.grey(picture["thermal"])))
        stage.put(f"{home}/depths/{name}.npy", _npy(picture["depth"]))
        frames.append(
            {
                "file_path": f"images/{name}.png",
                "depth_file_path": f"depths/{name}.npy",
                "transform_matrix": opengl_pose(picture.world_from_camera).tolist(),
                "time": picture.time_s,
            }
        )
        add(counts, {CLIPPED: gain.clipped(picture["thermal"])})
    stage.put(f"{home}/transforms.json", pretty({**_camera(picture, clip.shape), "frames": frames}))
    stage.put(f"{home}/gain.json", pretty(dict(gain.facts)))
    return Written(counts)


def _camera(picture: Picture, shape: tuple[int, int]) -> dict[str, Any]:
    K = picture.K
    return {
        "camera_model": "OPENCV",
        "fl_x": float(K[0, 0]),
        "fl_y": float(K[1, 1]),
        "cx": float(K[0, 2]),
        "cy": float(K[1, 2]),
        "w": shape[1],
        "h": shape[0],
        **dict.fromkeys(("k1", "k2", "p1", "p2"), 0.0),
        "depth_unit_scale_factor": 1.0 / MILLIMETRES,
    }


def _npy(depth: np.ndarray) -> bytes:
    """Millimetres, 0 where there is no surface: depth supervision leaves such pixels out."""
    buffer = io.BytesIO()
    millimetres = np.where(np.isinf(depth), 0.0, depth.astype(np.float64) * MILLIMETRES).astype("<f4")
    np.save(buffer, millimetres, allow_pickle=False)
    return buffer.getvalue()


FORMAT = Format(
    name="nerfstudio",
    readers="nerfstudio (`ns-train depth-nerfacto`, `splatfacto`)",
    layout="`SPLIT/CLIP/transforms.json`, `images/frame_N.png`, `depths/frame_N.npy` (mm), `gain.json`",
    range="depth any",
    step="depth 1.2e-7 of itself; thermal 8 bits",
    lost="thermal beyond the gain; flow, ids, temperature, radiance",
    sky="depth 0",
    needs=("thermal", "depth"),
    bytes_per_pixel=5.5,
    write=write,
    heeds=CHOICES,
    invalid=CLIPPING,
)
