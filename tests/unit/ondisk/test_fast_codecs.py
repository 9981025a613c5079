"""The two decoders that do without a picture library: exact, and no easier to fool than the libraries."""

from __future__ import annotations

import io
import struct
import zlib

import cv2
import numpy as np
import OpenEXR
import pytest

from scenegen.foundation.errors import CorruptFrameError
from scenegen_datasets.codecs import exr, png, sub_filter

RNG = np.random.default_rng(11)
PLANES = {"u": np.dtype(np.float32), "id": np.dtype(np.uint32), "half": np.dtype(np.float16)}


def png_of(raw: bytes, rows: int, columns: int) -> bytes:
    """A PNG with this content in its one IDAT."""

    def chunk(name: bytes, data: bytes) -> bytes:
        return struct.pack(">I", len(data)) + name + data + struct.pack(">I", zlib.crc32(name + data))

    header = chunk(b"IHDR", struct.pack(">IIBBBBB", columns, rows, 16, 0, 0, 0, 0))
    return b"\x89PNG\r\n\x1a\n" + header + chunk(b"IDAT", raw) + chunk(b"IEND", b"")


@pytest.mark.parametrize("shape", [(2, 2), (3, 5), (17, 300)])
def test_our_own_pngs_need_no_library(shape: tuple[int, int]) -> None:
    counts = RNG.integers(0, 65536, shape).astype(np.uint16)
    back = sub_filter.pixels(png.encode(counts), shape)
    assert back is not None and back.dtype == np.uint16 and back.flags.writeable
    np.testing.assert_array_equal(back, counts)


def test_pngs_with_other_filters_are_left_to_the_library() -> None:
    counts = np.add.outer(np.arange(40), np.arange(60)).astype(np.uint16) * 37
    _, data = cv2.imencode(".png", counts, [cv2.IMWRITE_PNG_COMPRESSION, 6])
    assert sub_filter.pixels(bytes(data), (40, 60)) is None
    np.testing.assert_array_equal(png.decode(bytes(data), (40, 60)), counts)


@pytest.mark.parametrize(
    "raw",
    [
        zlib.compress(bytes(1 << 24)),
        zlib.compress(b"\1" + bytes(16)),
        zlib.compress(b"\1" + bytes(16))[:-4],
        b"",
        b"\0" * 40,
        zlib.compress((b"\1" + bytes(16)) * 8) + b"more",
        zlib.compress((b"\1" + bytes(16)) * 8)[:-1] + b"\xff",
    ],
)
def test_a_png_that_inflates_to_anything_but_its_pixels_is_refused(raw: bytes) -> None:
    with pytest.raises(CorruptFrameError, match="PNG does not"):
        png.decode(png_of(raw, 8, 8), (8, 8))


def planes(shape: tuple[int, int]) -> dict[str, np.ndarray]:
    return {
        name: RNG.integers(0, 999, shape).astype(kind) + (kind.kind == "f") * kind.type(0.5)
        for name, kind in PLANES.items()
    }


@pytest.mark.parametrize("shape", [(1, 1), (5, 3), (33, 70)])
def test_uncompressed_exr_needs_no_library(shape: tuple[int, int], monkeypatch: pytest.MonkeyPatch) -> None:
    values = planes(shape)
    data = exr.encode(values, {"unit.u": "px"}, zipped=False)
    theirs = OpenEXR.File(io.BytesIO(data), True, False, 0).channels()
    monkeypatch.setattr(OpenEXR, "File", None)
    back = exr.decode(data, shape, PLANES)
    for name, value in values.items():
        assert back[name].dtype == PLANES[name]
        np.testing.assert_array_equal(back[name], value)
        np.testing.assert_array_equal(theirs[name].pixels, value)


def test_forged_lines_of_an_exr_are_refused() -> None:
    shape = (6, 4)
    data = exr.encode(planes(shape), {}, zipped=False)
    line = 8 + 4 * (4 + 4 + 2)
    first = len(data) - 6 * line
    swapped = data[:first] + data[first + line : first + 2 * line] + data[first : first + line]
    forged = {
        "swapped": swapped + data[first + 2 * line :],
        "offset": data[: first - 8] + bytes(8) + data[first:],
        "size": data[: first + 4] + b"\xff" + data[first + 5 :],
        "short": data[:-1],
        "long": data + b"\0",
    }
    for bad in forged.values():
        with pytest.raises(CorruptFrameError, match="EXR"):
            exr.decode(bad, shape, PLANES)
