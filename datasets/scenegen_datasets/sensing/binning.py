"""From a fine grid to a coarser one whose pixels are whole blocks of fine ones.

Radiance of a block is the mean: a detector integrates over its area. Labels belong to the ray through a pixel's centre.
With an odd number of fine pixels a side that ray was traced. With an even number the centre lies on the corner of four
pixels: where these see one surface, the label is interpolated to the corner (inverse depth is affine on a plane, so
depth is exact there); elsewhere the one right below the corner stands for it, half a fine pixel off.
"""

from __future__ import annotations

from typing import Any

import numpy as np
from jaxtyping import Bool, Float32
from numpy.typing import NDArray

from scenegen_render.frame import Frame

_IDS = ("semantic", "instance", "material")


def mean_radiance(
    radiance: Float32[np.ndarray, "rows columns"], side: int
) -> Float32[np.ndarray, "coarse_rows coarse_columns"]:
    """Mean over blocks of `side` x `side` pixels."""
    rows, columns = radiance.shape
    blocks = radiance.reshape(rows // side, side, columns // side, side)
    return np.asarray(blocks.mean(axis=(1, 3), dtype=np.float64)).astype(np.float32)


def binned(frame: Frame, side: int) -> Frame:
    """The frame as a camera of `side` times fewer pixels a side would be told the truth.

    Parameters
    ----------
    frame : Frame
        Its sides are multiples of `side`.
    side : int
        Fine pixels along the side of a coarse one.
    """
    if side == 1:
        return frame
    middle = {name: _middle(array, side) for name, array in vars(frame).items() if array is not None}
    same = [(middle[name] == middle[name][0]).all(axis=0) for name in _IDS]
    one = np.asarray(same[0] & same[1] & same[2])
    layers: dict[str, Any] = {name: middle[name][-1].copy() for name in _IDS}
    layers["radiance"] = mean_radiance(frame.radiance, side)
    layers["depth"] = _where(one, _harmonic(middle["depth"]), middle["depth"])
    layers["temperature"] = _where(one, middle["temperature"].mean(axis=0), middle["temperature"])
    for flow, covisible in (("flow", "covisible"), ("flow_back", "covisible_back")):
        if flow in middle:  # backward flow is there on request only
            layers[flow] = _where(one, middle[flow].mean(axis=0), middle[flow]) / np.float32(side)
            seen = _where(one, np.asarray(middle[covisible].all(axis=0)), middle[covisible])
            layers[covisible] = seen & _inside(layers[flow])
    if frame.normal is not None:
        total = middle["normal"].sum(axis=0)
        length = np.maximum(np.linalg.norm(total, axis=-1, keepdims=True), np.float32(1e-6))
        layers["normal"] = _where(one, total / length, middle["normal"])
    return Frame(**layers)


def _middle(array: NDArray[Any], side: int) -> NDArray[Any]:
    """The one middle pixel of every block, or its four: shape (1 or 4, coarse rows, coarse columns, ...)."""
    first = (side - 1) // 2
    at = (first,) if side % 2 else (first, first + 1)
    return np.stack([array[row::side, column::side] for row in at for column in at])


def _harmonic(depth: NDArray[np.float32]) -> NDArray[np.float32]:
    with np.errstate(divide="ignore"):
        return np.asarray(1.0 / (1.0 / depth.astype(np.float64)).mean(axis=0)).astype(np.float32)


def _where(one: Bool[np.ndarray, "rows columns"], joint: NDArray[Any], middle: NDArray[Any]) -> NDArray[Any]:
    """What the middle pixels say together where they see one surface, else what the last of them says."""
    mask = one if joint.ndim == 2 else one[..., None]
    return np.asarray(np.where(mask & np.isfinite(joint), joint, middle[-1]))


def _inside(flow: NDArray[np.float32]) -> NDArray[np.bool_]:
    """Whether the place a pixel's centre flows to lies in the image."""
    rows, columns = flow.shape[:2]
    u = flow[..., 0] + (np.arange(columns, dtype=np.float32) + 0.5)
    v = flow[..., 1] + (np.arange(rows, dtype=np.float32)[:, None] + 0.5)
    return np.asarray((u >= 0) & (u <= columns) & (v >= 0) & (v <= rows))
