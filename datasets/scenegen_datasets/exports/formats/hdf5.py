"""HDF5: one file per clip, an array per layer over its frames, a chunk per frame, in gzip, which every build reads."""

from __future__ import annotations

from typing import Any

import numpy as np

from scenegen.foundation.canonical import canonical
from scenegen_datasets.exports.clip import Clip
from scenegen_datasets.exports.format import Format, Written
from scenegen_datasets.exports.formats.arrays import stacks_of, values_of
from scenegen_datasets.exports.options import Options
from scenegen_datasets.exports.stage import Stage


def write(clip: Clip, stage: Stage, options: Options) -> Written:
    """Write one clip as a file."""
    import h5py

    with h5py.File(stage.path(f"{clip.job.split}/{clip.job.name}.h5"), "x") as file:
        file.attrs["clip"] = canonical(dict(clip.facts)).decode()
        arrays: dict[str, Any] = {}
        for stack in stacks_of(clip):
            arrays[stack.name] = file.create_dataset(
                stack.name,
                shape=stack.shape,
                dtype=stack.dtype,
                chunks=stack.chunk,
                compression="gzip",
                compression_opts=1,
                shuffle=True,
                track_times=False,
            )
            arrays[stack.name].attrs["unit"] = stack.unit
            arrays[stack.name].attrs["axes"] = list(stack.axes)
        for picture, values in values_of(clip):
            for name, value in values.items():
                arrays[name][picture.frame] = np.ascontiguousarray(value)
    return Written()


FORMAT = Format(
    name="hdf5",
    readers="h5py, MATLAB, anything with HDF5",
    layout="`SPLIT/CLIP.h5`: `/LAYER` over frames, rows, columns; `/time_s`, `/world_from_camera`, `/K`",
    range="that of the dataset",
    step="none",
    lost="the inertial table",
    sky="depth +inf",
    needs=("depth",),
    bytes_per_pixel=18.0,
    write=write,
    extra="hdf5",
    modules=("h5py",),
)
