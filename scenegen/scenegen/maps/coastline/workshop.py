"""What every builder of one coast needs at hand."""

from __future__ import annotations

from dataclasses import dataclass

from scenegen.geometry.relief import Relief
from scenegen.maps.coastline.claims import Claims
from scenegen.maps.coastline.knobs import CoastlineKnobs
from scenegen.maps.coastline.shape import Coast
from scenegen.parts.workshop import Workshop


@dataclass(frozen=True, eq=False)
class CoastWorkshop(Workshop):
    """Shared by all parts of one coast while it is built.

    Attributes
    ----------
    knobs : CoastlineKnobs
    coast : Coast
    unbuilt : callable
        Height of the land [m] before anybody built.
    claims : Claims
        Who stands where.
    """

    knobs: CoastlineKnobs
    coast: Coast
    unbuilt: Relief
    claims: Claims
