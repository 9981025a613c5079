"""The layers of a frame: names, types, units, and the member each one is stored in. One place for all of it."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from dataclasses import dataclass

from scenegen.foundation.errors import InputError, nearest


@dataclass(frozen=True)
class Layer:
    """One array per frame; all but ``imu`` share the frame's pixel grid.

    Attributes
    ----------
    name : str
        Name in recipes, receipts and loaders.
    member : str
        Suffix of the member that holds it.
    channels : tuple of str
        EXR channels or columns; empty where the member is a plain image.
    dtype : str
        Type of the array in memory, and of the digest.
    stored : str
        Type in the file.
    unit : str
    meaning : str
    """

    name: str
    member: str
    channels: tuple[str, ...]
    dtype: str
    stored: str
    unit: str
    meaning: str


_TRUTH, _BACK = "truth.exr", "flow_back.exr"
IMU_MEMBER = "imu.npy"
IMU_COLUMNS = ("time", "force_x", "force_y", "force_z", "rate_x", "rate_y", "rate_z")
"""Columns of the inertial table; with noise, six more follow: the same forces and rates as measured."""

LAYERS: dict[str, Layer] = {
    layer.name: layer
    for layer in (
        Layer("thermal", "thermal.png", (), "uint16", "uint16", "count", "what the camera reports, 0..16383"),
        Layer("depth", "depth.tiff", (), "float32", "float32", "m", "planar z; sky +inf"),
        Layer(
            "flow", "flow.exr", ("u", "v"), "float32", "float32", "px", "to the next frame: u right, v down"
        ),
        Layer(
            "radiance", _TRUTH, ("radiance",), "float32", "float32", "W m^-2 sr^-1", "in band, at the sensor"
        ),
        Layer(
            "temperature",
            _TRUTH,
            ("temperature",),
            "float32",
            "float32",
            "K",
            "kinetic, of the surface; sky 0",
        ),
        Layer("semantic", _TRUTH, ("semantic",), "uint8", "uint32", "id", "class"),
        Layer("instance", _TRUTH, ("instance",), "uint32", "uint32", "id", "object; sky 0"),
        Layer("material", _TRUTH, ("material",), "uint16", "uint32", "id", "material; sky 0"),
        Layer("covisible", _TRUTH, ("covisible",), "bool", "float16", "0 or 1", "seen in the next frame too"),
        Layer("flow_back", _BACK, ("u", "v"), "float32", "float32", "px", "to the previous frame"),
        Layer(
            "covisible_back",
            _BACK,
            ("covisible",),
            "bool",
            "float16",
            "0 or 1",
            "seen in the previous frame too",
        ),
        Layer(
            "normal",
            "normal.exr",
            ("x", "y", "z"),
            "float32",
            "float32",
            "1",
            "camera frame, facing it; sky 0",
        ),
        Layer(
            "imu",
            IMU_MEMBER,
            IMU_COLUMNS,
            "float64",
            "float64",
            "s, m s^-2, rad s^-1",
            "specific force and body rates from this frame to the next, 200 Hz",
        ),
    )
}
"""All layers by name, in the order of their members."""

MEMBERS = (
    "thermal.png",
    "depth.tiff",
    "flow.exr",
    "truth.exr",
    "flow_back.exr",
    "normal.exr",
    IMU_MEMBER,
    "json",
)
"""Suffixes of a frame's members in the order they stand in the shard."""

UNCOMPRESSED = ("flow.exr",)
"""EXR members that are stored as they are, because compression costs much and saves little."""

MAX_COUNT = 16383
"""Largest count of the 14-bit scale."""

DEFAULT_LAYERS: tuple[str, ...] = (
    "thermal",
    "depth",
    "flow",
    "covisible",
    "radiance",
    "temperature",
    "semantic",
    "instance",
    "material",
)
"""What is written unless the recipe says otherwise; all other layers on request."""

_MAX_PIXELS = 1 << 24


def max_member_bytes(shape: tuple[int, int]) -> int:
    """Bytes a sound member of this image size stays below; 0 for an image size nobody renders."""
    rows, columns = shape
    return rows * columns * 32 + (1 << 20) if 0 < rows * columns <= _MAX_PIXELS else 0


def member_field(suffix: str) -> str:
    """Name of a member in the index: its suffix up to the first dot."""
    return suffix.partition(".")[0]


def check_layers(layers: Iterable[str], besides: Sequence[str] = ()) -> tuple[str, ...]:
    """Return the layers in storage order, each once.

    Parameters
    ----------
    layers : iterable of str
    besides : sequence of str
        Names that may be asked for, too, but are not stored: they are left out of the answer.

    Raises
    ------
    InputError
        For a name that is neither.
    """
    asked = tuple(layers)
    for name in asked:
        if name not in LAYERS and name not in besides:
            raise InputError(f"unknown layer '{name}'{nearest(str(name), (*LAYERS, *besides))}")
    return tuple(name for name in LAYERS if name in asked)


def layers_by_member(layers: Iterable[str]) -> dict[str, tuple[Layer, ...]]:
    """Group layers by the member that holds them, members in storage order."""
    chosen = [LAYERS[name] for name in check_layers(layers)]
    return {m: found for m in MEMBERS if (found := tuple(x for x in chosen if x.member == m))}
