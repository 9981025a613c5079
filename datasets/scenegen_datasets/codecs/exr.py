"""Everything else: scan-line OpenEXR with named channels and units in the header.

ZIP (16 rows a block, one thread) is the fastest of the lossless kinds that shrink anything and that every reader knows:
PIZ costs 3 times the processor time, single-row ZIPS 1.3 times, RLE saves a third and doubles the bytes. Flow is stored
as it is: its mantissas are noise to a compressor, which takes 10 times as long to save a quarter
(``benchmarks/encode.py``). OpenEXR stores uint32, half and float32 only, so small integers travel as uint32.
"""

from __future__ import annotations

import io
import struct
from collections.abc import Mapping
from typing import Any

import numpy as np
from numpy.typing import NDArray

from scenegen.foundation.errors import CorruptFrameError
from scenegen_datasets.codecs import plain_exr

_MAGIC = b"v/1\x01\x02\x00\x00\x00"
_PIXEL_TYPES = (np.dtype(np.uint32), np.dtype(np.float16), np.dtype(np.float32))
_KINDS = (b"\x00", b"\x03")  # NO_COMPRESSION and ZIP_COMPRESSION, as the header spells them
_MAX_HEADER_BYTES = 1 << 16


def encode(
    channels: Mapping[str, NDArray[Any]], attributes: Mapping[str, str], *, zipped: bool = True
) -> bytes:
    """Encode planes of one shape; OpenEXR sorts channels and attributes by name.

    Parameters
    ----------
    channels : mapping of str to array (rows, columns)
        uint32, float16 or float32.
    attributes : mapping of str to str
        Text for the header, e.g. units.
    zipped : bool
        Whether to compress.
    """
    import OpenEXR

    kind = OpenEXR.ZIP_COMPRESSION if zipped else OpenEXR.NO_COMPRESSION
    header = {"compression": kind, "type": OpenEXR.scanlineimage, **attributes}
    planes = {name: np.ascontiguousarray(plane) for name, plane in channels.items()}
    buffer = io.BytesIO()
    OpenEXR.File(header, planes, 0).write(buffer)
    return buffer.getvalue()


def decode(
    data: bytes, shape: tuple[int, int], channels: Mapping[str, np.dtype[Any]]
) -> dict[str, NDArray[Any]]:
    """Decode what `encode` wrote.

    Parameters
    ----------
    data : bytes
    shape : (int, int)
    channels : mapping of str to dtype
        Exactly the channels there must be, with their stored types.

    Returns
    -------
    dict of str to array
        Of an uncompressed file they are read-only views of `data`, which are not contiguous.

    Raises
    ------
    CorruptFrameError
        If it is not such an EXR.
    """
    import OpenEXR

    header, end = _header(data)
    _check(header, shape, channels)
    if (header["compression"], header.get("lineOrder")) == (_KINDS[0], b"\0"):
        return plain_exr.planes(data, end, shape, channels)
    try:
        planes = OpenEXR.File(io.BytesIO(data), True, False, 0).channels()
        return {name: planes[name].pixels for name in channels}
    except (RuntimeError, ValueError, TypeError, KeyError, OSError) as error:
        raise CorruptFrameError(f"EXR does not decode: {str(error).splitlines()[0]}") from None


def declared(data: bytes) -> tuple[tuple[int, int], set[str]]:
    """Rows and columns an EXR says it has, and the names of its channels.

    Raises
    ------
    CorruptFrameError
        If its header is damaged.
    """
    header, _ = _header(data)
    window = header.get("dataWindow", b"")
    if len(window) != 16:
        raise CorruptFrameError("EXR does not say how large it is")
    left, top, right, bottom = struct.unpack("<4i", window)
    return (bottom - top + 1, right - left + 1), set(_channel_list(header.get("channels", b"")))


def _check(
    header: Mapping[str, bytes], shape: tuple[int, int], channels: Mapping[str, np.dtype[Any]]
) -> None:
    """Channels and sizes are known before the library allocates anything."""
    rows, columns = shape
    if header.get("dataWindow") != struct.pack("<4i", 0, 0, columns - 1, rows - 1):
        raise CorruptFrameError(f"EXR is not {rows}x{columns}")
    if header.get("compression") not in _KINDS:
        raise CorruptFrameError("EXR is neither ZIP nor uncompressed")
    if _channel_list(header.get("channels", b"")) != dict(channels):
        raise CorruptFrameError(f"EXR holds other channels than {', '.join(channels)}")


def _header(data: bytes) -> tuple[dict[str, bytes], int]:
    """Attributes of a single-part scan-line file (name, type, size, value, until an empty name), and where they end."""
    if data[:8] != _MAGIC:
        raise CorruptFrameError("not a single-part scan-line EXR")
    attributes: dict[str, bytes] = {}
    at = 8
    while data[at : at + 1] != b"\0":
        name, _, rest = data[at : at + 256].partition(b"\0")
        kind = rest.partition(b"\0")[0]
        at += len(name) + len(kind) + 2
        size = int.from_bytes(data[at : at + 4], "little")
        at += 4 + size
        if at >= len(data) or at > _MAX_HEADER_BYTES:
            raise CorruptFrameError("EXR header runs past the file")
        if name.decode("latin-1") in attributes:
            raise CorruptFrameError("EXR says one thing twice")  # the library may believe the other one
        attributes[name.decode("latin-1")] = data[at - size : at]
    return attributes, at + 1


def _channel_list(value: bytes) -> dict[str, np.dtype[Any]]:
    found: dict[str, np.dtype[Any]] = {}
    at = 0
    while at < len(value) - 1:
        name = value[at:].partition(b"\0")[0]
        at += len(name) + 17
        kind, _, x_step, y_step = (
            struct.unpack("<iiii", value[at - 16 : at]) if at <= len(value) else (-1, 0, 0, 0)
        )
        if kind not in (0, 1, 2) or (x_step, y_step) != (1, 1):
            raise CorruptFrameError("EXR channel list is damaged")
        if name.decode("latin-1") in found:
            raise CorruptFrameError("EXR holds a channel twice")
        found[name.decode("latin-1")] = _PIXEL_TYPES[kind]
    return found
