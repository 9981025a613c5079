"""What the formats that hold whole clips as arrays share: which arrays there are, and what is said of them."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import DTypeLike, NDArray

from scenegen_datasets.exports.clip import Clip, Picture
from scenegen_datasets.exports.formats.exr import PIXEL_LAYERS
from scenegen_datasets.layers import LAYERS

GEOMETRY = {
    "time_s": ((), (), "s"),
    "world_from_camera": ((4, 4), ("world", "camera"), "m"),
    "K": ((3, 3), ("image", "ray"), "px"),
}
"""Shape, names of its axes and unit of what each frame has beside its layers; all float64."""


@dataclass(frozen=True)
class Stack:
    """One array over all frames of a clip.

    Attributes
    ----------
    name : str
    shape : tuple of int
        The first axis counts frames.
    dtype : numpy dtype
    unit : str
    axes : tuple of str
        Names of the axes; within a clip a name has one length, which xarray insists on.
    """

    name: str
    shape: tuple[int, ...]
    dtype: DTypeLike
    unit: str
    axes: tuple[str, ...]

    @property
    def chunk(self) -> tuple[int, ...]:
        """One frame; small arrays are one chunk."""
        return self.shape if self.name in GEOMETRY else (1, *self.shape[1:])


def stacks_of(clip: Clip) -> list[Stack]:
    """All arrays of a clip: its layers with pixels, then times, poses and intrinsics."""
    frames = clip.job.frames
    stacks = []
    for name in PIXEL_LAYERS:
        if name in clip.layers:
            layer = LAYERS[name]
            several = len(layer.channels) > 1
            shape = (frames, *clip.shape, *((len(layer.channels),) if several else ()))
            axes = ("frame", "row", "column", *(("".join(layer.channels),) if several else ()))
            stacks.append(Stack(name, shape, layer.dtype, layer.unit, axes))
    for name, (beside, axes, unit) in GEOMETRY.items():
        stacks.append(Stack(name, (frames, *beside), "float64", unit, ("frame", *axes)))
    return stacks


def values_of(clip: Clip) -> Iterator[tuple[Picture, dict[str, NDArray[Any]]]]:
    """Every frame with the value of every stack at it."""
    layers = [name for name in PIXEL_LAYERS if name in clip.layers]
    for picture in clip.pictures(*layers):
        beside = {name: np.asarray(getattr(picture, name), np.float64) for name in GEOMETRY}
        yield picture, {**picture.arrays, **beside}
