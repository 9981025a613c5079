"""Zarr, version 3: one store, a group per clip, an array per layer over its frames, a chunk per frame."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any

from scenegen_datasets.exports.clip import Clip
from scenegen_datasets.exports.format import Exported, Format, Written
from scenegen_datasets.exports.formats.arrays import stacks_of, values_of
from scenegen_datasets.exports.options import Options
from scenegen_datasets.exports.stage import Stage
from scenegen_datasets.licence import licence_of

STORE = "dataset.zarr"
_LEVEL = 3


def write(clip: Clip, stage: Stage, options: Options) -> Written:
    """Write one clip as a group."""
    import zarr
    from zarr.codecs import ZstdCodec

    path = stage.path(f"{STORE}/{clip.job.split}/{clip.job.name}")
    group = zarr.open_group(str(path), mode="w", zarr_format=3)
    group.attrs.update({"clip": dict(clip.facts)})
    arrays = {}
    for stack in stacks_of(clip):
        arrays[stack.name] = group.create_array(
            stack.name,
            shape=stack.shape,
            chunks=stack.chunk,
            dtype=stack.dtype,
            compressors=ZstdCodec(level=_LEVEL),
            fill_value=0,
            dimension_names=stack.axes,
            chunk_key_encoding={"name": "default", "separator": "."},  # else a directory for every frame
            attributes={"unit": stack.unit},
        )
    for picture, values in values_of(clip):
        for name, value in values.items():
            arrays[name][picture.frame] = value
    return Written()


def finish(stage: Stage, clips: Sequence[Exported], description: Mapping[str, Any], options: Options) -> None:
    """Write the groups above the clips, so that the whole store opens as one."""
    import zarr

    root = zarr.open_group(str(stage.path(STORE)), mode="w", zarr_format=3)
    about = ("name", "version", "content_id", "conventions", "grid", "band_um", "sensor", "classes")
    root.attrs.update({"license": licence_of(description), **{name: description[name] for name in about}})
    for split in sorted({clip.split for clip in clips}):
        group = root.create_group(split)
        group.attrs["clips"] = [clip.name for clip in clips if clip.split == split]


FORMAT = Format(
    name="zarr",
    readers="zarr 3, xarray, dask",
    layout="`dataset.zarr/SPLIT/CLIP/LAYER` over frames, rows, columns; `time_s`, `world_from_camera`, `K`",
    range="that of the dataset",
    step="none",
    lost="the inertial table",
    sky="depth +inf",
    needs=("depth",),
    bytes_per_pixel=18.0,
    write=write,
    finish=finish,
    extra="zarr",
    modules=("zarr",),
)
