"""What a member says of itself: image size and channels, read from its first bytes, before anything is decoded.

Readers of a dataset know both from the index. Whoever meets a lone member, in a stream of shards, asks here.
"""

from __future__ import annotations

import struct

from scenegen.foundation.errors import CorruptFrameError
from scenegen_datasets.codecs import exr, tiff
from scenegen_datasets.layers import max_member_bytes

Shape = tuple[int, int]


def declared(suffix: str, data: bytes) -> tuple[Shape, set[str] | None]:
    """Rows and columns, and the names of the channels of an EXR (None for what has none).

    Raises
    ------
    CorruptFrameError
        If it cannot be told, or no sound image of that size has so many bytes.
    """
    kind = suffix.rpartition(".")[2]
    shape: Shape = (0, 0)
    channels = None
    if kind == "png" and len(data) >= 24:
        width, height = struct.unpack(">II", data[16:24])
        shape = height, width
    elif kind == "tiff":
        shape = tiff.declared_shape(data)
    elif kind == "exr":
        shape, channels = exr.declared(data)
    elif kind == "npy":
        return shape, None
    if len(data) > max_member_bytes(shape):
        raise CorruptFrameError(f"{suffix}: {len(data)} bytes are no image of {shape[0]}x{shape[1]}")
    return shape, channels
