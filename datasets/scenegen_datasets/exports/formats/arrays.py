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

GEOMETRY = {"time_s": ((), "s"), "world_from_camera": ((4, 4), "m"), "K": ((3, 3), "px")}
"""Shape and unit of what each frame has beside its layers; all float64."""


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
        Names of the axes.
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
            channels = (len(layer.channels),) if len(layer.channels) > 1 else ()
            axes = ("frame", "row", "column", "channel")[: 3 + len(channels)]
            stacks.append(Stack(name, (frames, *clip.shape, *channels), layer.dtype, layer.unit, axes))
    for name, (shape, unit) in GEOMETRY.items():
        axes = ("frame", "to", "from")[: 1 + len(shape)]
        stacks.append(Stack(name, (frames, *shape), "float64", unit, axes))
    return stacks


def values_of(clip: Clip) -> Iterator[tuple[Picture, dict[str, NDArray[Any]]]]:
    """Every frame with the value of every stack at it."""
    layers = [name for name in PIXEL_LAYERS if name in clip.layers]
    for picture in clip.pictures(*layers):
        beside = {name: np.asarray(getattr(picture, name), np.float64) for name in GEOMETRY}
        yield picture, {**picture.arrays, **beside}
