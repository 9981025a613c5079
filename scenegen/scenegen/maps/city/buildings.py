"""Buildings as plans: volumes with storeys, materials and a style, before they become geometry."""

from __future__ import annotations

from dataclasses import dataclass, field
from enum import StrEnum

import numpy as np
import shapely

from scenegen.maps.city.footprints import draw_footprint, street_heading
from scenegen.maps.city.lots import largest_rectangle
from scenegen.materials.palette import PaletteBuilder


class Kind(StrEnum):
    """What a building is."""

    HOUSE = "house"
    OFFICE = "office"
    SHED = "shed"
    TOWER = "tower"
    PERIMETER = "perimeter"


@dataclass(frozen=True)
class Style:
    """How the walls of a building look.

    Attributes
    ----------
    wall, roof, glass, door, unit : int
        Palette indices; `unit` is the sheet metal of roof equipment.
    storey_m, first_storey_m : float
    pitch_m : float
        Distance between window columns [m].
    window_share, sill_m, head_m : float
        Window width over pitch; sill and head above the floor [m].
    first_sill_m, first_head_m : float
    blank_share : float
        Share of cells without a window.
    parapet_m : float
    recess_m : float
    """

    wall: int
    roof: int
    glass: int
    door: int
    unit: int
    storey_m: float
    first_storey_m: float
    pitch_m: float
    window_share: float
    sill_m: float
    head_m: float
    first_sill_m: float
    first_head_m: float
    blank_share: float
    parapet_m: float
    recess_m: float


@dataclass(frozen=True, eq=False)
class Volume:
    """A prism with a roof: a building, or one tier of it.

    Attributes
    ----------
    outline : shapely.Polygon
    floor_m : float
        Floor of its lowest storey [m].
    storeys : int
    foundation_m : float
        How far its walls continue below the floor.
    pitched : bool
    """

    outline: shapely.Polygon
    floor_m: float
    storeys: int
    foundation_m: float
    pitched: bool = False
    covered: shapely.Polygon | None = None

    def roof_m(self, style: Style) -> float:
        """Height of the roof [m]."""
        return self.floor_m + style.first_storey_m + (self.storeys - 1) * style.storey_m


@dataclass(frozen=True, eq=False)
class Building:
    """One building: one instance."""

    kind: Kind
    object: int
    style: Style
    volumes: tuple[Volume, ...]
    footprint: shapely.Polygon = field(repr=False)


_WALLS = {
    Kind.HOUSE: ("brick_red", "stucco_render", "brick_red", "wood_siding"),
    Kind.PERIMETER: ("brick_red", "stucco_render", "stucco_render", "limestone_marble"),
    Kind.OFFICE: ("concrete_wall", "concrete_wall", "stucco_render", "brick_red"),
    Kind.TOWER: ("concrete_wall", "concrete_wall", "stucco_render", "concrete_wall"),
    Kind.SHED: ("metal_roof_painted_mid", "concrete_wall", "brick_red", "metal_galv_weathered"),
}
_FLAT_ROOFS = ("bitumen_felt_roof", "epdm_black_roof", "white_membrane_roof", "bitumen_felt_roof")
_PITCHED_ROOFS = ("clay_roof_tile", "slate_roof", "asphalt_shingle", "clay_roof_tile")


def draw_style(kind: Kind, pitched: bool, palette: PaletteBuilder, rng: np.random.Generator) -> Style:
    """Draw materials and proportions for a building."""
    wall = _WALLS[kind][int(rng.integers(4))]
    roofs = _PITCHED_ROOFS if pitched else _FLAT_ROOFS
    roof = "metal_roof_painted_mid" if kind is Kind.SHED and rng.uniform() < 0.6 else roofs[int(rng.integers(4))]
    modern = kind in (Kind.OFFICE, Kind.TOWER)
    storey = rng.uniform(3.0, 3.7) if modern else rng.uniform(2.8, 3.4)
    first = storey + (rng.uniform(0.3, 1.2) if kind is not Kind.HOUSE else 0.0)
    share = rng.uniform(0.55, 0.85) if modern else rng.uniform(0.32, 0.5)
    if kind is Kind.SHED:
        storey, first, share = 5.0, rng.uniform(5.0, 8.0), rng.uniform(0.3, 0.6)
    sill = rng.uniform(0.7, 1.0)
    return Style(
        wall=palette.pick(wall, rng),
        roof=palette.pick(roof, rng),
        glass=palette.pick("window_glass", rng),
        door=palette.pick("wood_siding", rng),
        unit=palette.pick("metal_galv_weathered", rng),
        storey_m=storey,
        first_storey_m=first,
        pitch_m=rng.uniform(3.0, 4.6) if kind is not Kind.SHED else rng.uniform(4.5, 7.0),
        window_share=share,
        sill_m=sill,
        head_m=min(sill + rng.uniform(1.3, 1.7), storey - 0.35),
        first_sill_m=sill if kind is not Kind.SHED else first - 2.2,
        first_head_m=first - rng.uniform(0.6, 0.9),
        blank_share=rng.uniform(0.0, 0.12) if kind is not Kind.SHED else rng.uniform(0.3, 0.7),
        parapet_m=rng.uniform(0.4, 1.1),
        recess_m=rng.uniform(0.08, 0.18),
    )


def plan_building(
    lot: shapely.Polygon, kind: Kind, storeys: int, palette: PaletteBuilder, rng: np.random.Generator
) -> tuple[Style, shapely.Polygon, bool] | None:
    """Choose a footprint and a style for a lot; None where nothing sensible fits."""
    heading = street_heading(lot)
    fit = largest_rectangle(lot.buffer(-1.6, join_style="mitre"), heading, rng.uniform(0.6, 0.9))
    if fit is None:
        return None
    centre, length, width = fit
    if min(length, width) < 6.5:
        return None
    length, width = min(length, rng.uniform(28.0, 60.0)), min(width, rng.uniform(13.0, 34.0))
    pitched = kind is Kind.HOUSE and rng.uniform() < 0.55
    footprint = draw_footprint(centre, length, width, heading, rng)
    return draw_style(kind, pitched, palette, rng), footprint, pitched
