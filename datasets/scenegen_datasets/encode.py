"""One frame to the bytes of its members."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import Any

import numpy as np
from jaxtyping import Float32, Float64
from numpy.typing import NDArray

from scenegen.foundation.canonical import canonical, digest
from scenegen.foundation.errors import DatasetError
from scenegen_datasets.invariants import violations
from scenegen_datasets.layers import DEFAULT_LAYERS, layers_by_member
from scenegen_datasets.pixels import array_digest, encode_member
from scenegen_datasets.statistics import frame_statistics, sample
from scenegen_render.frame import Frame
from scenegen_render.sensor.reading import Reading


@dataclass(frozen=True)
class Member:
    """One file of one frame inside the shard.

    Attributes
    ----------
    suffix : str
        E.g. ``thermal.png``; the member is called ``<key>.<suffix>``.
    data : bytes
    digests : mapping of str to str
        Layer name to SHA-256 of its decoded array (`scenegen_datasets.pixels.array_digest`).
    """

    suffix: str
    data: bytes
    digests: Mapping[str, str]


@dataclass(frozen=True, eq=False)
class FrameMeta:
    """When and whence a frame was taken.

    Attributes
    ----------
    time_s : float
        Since the first frame of the clip.
    world_from_camera : float64 (4, 4)
        Pose, OpenCV camera to ENU world [m].
    K : float64 (3, 3)
        Intrinsic matrix [px].
    sensor : mapping
        State of the camera at this frame (plain numbers), stored in the JSON member.
    motion : mapping
        Further entries of the JSON member: where the camera was and will be, how fast it moves, what it is out for.
    imu : float64 (samples, columns) or None
        The layer of that name (`scenegen_datasets.layers.IMU_COLUMNS`).
    """

    time_s: float
    world_from_camera: Float64[np.ndarray, "4 4"]
    K: Float64[np.ndarray, "3 3"]
    sensor: Mapping[str, float | int]
    motion: Mapping[str, Any] = field(default_factory=dict)
    imu: Float64[np.ndarray, "samples columns"] | None = None


@dataclass(frozen=True, eq=False)
class EncodedFrame:
    """All that is stored of one frame.

    Attributes
    ----------
    key : str
    meta : FrameMeta
    shape : (int, int)
        Rows and columns.
    layers : tuple of str
        Layers that were written.
    members : tuple of Member
        In their fixed order.
    statistics : mapping
        Of this frame (`scenegen_datasets.statistics.FRAME_STATISTICS`).
    depth_sample, temperature_sample : float32 (n,)
        For the quantiles of the clip.
    """

    key: str
    meta: FrameMeta
    shape: tuple[int, int]
    layers: tuple[str, ...]
    members: tuple[Member, ...]
    statistics: Mapping[str, float | int | None]
    depth_sample: Float32[np.ndarray, "n"]
    temperature_sample: Float32[np.ndarray, "m"]


def encode_frame(
    key: str,
    frame: Frame,
    reading: Reading,
    meta: FrameMeta,
    layers: tuple[str, ...] = DEFAULT_LAYERS,
) -> EncodedFrame:
    """Encode one frame, losslessly and always to the same bytes.

    Parameters
    ----------
    key : str
        `ClipJob.key` of the frame.
    frame, reading : Frame, Reading
        Truth and counts on one pixel grid.
    meta : FrameMeta
    layers : tuple of str
        Which layers are written (`scenegen_datasets.layers.LAYERS`).

    Raises
    ------
    DatasetError
        If a value may not be stored: NaN or infinity outside sky depth, depth <= 0, counts above 16383, ... or a
        layer that was asked for was not rendered.
    """
    groups = layers_by_member(layers)
    arrays = _arrays(key, frame, reading)
    if meta.imu is not None:
        arrays["imu"] = meta.imu
    _guard(key, arrays, [layer.name for group in groups.values() for layer in group])
    members = [
        Member(
            suffix,
            encode_member(suffix, group, arrays),
            {x.name: array_digest(arrays[x.name]) for x in group},
        )
        for suffix, group in groups.items()
    ]
    members.append(_json_member(key, meta))
    return EncodedFrame(
        key=key,
        meta=meta,
        shape=(frame.depth.shape[0], frame.depth.shape[1]),
        layers=tuple(layer.name for group in groups.values() for layer in group),
        members=tuple(members),
        statistics=frame_statistics(reading.counts, frame.depth, frame.temperature, reading.saturated),
        depth_sample=sample(frame.depth),
        temperature_sample=sample(frame.temperature),
    )


def frame_json(key: str, meta: FrameMeta) -> dict[str, Any]:
    """Content of the JSON member."""
    return {
        "key": key,
        "time_s": float(meta.time_s),
        "world_from_camera": meta.world_from_camera.tolist(),
        "K": meta.K.tolist(),
        "sensor": dict(meta.sensor),
        **meta.motion,
    }


def _json_member(key: str, meta: FrameMeta) -> Member:
    content = frame_json(key, meta)
    return Member("json", canonical(content), {"json": digest(content)})


def _arrays(key: str, frame: Frame, reading: Reading) -> dict[str, NDArray[Any]]:
    arrays = {"thermal": reading.counts, "covisible": frame.covisible}
    for name in ("depth", "flow", "radiance", "temperature", "semantic", "instance", "material"):
        arrays[name] = getattr(frame, name)
    for name in ("flow_back", "covisible_back", "normal"):
        if getattr(frame, name) is not None:
            arrays[name] = getattr(frame, name)
    shape = frame.depth.shape
    for name, array in arrays.items():
        if array.shape[:2] != shape:
            raise DatasetError(
                f"{key}: {name} is {array.shape}, depth is {shape}; layers share one pixel grid"
            )
    return arrays


def _guard(key: str, arrays: Mapping[str, NDArray[Any]], layers: list[str]) -> None:
    missing = [name for name in layers if name not in arrays]
    if missing:
        raise DatasetError(f"{key}: {', '.join(missing)} asked for but not rendered")
    wrong = violations(arrays)
    if wrong:
        raise DatasetError(f"{key}: {'; '.join(wrong)}")
