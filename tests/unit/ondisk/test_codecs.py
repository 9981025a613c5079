"""Every array comes back bit by bit, by our readers and by those that others have."""

from __future__ import annotations

import io
import struct
import zlib
from types import ModuleType

import cv2
import numpy as np
import OpenEXR
import pytest
from PIL import Image

from scenegen.foundation.errors import CorruptFrameError
from scenegen_datasets.codecs import exr, npy, png, tiff
from scenegen_datasets.layers import LAYERS, layers_by_member
from scenegen_datasets.pixels import array_digest, decode_member, encode_member

SHAPES = [(1, 1), (3, 5), (17, 2), (64, 48), (40, 130)]
RNG = np.random.default_rng(5)


def counts(shape: tuple[int, int]) -> np.ndarray:
    values = RNG.integers(0, 16384, shape).astype(np.uint16)
    values.flat[0], values.flat[-1] = 0, 16383
    return values


def depth(shape: tuple[int, int]) -> np.ndarray:
    values = RNG.uniform(1e-3, 9e4, shape).astype(np.float32)
    values[RNG.uniform(size=shape) < 0.3] = np.inf
    return values


@pytest.mark.parametrize("shape", SHAPES)
def test_counts_are_exact_in_every_reader(shape: tuple[int, int]) -> None:
    values = counts(shape)
    data = png.encode(values)
    assert data == png.encode(values.copy())
    for back in (
        png.decode(data, shape),
        cv2.imdecode(np.frombuffer(data, np.uint8), cv2.IMREAD_UNCHANGED),
        np.asarray(Image.open(io.BytesIO(data))).astype(np.uint16),
    ):
        assert back.dtype == np.uint16
        np.testing.assert_array_equal(back, values)


@pytest.mark.parametrize("shape", SHAPES)
def test_depth_is_exact_in_every_reader_infinity_included(shape: tuple[int, int]) -> None:
    values = depth(shape)
    data = tiff.encode(values)
    assert data == tiff.encode(values.copy())
    for back in (
        tiff.decode(data, shape),
        cv2.imdecode(np.frombuffer(data, np.uint8), cv2.IMREAD_UNCHANGED),
        np.asarray(Image.open(io.BytesIO(data))),
    ):
        assert back.dtype == np.float32
        assert back.tobytes() == values.tobytes()


def test_nothing_is_written_to_stderr_by_the_tiff_library(capfd: pytest.CaptureFixture[str]) -> None:
    tiff.decode(tiff.encode(depth((8, 8))), (8, 8))
    assert capfd.readouterr().err == ""


@pytest.mark.parametrize("shape", SHAPES)
def test_exr_is_exact_and_carries_units(shape: tuple[int, int]) -> None:
    planes = {
        "radiance": RNG.uniform(1, 200, shape).astype(np.float32),
        "instance": RNG.integers(0, 2**32, shape, dtype=np.uint32),
        "covisible": (RNG.uniform(size=shape) < 0.5).astype(np.float16),
    }
    data = exr.encode(planes, {"unit.radiance": "W m^-2 sr^-1"})
    assert data == exr.encode(planes, {"unit.radiance": "W m^-2 sr^-1"})
    back = exr.decode(data, shape, {name: plane.dtype for name, plane in planes.items()})
    other = OpenEXR.File(io.BytesIO(data), separate_channels=True)
    assert other.header()["unit.radiance"] == "W m^-2 sr^-1"
    for name, plane in planes.items():
        assert back[name].tobytes() == other.channels()[name].pixels.tobytes() == plane.tobytes()


def test_every_layer_survives_its_member(fakes: ModuleType) -> None:
    rng = np.random.default_rng(0)
    frame, reading = fakes.frame(rng, extra=True), fakes.reading(rng)
    arrays = {name: getattr(frame, name) for name in LAYERS if name not in ("thermal", "imu")} | {
        "thermal": reading.counts,
        "imu": fakes.imu(2),
    }
    seen = set()
    for suffix, group in layers_by_member(LAYERS).items():
        data = encode_member(suffix, group, arrays)
        for name, back in decode_member(suffix, group, data, fakes.SHAPE).items():
            assert back.dtype == LAYERS[name].dtype == arrays[name].dtype
            assert back.tobytes() == np.ascontiguousarray(arrays[name]).tobytes()
            assert array_digest(back) == array_digest(arrays[name])
            seen.add(name)
    assert seen == set(LAYERS)


def test_the_digest_tells_type_shape_and_values_apart() -> None:
    zeros = [np.zeros((2, 3), np.float32), np.zeros((3, 2), np.float32), np.zeros((2, 3), np.uint32)]
    assert len({array_digest(a) for a in [*zeros, np.ones((2, 3), np.float32)]}) == 4
    big = np.arange(6, dtype=">u2").reshape(2, 3)
    assert array_digest(big) == array_digest(big.astype("<u2"))
    assert array_digest(np.asfortranarray(zeros[0])) == array_digest(zeros[0])


def chunk(name: bytes, data: bytes) -> bytes:
    return struct.pack(">I", len(data)) + name + data + struct.pack(">I", zlib.crc32(name + data))


def test_a_png_that_declares_another_size_is_refused_before_it_is_decoded() -> None:
    header = struct.pack(">IIBBBBB", 100_000, 100_000, 16, 0, 0, 0, 0)
    bomb = (
        b"\x89PNG\r\n\x1a\n"
        + chunk(b"IHDR", header)
        + chunk(b"IDAT", zlib.compress(bytes(1 << 20)))
        + chunk(b"IEND", b"")
    )
    with pytest.raises(CorruptFrameError, match="100000x100000"):
        png.decode(bomb, (8, 8))


def test_a_png_with_foreign_chunks_is_refused() -> None:
    data = png.encode(counts((8, 8)))
    extra = data[:33] + chunk(b"zTXt", b"k\0\0" + zlib.compress(bytes(1 << 20))) + data[33:]
    with pytest.raises(CorruptFrameError, match="other chunks"):
        png.decode(extra, (8, 8))


@pytest.mark.parametrize("columns", [7, 13])
@pytest.mark.parametrize("rows", [0, 1, 333])
def test_tables_are_plain_npy_files(rows: int, columns: int) -> None:
    table = RNG.normal(size=(rows, columns))
    data = npy.encode(table)
    back = np.load(io.BytesIO(data), allow_pickle=False)
    written = io.BytesIO()
    np.lib.format.write_array(written, table, version=(1, 0))
    assert data == written.getvalue()
    for read in (back, npy.decode(data, (7, 13))):
        assert read.dtype == np.float64
        assert read.shape == table.shape
        assert read.tobytes() == table.tobytes()
    for bad in (data[:-1], data + b"0", data[:40], b"", data.replace(b"<f8", b"|O8")):
        with pytest.raises(CorruptFrameError, match="not a table"):
            npy.decode(bad, (7, 13))
    with pytest.raises(CorruptFrameError, match="not a table"):
        npy.decode(data, (5,))


@pytest.mark.parametrize("tag", [256, 257, 258, 259, 277, 278, 279, 317, 339])
def test_a_tiff_with_any_forged_tag_is_refused(tag: int) -> None:
    data = bytearray(tiff.encode(depth((8, 8))))
    at = int.from_bytes(data[4:8], "little")
    for k in range(int.from_bytes(data[at : at + 2], "little")):
        entry = at + 2 + 12 * k
        if int.from_bytes(data[entry : entry + 2], "little") == tag:
            kind = int.from_bytes(data[entry + 2 : entry + 4], "little")
            size = 2 if kind == 3 else 4
            forged = 0 if tag == 278 else 60_000
            data[entry + 8 : entry + 8 + size] = forged.to_bytes(size, "little")
            break
    else:
        pytest.fail(f"no tag {tag}")
    with pytest.raises(CorruptFrameError):
        tiff.decode(bytes(data), (8, 8))


def test_a_tiff_with_two_pages_is_refused() -> None:
    buffer = io.BytesIO()
    page = Image.fromarray(np.ones((8, 8), np.float32))
    page.save(buffer, "TIFF", save_all=True, append_images=[page], compression="tiff_adobe_deflate")
    with pytest.raises(CorruptFrameError):
        tiff.decode(buffer.getvalue(), (8, 8))


def test_an_exr_that_declares_another_size_or_channels_is_refused_before_it_is_decoded() -> None:
    plane = np.ones((8, 8), np.float32)
    data = exr.encode({"x": plane}, {})
    window = struct.pack("<4i", 0, 0, 7, 7)
    bomb = data.replace(window, struct.pack("<4i", 0, 0, 99_999, 99_999))
    with pytest.raises(CorruptFrameError, match="not 8x8"):
        exr.decode(bomb, (8, 8), {"x": plane.dtype})
    with pytest.raises(CorruptFrameError, match="other channels"):
        exr.decode(data, (8, 8), {"y": plane.dtype})
    with pytest.raises(CorruptFrameError, match="other channels"):
        exr.decode(data, (8, 8), {"x": np.dtype(np.float16)})


@pytest.mark.parametrize(
    ("codec", "data"),
    [
        ("png", png.encode(counts((9, 7)))),
        ("tiff", tiff.encode(depth((9, 7)))),
        ("exr", exr.encode({"x": RNG.uniform(size=(9, 7)).astype(np.float32)}, {"unit.x": "m"})),
    ],
)
def test_damaged_bytes_never_crash_a_decoder(codec: str, data: bytes) -> None:
    """Truncation at every length and 400 random flips: an array of the right kind, or one clear error."""
    decode = {
        "png": lambda d: png.decode(d, (9, 7)),
        "tiff": lambda d: tiff.decode(d, (9, 7)),
        "exr": lambda d: exr.decode(d, (9, 7), {"x": np.dtype(np.float32)})["x"],
    }[codec]
    rng = np.random.default_rng(1)
    damaged = [data[:n] for n in range(len(data))]
    for _ in range(400):
        flipped = bytearray(data)
        flipped[rng.integers(len(data))] ^= 1 << rng.integers(8)
        damaged.append(bytes(flipped))
    for item in damaged:
        try:
            assert decode(item).shape == (9, 7)
        except CorruptFrameError as error:
            assert "\n" not in str(error)


def test_ids_that_do_not_fit_are_damage_not_data(fakes: ModuleType) -> None:
    plane = np.full((4, 4), 300, np.uint32)
    data = exr.encode({"semantic": plane}, {})
    with pytest.raises(CorruptFrameError, match="semantic"):
        decode_member("truth.exr", [LAYERS["semantic"]], data, (4, 4))
    data = exr.encode({"covisible": np.full((4, 4), 0.5, np.float16)}, {})
    with pytest.raises(CorruptFrameError, match="covisible"):
        decode_member("truth.exr", [LAYERS["covisible"]], data, (4, 4))
