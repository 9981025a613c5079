"""Eq. (1) of the paper: the simplified depth image, pixel by pixel on a coarse grid, inside the thermal image."""

from __future__ import annotations

import numpy as np
from jaxtyping import UInt8


def embed(
    thermal: UInt8[np.ndarray, "rows columns"], simplified: UInt8[np.ndarray, "rows columns"], interval: int
) -> UInt8[np.ndarray, "rows columns"]:
    """E = S where row and column are multiples of `interval` and S is not 0; E = T elsewhere.

    Parameters
    ----------
    thermal, simplified : uint8 (rows, columns)
        T and S.
    interval : int
        5 in the paper. Rows and columns are counted from 0.
    """
    embedded = thermal.copy()
    some = simplified[::interval, ::interval]
    grid = embedded[::interval, ::interval]
    grid[...] = np.where(some != 0, some, grid)
    return embedded
