"""The pixels of an uncompressed EXR, without a picture library: its lines lie there as they are.

Several times faster than the general decoder, which copies every value twice (``benchmarks/loader.py``). Layout: after
the header a table of offsets, then for each line its number, its size and its channels by name, one after the other
(OpenEXR file layout, "scan line block").
"""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

import numpy as np
from numpy.typing import NDArray

from scenegen.foundation.errors import CorruptFrameError


def planes(
    data: bytes, start: int, shape: tuple[int, int], channels: Mapping[str, np.dtype[Any]]
) -> dict[str, NDArray[Any]]:
    """Find the channels: views of `data`, line after line.

    Parameters
    ----------
    data : bytes
        An uncompressed scan-line EXR whose header was checked.
    start : int
        Where its header ends.
    shape : (int, int)
    channels : mapping of str to dtype
        All that the file holds.

    Raises
    ------
    CorruptFrameError
        If the lines are not there one after the other, whole, from top to bottom.
    """
    rows, columns = shape
    pixels = [(name, channels[name].newbyteorder("<"), (columns,)) for name in sorted(channels)]
    line = np.dtype([("\0row", "<i4"), ("\0size", "<i4"), *pixels])
    first = start + 8 * rows
    if len(data) != first + rows * line.itemsize:
        raise CorruptFrameError("EXR is shorter or longer than its lines")
    offsets = np.frombuffer(data, "<u8", rows, start)
    lines = np.frombuffer(data, line, rows, first)
    numbers = np.arange(rows)
    if (
        (offsets != first + numbers * line.itemsize).any()
        or (lines["\0row"] != numbers).any()
        or (lines["\0size"] != line.itemsize - 8).any()
    ):
        raise CorruptFrameError("EXR lines are not one after the other")
    return {name: lines[name] for name in channels}
