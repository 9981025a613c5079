"""How far two renderings of one frame may differ: not at all with the same software, this much with another.

Another CPU class or library rounds differently. A ray along a silhouette then hits the neighbour, which changes every
layer of that pixel; elsewhere only last digits change.
"""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

import numpy as np
from numpy.typing import NDArray

SHARE = 0.99
"""Of the pixels of every layer must agree."""

TOLERANCES: Mapping[str, tuple[float, float]] = {
    "thermal": (4.0, 0.0),
    "depth": (1e-3, 1e-4),
    "radiance": (0.0, 1e-3),
    "temperature": (0.05, 0.0),
    "flow": (0.05, 0.0),
    "flow_back": (0.05, 0.0),
    "normal": (1e-3, 0.0),
    "imu": (1e-6, 1e-6),
}
"""Layer to absolute and relative tolerance, in the layer's unit; layers not named here hold ids and must be equal."""


def beyond_bound(name: str, told: NDArray[Any], again: NDArray[Any]) -> str:
    """Say how a layer that was rendered again differs, if by more than the bound; "" if it does not.

    Parameters
    ----------
    name : str
        Of the layer.
    told, again : array
        As it is stored, and as it came out now.
    """
    if told.shape != again.shape or told.dtype != again.dtype:
        return f"{name} is {again.dtype} {again.shape}, {told.dtype} {told.shape} is stored"
    absolute, relative = TOLERANCES.get(name, (0.0, 0.0))
    near = np.isclose(
        again.astype(np.float64), told.astype(np.float64), rtol=relative, atol=absolute, equal_nan=True
    )
    share = float(near.mean()) if near.size else 1.0
    return "" if share >= SHARE else f"{name} agrees in {100 * share:.1f} % of its values only"
