"""``calib.npy`` of MS2: a dictionary of arrays in pickle's notation, because that is what every MS2 loader loads.

The notation is spelled out here, opcode by opcode: the bytes then depend on nothing but the numbers, any numpy reads
them (what numpy itself writes names modules that moved in version 2), and it is plain to see that they call nothing but
``numpy.array``. This project never loads such a file.
"""

from __future__ import annotations

import struct
from collections.abc import Mapping

import numpy as np
from jaxtyping import Float64

_PROTOCOL, _STOP = b"\x80\x02", b"."
_ARRAY = b"cnumpy\narray\n"
_MARK, _LIST, _TUPLE1, _TUPLE2, _REDUCE, _SET_ITEMS = b"(", b"l", b"\x85", b"\x86", b"R", b"u"


def calibration_npy(arrays: Mapping[str, Float64[np.ndarray, "..."]]) -> bytes:
    """Bytes of an ``.npy`` file that ``np.load(path, allow_pickle=True).item()`` reads as this dictionary."""
    items = b"".join(_text(name) + _array(array.tolist()) for name, array in arrays.items())
    dictionary = b"}" + _MARK + items + _SET_ITEMS
    whole = _ARRAY + dictionary + _text("O") + _TUPLE2 + _REDUCE
    return _header() + _PROTOCOL + whole + _STOP


def _array(values: object) -> bytes:
    return _ARRAY + _value(values) + _TUPLE1 + _REDUCE


def _value(value: object) -> bytes:
    """A float, or nested lists of floats."""
    if isinstance(value, list):
        return _MARK + b"".join(map(_value, value)) + _LIST
    assert isinstance(value, float), value
    return b"G" + struct.pack(">d", value)


def _text(text: str) -> bytes:
    data = text.encode()
    return b"X" + struct.pack("<I", len(data)) + data


def _header() -> bytes:
    """Header of an array of objects without dimensions, version 1.0 of the format."""
    text = "{'descr': '|O', 'fortran_order': False, 'shape': (), }"
    body = (text + " " * (-(10 + len(text) + 1) % 64) + "\n").encode("latin-1")
    return b"\x93NUMPY\x01\x00" + struct.pack("<H", len(body)) + body
