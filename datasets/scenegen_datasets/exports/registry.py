"""All formats by name."""

from __future__ import annotations

from scenegen.foundation.errors import InputError, nearest
from scenegen_datasets.exports.format import Format
from scenegen_datasets.exports.formats import (
    colmap,
    exr,
    filelist,
    hdf5,
    hf,
    kitti,
    monodepth2,
    ms2,
    nerfstudio,
    pix2pix,
    rerun,
    tartanair,
    tum,
    unpack,
    zarr,
)

FORMATS: dict[str, Format] = {
    each.name: each
    for each in (
        unpack.FORMAT,
        kitti.FORMAT,
        tartanair.FORMAT,
        pix2pix.FORMAT,
        ms2.FORMAT,
        filelist.FORMAT,
        monodepth2.FORMAT,
        nerfstudio.FORMAT,
        colmap.FORMAT,
        tum.FORMAT,
        exr.FORMAT,
        hf.FORMAT,
        zarr.FORMAT,
        hdf5.FORMAT,
        rerun.FORMAT,
    )
}
"""In the order people see them."""


def format_called(name: str) -> Format:
    """Look a format up.

    Raises
    ------
    InputError
        For a name that is none; names the nearest.
    """
    if name not in FORMATS:
        raise InputError(f"--to {name}: unknown format{nearest(name, FORMATS)}")
    return FORMATS[name]
