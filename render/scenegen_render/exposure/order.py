"""A spatial order of the sites, so that rays traced one after the other meet the same part of the world."""

from __future__ import annotations

import numpy as np
from jaxtyping import Float32, Int64, UInt64

_SPREAD = (
    (32, 0x001F00000000FFFF),
    (16, 0x001F0000FF0000FF),
    (8, 0x100F00F00F00F00F),
    (4, 0x10C30C30C30C30C3),
    (2, 0x1249249249249249),
)


def spatial_order(
    position: Float32[np.ndarray, "sites 3"], cell_m: float = 1.0
) -> Int64[np.ndarray, "sites"]:
    """Indices of the sites along a Morton curve; ties keep their order.

    Parameters
    ----------
    position : float32 (sites, 3)
        [m]
    cell_m : float
        Resolution of the curve [m].
    """
    low = position.min(axis=0).astype(np.float64)
    cell = ((position.astype(np.float64) - low) / cell_m).astype(np.uint64)
    key = _spread(cell[:, 0]) | _spread(cell[:, 1]) << np.uint64(1) | _spread(cell[:, 2]) << np.uint64(2)
    return np.argsort(key, kind="stable")


def _spread(bits: UInt64[np.ndarray, "sites"]) -> UInt64[np.ndarray, "sites"]:
    """Put two zero bits between the lower 21 bits of a number."""
    x = bits & np.uint64(0x1FFFFF)
    for shift, mask in _SPREAD:
        x = (x | x << np.uint64(shift)) & np.uint64(mask)
    return x
