"""Depth and flow as the integers other formats store, with what does not fit counted.

Rounding is to the nearest step, so that a value that fits is wrong by half a step at most.
"""

from __future__ import annotations

import numpy as np
from jaxtyping import Bool, Float32, UInt16

Depth = Float32[np.ndarray, "rows columns"]
Flow = Float32[np.ndarray, "rows columns 2"]

FAR, NEAR, FLOW_OUTSIDE = "depth_too_far", "depth_too_near", "flow_outside"
"""Names of the counts of `scenegen_datasets.exports.format.Written`."""

FLOW_STEPS_PER_PX, FLOW_ZERO = 64.0, 32768.0
"""Of KITTI and of TartanAir alike: 16 bits hold -512 to 511.98 px."""

_MOST = 65535


def depth_u16(
    depth: Depth, unit_m: float, *, sky: int = 0, far: int = 0
) -> tuple[UInt16[np.ndarray, "rows columns"], dict[str, int]]:
    """Depth in whole units of `unit_m`.

    Parameters
    ----------
    depth : float32 (rows, columns)
        Planar z [m], sky +inf.
    unit_m : float
        What one step is worth [m].
    sky, far : int
        What sky becomes, and what is farther than 16 bits reach.

    Returns
    -------
    uint16 (rows, columns), and how many surfaces were too far (`FAR`) or rounded to zero (`NEAR`).
    """
    steps = np.rint(depth.astype(np.float64) / unit_m)
    is_sky = np.isinf(depth)
    too_far = (steps > _MOST) & ~is_sky
    near = steps < 1
    values = np.where(is_sky, sky, np.where(too_far, far, steps)).astype(np.uint16)
    return values, {FAR: int(too_far.sum()), NEAR: int(near.sum())}


def flow_u16(
    flow: Flow, valid: Bool[np.ndarray, "rows columns"] | None = None
) -> tuple[UInt16[np.ndarray, "rows columns 2"], Bool[np.ndarray, "rows columns"], int]:
    """Flow in steps of 1/64 px from -512 px.

    Parameters
    ----------
    flow : float32 (rows, columns, 2)
        [px]; NaN where there is none.
    valid : bool (rows, columns), optional
        Pixels to keep.

    Returns
    -------
    values : uint16 (rows, columns, 2)
        0 where it is not valid.
    kept : bool (rows, columns)
    outside : int
        Pixels that were to be kept but do not fit, NaN included.
    """
    steps = np.rint(flow.astype(np.float64) * FLOW_STEPS_PER_PX + FLOW_ZERO)
    fits = ((steps >= 0) & (steps <= _MOST)).all(axis=2)
    wanted = np.ones(fits.shape, bool) if valid is None else valid
    kept = fits & wanted
    values = np.where(kept[..., None], steps, 0).astype(np.uint16)
    return values, kept, int((wanted & ~fits).sum())


def add(counts: dict[str, int], more: dict[str, int]) -> None:
    """Add counts by name."""
    for name, number in more.items():
        counts[name] = counts.get(name, 0) + number
