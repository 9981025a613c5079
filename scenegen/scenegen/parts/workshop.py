"""What every subsystem of a world needs at hand while it is built."""

from __future__ import annotations

from dataclasses import dataclass

from scenegen.climate.season import Season
from scenegen.geometry.builder import GeometryBuilder
from scenegen.geometry.relief import Relief
from scenegen.materials.palette import PaletteBuilder


@dataclass(frozen=True, eq=False)
class Workshop:
    """Shared by all parts of one world; maps add their knobs.

    Attributes
    ----------
    relief : callable
        Height of the terrain [m] at plan points (n, 2).
    palette : PaletteBuilder
        Draws material variants.
    builder : GeometryBuilder
        Hands out instance ids and collects parts.
    season : Season
        Decides what is in leaf.
    """

    relief: Relief
    palette: PaletteBuilder
    builder: GeometryBuilder
    season: Season
