"""TUM RGB-D: ``rgb.txt``, ``depth.txt``, ``groundtruth.txt`` per sequence, as ``associate.py`` and SLAM read it.

A line of the trajectory is ``timestamp tx ty tz qx qy qz qw``, the pose of an OpenCV camera in the world. The depth of
the benchmark is metres times 5000, which ends at 13 m; ``--depth-unit-m`` changes that, and ``camera.yaml`` names the
factor as ORB-SLAM's ``DepthMapFactor``.
"""

from __future__ import annotations

from scenegen.foundation.canonical import pretty
from scenegen_datasets.exports.clip import Clip, Picture
from scenegen_datasets.exports.format import Format, Written
from scenegen_datasets.exports.gain import CHOICES, CLIPPED, CLIPPING, gain_of
from scenegen_datasets.exports.integers import FAR, NEAR, add, depth_u16
from scenegen_datasets.exports.options import Options
from scenegen_datasets.exports.png import colour_png, png
from scenegen_datasets.exports.poses import integer_centres, numbers, quaternion_xyzw
from scenegen_datasets.exports.stage import Stage


def write(clip: Clip, stage: Stage, options: Options) -> Written:
    """Write one clip as a sequence."""
    home = f"{clip.job.split}/{clip.job.name}"
    gain = gain_of(clip, options)
    counts: dict[str, int] = {}
    rgb, depths, poses = [], [], []
    for picture in clip.pictures("thermal", "depth"):
        time = f"{picture.time_s:.6f}"
        stage.put(f"{home}/rgb/{time}.png", colour_png(gain.grey(picture["thermal"])))
        depth, misfits = depth_u16(picture["depth"], options.depth_unit_m)
        stage.put(f"{home}/depth/{time}.png", png(depth))
        add(counts, {**misfits, CLIPPED: gain.clipped(picture["thermal"])})
        rgb.append(f"{time} rgb/{time}.png")
        depths.append(f"{time} depth/{time}.png")
        pose = picture.world_from_camera
        poses.append(f"{time} {numbers(pose[:3, 3])} {numbers(quaternion_xyzw(pose))}")
    for name, head, lines in (
        ("rgb.txt", "timestamp filename", rgb),
        ("depth.txt", "timestamp filename", depths),
        ("groundtruth.txt", "timestamp tx ty tz qx qy qz qw", poses),
    ):
        stage.put(f"{home}/{name}", "\n".join([f"# {head}", *lines]) + "\n")
    stage.put(f"{home}/camera.yaml", _camera(picture, clip.shape, options.depth_unit_m))
    stage.put(f"{home}/gain.json", pretty(dict(gain.facts)))
    return Written(counts)


def _camera(picture: Picture, shape: tuple[int, int], unit_m: float) -> str:
    """The camera section of an ORB-SLAM settings file."""
    K = integer_centres(picture.K)
    values = {
        "Camera.fx": float(K[0, 0]),
        "Camera.fy": float(K[1, 1]),
        "Camera.cx": float(K[0, 2]),
        "Camera.cy": float(K[1, 2]),
        **{f"Camera.{name}": 0.0 for name in ("k1", "k2", "p1", "p2")},
        "Camera.width": shape[1],
        "Camera.height": shape[0],
        "DepthMapFactor": 1.0 / unit_m,
    }
    return "%YAML:1.0\n" + "".join(f"{name}: {value!r}\n" for name, value in values.items())


FORMAT = Format(
    name="tum",
    readers="TUM RGB-D tools, ORB-SLAM, evo",
    layout="`SPLIT/CLIP/rgb/T.png`, `depth/T.png`, `rgb.txt`, `depth.txt`, `groundtruth.txt`, `camera.yaml`, "
    "`gain.json`",
    range="depth to 13.1 m (65535 steps of `--depth-unit-m`)",
    step="depth 0.2 mm (`--depth-unit-m`); time 1 us; thermal 8 bits",
    lost="depth beyond the range, thermal beyond the gain; flow, ids, temperature, radiance",
    sky="depth 0",
    needs=("thermal", "depth"),
    bytes_per_pixel=2.5,
    write=write,
    heeds=CHOICES | {"depth_unit_m"},
    invalid={
        **CLIPPING,
        FAR: "pixels with a surface beyond 65535 steps became 0 (no depth); --depth-unit-m widens the range",
        NEAR: "pixels with a surface nearer than half a step became 0 (no depth)",
    },
)
