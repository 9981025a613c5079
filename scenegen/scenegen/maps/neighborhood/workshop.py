"""What every builder of one neighborhood needs at hand."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from jaxtyping import Float64

from scenegen.maps.neighborhood.knobs import NeighborhoodKnobs
from scenegen.maps.neighborhood.streets import KERB_M
from scenegen.parts.workshop import Workshop


@dataclass(frozen=True, eq=False)
class NeighborhoodWorkshop(Workshop):
    """Shared by all parts of one neighborhood while it is built.

    Attributes
    ----------
    knobs : NeighborhoodKnobs
    """

    knobs: NeighborhoodKnobs

    def on_verge(self, rows: Float64[np.ndarray, "rows columns"]) -> Float64[np.ndarray, "rows 3"]:
        """Positions at the level of verges, sidewalks and gardens; the first two columns are the plan [m]."""
        return np.column_stack([rows[:, :2], self.relief(rows[:, :2]) + KERB_M])
