"""What every builder of one field world needs at hand."""

from __future__ import annotations

from dataclasses import dataclass

from scenegen.maps.field.knobs import FieldKnobs
from scenegen.parts.workshop import Workshop


@dataclass(frozen=True, eq=False)
class FieldWorkshop(Workshop):
    """Shared by all parts of one field world while it is built.

    Attributes
    ----------
    knobs : FieldKnobs
    dryness : float
        Share of this world's meadows that are dry.
    """

    knobs: FieldKnobs
    dryness: float
