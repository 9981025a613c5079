"""Depth: float32 TIFF, LZW with the floating-point predictor, one strip, one page.

cv2 and Pillow read it exactly, infinity included. Deflate would save 20 kB of a 1 MB frame and cost 2.6 times the
processor time (``benchmarks/encode.py``). Traps: the legacy deflate code 32946 makes readers warn, zstd fails in cv2's
wheel, and of several pages cv2 silently reads the first.
"""

from __future__ import annotations

import struct

import numpy as np
from numpy.typing import NDArray

from scenegen.foundation.errors import CorruptFrameError
from scenegen_datasets.codecs.raster import decoded

_LZW, _FLOAT_PREDICTOR = 5, 3
_ENTRY = struct.Struct("<HHII")
_TYPE_BYTES = {3: 2, 4: 4}
_EXPECTED = {258: 32, 259: _LZW, 277: 1, 317: _FLOAT_PREDICTOR, 339: 3}
_MAX_ENTRIES = 64


def encode(depth: NDArray[np.float32]) -> bytes:
    """Encode float32 (rows, columns)."""
    import cv2

    options = [
        cv2.IMWRITE_TIFF_COMPRESSION,
        _LZW,
        cv2.IMWRITE_TIFF_PREDICTOR,
        _FLOAT_PREDICTOR,
        cv2.IMWRITE_TIFF_ROWSPERSTRIP,
        depth.shape[0],
    ]
    _, data = cv2.imencode(".tiff", depth, options)
    return bytes(data)


def decode(data: bytes, shape: tuple[int, int]) -> NDArray[np.float32]:
    """Decode what `encode` wrote.

    Raises
    ------
    CorruptFrameError
        If it is not such a TIFF of `shape`.
    """
    _check(data, shape)
    return decoded(data, shape, np.float32, "TIFF")


def declared_shape(data: bytes) -> tuple[int, int]:
    """Rows and columns a TIFF says it has; (0, 0) if it does not say.

    Raises
    ------
    CorruptFrameError
        If it is no TIFF.
    """
    tags = _directory(data)
    return tags.get(257, 0), tags.get(256, 0)


def _check(data: bytes, shape: tuple[int, int]) -> None:
    """Read the one directory ourselves: sizes are known before the library allocates anything."""
    tags = _directory(data)
    wanted = {**_EXPECTED, 256: shape[1], 257: shape[0]}
    for tag, value in wanted.items():
        if tags.get(tag) != value:
            raise CorruptFrameError(f"TIFF tag {tag} is {tags.get(tag)} where {value} belongs")
    start, size = tags.get(273, 0), tags.get(279, 0)
    if tags.get(278, 0) < shape[0] or start < 8 or start + size > len(data):
        raise CorruptFrameError("TIFF is not one strip inside the file")


def _directory(data: bytes) -> dict[int, int]:
    if data[:4] != b"II*\0" or len(data) < 8:
        raise CorruptFrameError("not a little-endian TIFF")
    at = int.from_bytes(data[4:8], "little")
    count = int.from_bytes(data[at : at + 2], "little")
    end = at + 2 + 12 * count
    if not 0 < count <= _MAX_ENTRIES or end + 4 > len(data):
        raise CorruptFrameError("TIFF directory is outside the file")
    if data[end : end + 4] != b"\0\0\0\0":
        raise CorruptFrameError("TIFF of more than one page")
    entries = list(_ENTRY.iter_unpack(data[at + 2 : end]))
    if len({tag for tag, *_ in entries}) < count:
        raise CorruptFrameError("TIFF says one thing twice")  # the library may believe the other one
    tags = {}
    for tag, kind, number, value in entries:
        if number == 1 and kind in _TYPE_BYTES:
            tags[tag] = value & (0xFFFFFFFF >> (32 - 8 * _TYPE_BYTES[kind]))
    return tags
