"""Arrays of one member to bytes and back, and the digest that names an array."""

from __future__ import annotations

import hashlib
from collections.abc import Iterable, Mapping
from typing import Any

import numpy as np
from numpy.typing import NDArray

from scenegen.foundation.errors import CorruptFrameError
from scenegen_datasets.codecs import exr, npy, png, tiff
from scenegen_datasets.layers import IMU_COLUMNS, UNCOMPRESSED, Layer

Arrays = Mapping[str, NDArray[Any]]
"""Layer name to array."""


def array_digest(array: NDArray[Any]) -> str:
    """SHA-256 of type, shape and little-endian bytes: the identity of an array, whatever compressed it."""
    little = np.ascontiguousarray(array, array.dtype.newbyteorder("<"))
    sum_ = hashlib.sha256(f"{little.dtype.name}{list(little.shape)}".encode())
    sum_.update(little.data)
    return sum_.hexdigest()


def encode_member(suffix: str, layers: Iterable[Layer], arrays: Arrays) -> bytes:
    """Encode the layers that share one member."""
    chosen = tuple(layers)
    if suffix.endswith(".png"):
        return png.encode(arrays[chosen[0].name])
    if suffix.endswith(".tiff"):
        return tiff.encode(arrays[chosen[0].name])
    if suffix.endswith(".npy"):
        return npy.encode(arrays[chosen[0].name])
    channels: dict[str, NDArray[Any]] = {}
    for layer in chosen:
        planes = _planes(arrays[layer.name])
        channels |= {
            c: plane.astype(layer.stored, copy=False) for c, plane in zip(layer.channels, planes, strict=True)
        }
    units = {f"unit.{c}": layer.unit for layer in chosen for c in layer.channels}
    return exr.encode(channels, units, zipped=suffix not in UNCOMPRESSED)


def decode_member(
    suffix: str, layers: Iterable[Layer], data: bytes, shape: tuple[int, int]
) -> dict[str, NDArray[Any]]:
    """Decode all layers of one member.

    Parameters
    ----------
    suffix : str
    layers : iterable of Layer
        All the layers the member was written with.
    data : bytes
    shape : (int, int)
        Rows and columns there must be.

    Raises
    ------
    CorruptFrameError
        If the bytes are not what `encode_member` writes for these layers and this shape.
    """
    chosen = tuple(layers)
    if suffix.endswith(".png"):
        return {chosen[0].name: png.decode(data, shape)}
    if suffix.endswith(".tiff"):
        return {chosen[0].name: tiff.decode(data, shape)}
    if suffix.endswith(".npy"):
        return {chosen[0].name: npy.decode(data, (len(IMU_COLUMNS), 2 * len(IMU_COLUMNS) - 1))}
    stored = {c: np.dtype(layer.stored) for layer in chosen for c in layer.channels}
    planes = exr.decode(data, shape, stored)
    return {layer.name: _narrowed([planes[c] for c in layer.channels], layer) for layer in chosen}


def _planes(array: NDArray[Any]) -> list[NDArray[Any]]:
    return [array] if array.ndim == 2 else [array[..., k] for k in range(array.shape[2])]


def _narrowed(planes: list[NDArray[Any]], layer: Layer) -> NDArray[Any]:
    """Stack channels and go back to the type in memory; what does not fit in it was never written by us."""
    stacked = np.ascontiguousarray(planes[0]) if len(planes) == 1 else np.stack(planes, axis=-1)
    if layer.dtype == layer.stored:
        return stacked
    limit = 1 if layer.dtype == "bool" else np.iinfo(layer.dtype).max
    narrow = stacked.astype(layer.dtype)
    if layer.dtype == "bool":
        if not ((stacked == 0) | (stacked == 1)).all():
            raise CorruptFrameError(f"{layer.name} holds other values than 0 and 1")
    elif stacked.size and stacked.max() > limit:
        raise CorruptFrameError(f"{layer.name} holds ids above {limit}")
    return narrow
