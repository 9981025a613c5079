"""Who stands where: each builder claims its ground before the next one looks for some."""

from __future__ import annotations

import numpy as np
import shapely
from jaxtyping import Bool

from scenegen.geometry.placement import clear_of, first_come


class Claims:
    """Plan shapes taken so far, in the order of the claims."""

    def __init__(self) -> None:
        self._taken: list[shapely.Geometry] = []

    def take(self, shapes: np.ndarray, gap_m: float = 0.0) -> Bool[np.ndarray, "shapes"]:
        """Claim what is free: shapes that keep a distance from all earlier claims and touch no earlier shape.

        Parameters
        ----------
        shapes : array of shapely.Geometry
            First come, first served.
        gap_m : float
            Distance kept from earlier claims [m].

        Returns
        -------
        bool (shapes,)
            Which shapes were free; these are claimed.
        """
        free = self.free(shapes, gap_m)
        index = np.flatnonzero(free)
        free[index] = first_come(shapes[index])
        self._taken.extend(shapes[free])
        return free

    def hold(self, *shapes: shapely.Geometry) -> None:
        """Claim without asking."""
        self._taken.extend(shapes)

    def free(self, shapes: np.ndarray, gap_m: float = 0.0) -> Bool[np.ndarray, "shapes"]:
        """Which shapes keep a distance from all claims."""
        return clear_of(shapes, np.array(self._taken, dtype=object), gap_m)
