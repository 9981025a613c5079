"""What the camera reports for one frame."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from jaxtyping import UInt16


@dataclass(frozen=True, eq=False)
class Reading:
    """One sensed frame.

    Attributes
    ----------
    counts : uint16 (rows, columns)
        14-bit counts, 0..16383, linear in band radiance on the dataset's fixed scale.
    saturated : int
        Pixels that hit an end of the scale.
    """

    counts: UInt16[np.ndarray, "rows columns"]
    saturated: int
