"""``calib.npy`` of MS2: a dictionary of arrays in pickle's notation, because that is what every MS2 loader loads.

A pickle is a program, so this one is spelled out opcode by opcode and can be read here: it makes arrays and a
dictionary, and names nothing but the classes ``numpy.ndarray`` and ``numpy.dtype``. Scanners of pickles let these two
pass; what numpy itself writes also names a function whose module moved in version 2. The bytes depend on nothing but
the numbers. This project never loads such a file.
"""

from __future__ import annotations

import struct
from collections.abc import Mapping

import numpy as np
from jaxtyping import Float64

_PROTOCOL, _STOP = b"\x80\x03", b"."
_NDARRAY, _DTYPE = b"cnumpy\nndarray\n", b"cnumpy\ndtype\n"
_MARK, _LIST, _TUPLE, _TUPLE1 = b"(", b"l", b"t", b"\x85"
_CALL, _SET_STATE, _DICTIONARY, _SET_ITEMS, _FALSE = b"R", b"b", b"}", b"u", b"\x89"


def calibration_npy(arrays: Mapping[str, Float64[np.ndarray, "..."]]) -> bytes:
    """Bytes of an ``.npy`` file that ``np.load(path, allow_pickle=True).item()`` reads as this dictionary."""
    items = b"".join(_text(name) + _array(array) for name, array in arrays.items())
    dictionary = _DICTIONARY + _MARK + items + _SET_ITEMS
    return _header() + _PROTOCOL + _filled((), "|O", _MARK + dictionary + _LIST) + _STOP


def _array(array: Float64[np.ndarray, "..."]) -> bytes:
    data = np.ascontiguousarray(array, "<f8").tobytes()
    return _filled(array.shape, "<f8", b"B" + struct.pack("<I", len(data)) + data)


def _filled(shape: tuple[int, ...], kind: str, content: bytes) -> bytes:
    """An empty ``numpy.ndarray``, then its state: version 1, shape, type, not in Fortran's order, content."""
    empty = _NDARRAY + _shape((0,)) + _TUPLE1 + _CALL
    dtype = _DTYPE + _text(kind) + _TUPLE1 + _CALL
    return empty + _MARK + _whole(1) + _shape(shape) + dtype + _FALSE + content + _TUPLE + _SET_STATE


def _shape(shape: tuple[int, ...]) -> bytes:
    return _MARK + b"".join(map(_whole, shape)) + _TUPLE


def _whole(number: int) -> bytes:
    return b"J" + struct.pack("<i", number)


def _text(text: str) -> bytes:
    data = text.encode()
    return b"X" + struct.pack("<I", len(data)) + data


def _header() -> bytes:
    """Header of an array of objects without dimensions, version 1.0 of the format."""
    text = "{'descr': '|O', 'fortran_order': False, 'shape': (), }"
    body = (text + " " * (-(10 + len(text) + 1) % 64) + "\n").encode("latin-1")
    return b"\x93NUMPY\x01\x00" + struct.pack("<H", len(body)) + body
