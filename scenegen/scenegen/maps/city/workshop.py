"""What every builder of one city needs at hand."""

from __future__ import annotations

from dataclasses import dataclass

from scenegen.geometry.builder import GeometryBuilder
from scenegen.geometry.relief import WaveRelief
from scenegen.maps.city.knobs import CityKnobs
from scenegen.materials.palette import PaletteBuilder


@dataclass(frozen=True, eq=False)
class Workshop:
    """Shared by all parts of one city while it is built.

    Attributes
    ----------
    knobs : CityKnobs
    relief : WaveRelief
        Height of the terrain.
    palette : PaletteBuilder
        Draws material variants.
    builder : GeometryBuilder
        Hands out instance ids and collects parts.
    """

    knobs: CityKnobs
    relief: WaveRelief
    palette: PaletteBuilder
    builder: GeometryBuilder
