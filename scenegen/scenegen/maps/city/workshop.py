"""What every builder of one city needs at hand."""

from __future__ import annotations

from dataclasses import dataclass

from scenegen.maps.city.knobs import CityKnobs
from scenegen.parts.workshop import Workshop


@dataclass(frozen=True, eq=False)
class CityWorkshop(Workshop):
    """Shared by all parts of one city while it is built.

    Attributes
    ----------
    knobs : CityKnobs
    """

    knobs: CityKnobs
