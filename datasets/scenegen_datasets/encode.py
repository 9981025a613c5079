"""One frame to the bytes of its members."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np
from jaxtyping import Float64
from scenegen_render.frame import Frame
from scenegen_render.sensor.reading import Reading

from scenegen_datasets.layers import DEFAULT_LAYERS


@dataclass(frozen=True)
class Member:
    """One file of one frame inside the shard.

    Attributes
    ----------
    suffix : str
        E.g. ``thermal.png``; the member is called ``<key>.<suffix>``.
    data : bytes
    digests : mapping of str to str
        Layer name to SHA-256 of its decoded array.
    """

    suffix: str
    data: bytes
    digests: Mapping[str, str]


@dataclass(frozen=True, eq=False)
class FrameMeta:
    """When and whence a frame was taken.

    Attributes
    ----------
    time_s : float
        Since the first frame of the clip.
    world_from_camera : float64 (4, 4)
        Pose, OpenCV camera to ENU world [m].
    sensor : mapping
        State of the camera at this frame (plain numbers), stored in the JSON member.
    """

    time_s: float
    world_from_camera: Float64[np.ndarray, "4 4"]
    sensor: Mapping[str, float | int]


@dataclass(frozen=True, eq=False)
class EncodedFrame:
    """All members of one frame in their fixed order, and the statistics that go into receipt and index."""

    key: str
    meta: FrameMeta
    members: tuple[Member, ...]
    statistics: Mapping[str, float | int]


def encode_frame(
    key: str,
    frame: Frame,
    reading: Reading,
    meta: FrameMeta,
    layers: tuple[str, ...] = DEFAULT_LAYERS,
) -> EncodedFrame:
    """Encode one frame, losslessly and always to the same bytes.

    Parameters
    ----------
    key : str
        `ClipJob.key` of the frame.
    frame, reading : Frame, Reading
        Truth and counts on one pixel grid.
    meta : FrameMeta
    layers : tuple of str
        Which layers are written (`scenegen_datasets.layers.LAYERS`).

    Raises
    ------
    DatasetError
        If a value may not be stored: NaN or infinity outside sky depth, depth <= 0, counts above 16383,
        a layer that was asked for and not rendered.
    """
    raise NotImplementedError
