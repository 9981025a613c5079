"""One OpenEXR file per frame with every layer that has pixels: for compositing, and for whoever wants one file.

Channels carry the names compositors know where there are such: ``Z`` is depth, ``forward.u`` and ``forward.v`` are
flow. Integers are stored as 32 bits, truth values as halves, everything else as it is.
"""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import NDArray

from scenegen.foundation.canonical import canonical
from scenegen_datasets.codecs import exr
from scenegen_datasets.exports.clip import Clip
from scenegen_datasets.exports.format import Format, Written
from scenegen_datasets.exports.options import Options
from scenegen_datasets.exports.stage import Stage
from scenegen_datasets.layers import LAYERS

CHANNELS: dict[str, tuple[str, ...]] = {
    "depth": ("Z",),
    "flow": ("forward.u", "forward.v"),
    "flow_back": ("backward.u", "backward.v"),
    "covisible": ("forward.covisible",),
    "covisible_back": ("backward.covisible",),
    "normal": ("N.x", "N.y", "N.z"),
}
"""Names of channels by layer; every other layer is one channel of its own name."""

PIXEL_LAYERS = tuple(name for name in LAYERS if name != "imu")


def write(clip: Clip, stage: Stage, options: Options) -> Written:
    """Write one clip."""
    layers = [name for name in PIXEL_LAYERS if name in clip.layers]
    units = {
        f"unit.{channel}": LAYERS[name].unit for name in layers for channel in CHANNELS.get(name, (name,))
    }
    for picture in clip.pictures(*layers):
        channels: dict[str, NDArray[Any]] = {}
        for name in layers:
            array = _storable(picture[name])
            planes = [array] if array.ndim == 2 else list(np.moveaxis(array, -1, 0))
            channels |= dict(zip(CHANNELS.get(name, (name,)), planes, strict=True))
        facts = {
            "key": picture.key,
            "time_s": repr(picture.time_s),
            "world_from_camera": canonical(picture.world_from_camera.tolist()).decode(),
            "K": canonical(picture.K.tolist()).decode(),
        }
        stage.put(
            f"{clip.job.split}/{clip.job.name}/{picture.key}.exr", exr.encode(channels, {**units, **facts})
        )
    return Written()


def _storable(array: NDArray[Any]) -> NDArray[Any]:
    """OpenEXR knows uint32, half and float32."""
    if array.dtype == bool:
        return array.astype(np.float16)
    return array.astype(np.uint32) if array.dtype.kind == "u" else array


FORMAT = Format(
    name="exr",
    readers="OpenEXR, Nuke, Blender, OpenImageIO",
    layout="`SPLIT/CLIP/KEY.exr`: `thermal`, `Z`, `forward.u/v`, `radiance`, `temperature`, ids; pose, K in its header",
    range="that of the dataset",
    step="none",
    lost="the inertial table, weather and hour",
    sky="Z +inf",
    needs=("depth",),
    takes=tuple(name for name in PIXEL_LAYERS if name != "depth"),
    bytes_per_pixel=22.0,
    write=write,
)
