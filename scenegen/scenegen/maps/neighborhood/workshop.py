"""What every builder of one neighborhood needs at hand."""

from __future__ import annotations

from dataclasses import dataclass

from scenegen.maps.neighborhood.knobs import NeighborhoodKnobs
from scenegen.parts.workshop import Workshop


@dataclass(frozen=True, eq=False)
class NeighborhoodWorkshop(Workshop):
    """Shared by all parts of one neighborhood while it is built.

    Attributes
    ----------
    knobs : NeighborhoodKnobs
    """

    knobs: NeighborhoodKnobs
