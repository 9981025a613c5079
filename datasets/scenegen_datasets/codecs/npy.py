"""Tables of float64 as ``.npy`` files, written the same way by every numpy and read without parsing anything."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from scenegen.foundation.errors import CorruptFrameError

_ALIGN = 64


def encode(table: NDArray[np.float64]) -> bytes:
    """A table (rows, columns) in format version 1.0, little-endian, row by row."""
    return _header(*table.shape) + np.ascontiguousarray(table, "<f8").tobytes()


def decode(data: bytes, columns: tuple[int, ...]) -> NDArray[np.float64]:
    """The table, if it has one of these numbers of columns.

    Raises
    ------
    CorruptFrameError
        If the bytes are not what `encode` writes.
    """
    length = 10 + int.from_bytes(data[8:10], "little")
    for count in columns:
        rows, rest = divmod(len(data) - length, 8 * count)
        if rest == 0 and rows >= 0 and data[:length] == _header(rows, count):
            return np.frombuffer(data, "<f8", offset=length).astype(np.float64).reshape(rows, count)
    raise CorruptFrameError("not a table as it was written")


def _header(rows: int, columns: int) -> bytes:
    text = f"{{'descr': '<f8', 'fortran_order': False, 'shape': ({rows}, {columns}), }}"
    body = (text + " " * (-(10 + len(text) + 1) % _ALIGN) + "\n").encode("latin-1")
    return b"\x93NUMPY\x01\x00" + len(body).to_bytes(2, "little") + body
