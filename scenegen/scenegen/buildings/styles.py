"""How buildings look: wall and roof materials, storey heights, windows, drawn per building."""

from __future__ import annotations

from dataclasses import dataclass, replace
from enum import StrEnum

import numpy as np

from scenegen.materials.palette import MAX_VARIANTS, PaletteBuilder


class Kind(StrEnum):
    """What a building is."""

    HOUSE = "house"
    APARTMENTS = "apartments"
    TERRACE = "terrace"
    OFFICE = "office"
    TOWER = "tower"
    SHED = "shed"


class Roof(StrEnum):
    """Form of a roof."""

    FLAT = "flat"
    GABLE = "gable"
    HIP = "hip"
    MANSARD = "mansard"


@dataclass(frozen=True)
class Style:
    """Materials and proportions of one building.

    Attributes
    ----------
    wall, base, roof, cap, glass, door, metal : int
        Palette indices: walls, shop floors, roof, flat top of a mansard, panes, doors, roof equipment.
    roof_form : Roof
    storey_m, first_storey_m : float
        Floor to floor [m].
    pitch_m : float
        Distance between window columns [m].
    window_share : float
        Window width over pitch.
    sill_m, head_m, first_sill_m, first_head_m : float
        Above the floor [m].
    blank_share : float
        Share of cells without a window.
    parapet_m : float
        Above the flat roof [m].
    recess_m : float
        Depth of reveals [m].
    shops : bool
        Shop fronts along the ground floor.
    balconies : bool
    roof_slope : float
        Rise over run of pitched roofs.
    cold_glass : int or None
        Panes before rooms that nobody heats.
    cold_share : float
        Share of such rooms.
    unit : int or None
        Casings of air handlers, warm where they run; `metal` if None.
    """

    wall: int
    base: int
    roof: int
    cap: int
    glass: int
    door: int
    metal: int
    roof_form: Roof
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
    shops: bool
    balconies: bool
    roof_slope: float
    cold_glass: int | None = None
    cold_share: float = 0.0
    unit: int | None = None


_WALLS = {
    Kind.HOUSE: ("brick_red", "stucco_render", "brick_red", "wood_siding", "stucco_render"),
    Kind.TERRACE: ("brick_red", "stucco_render", "stucco_render", "concrete_wall", "brick_red"),
    Kind.APARTMENTS: ("stucco_render", "concrete_wall", "brick_red", "stucco_render", "concrete_wall"),
    Kind.OFFICE: ("concrete_wall", "concrete_wall", "stucco_render", "brick_red", "concrete_wall"),
    Kind.TOWER: ("concrete_wall", "concrete_wall", "stucco_render", "concrete_wall", "concrete_wall"),
    Kind.SHED: (
        "metal_roof_painted_mid",
        "concrete_wall",
        "brick_red",
        "metal_roof_painted_mid",
        "stucco_render",
    ),
}
_FLAT_ROOFS = ("bitumen_felt_roof", "epdm_black_roof", "white_membrane_roof", "bitumen_felt_roof")
_PITCHED_ROOFS = ("clay_roof_tile", "slate_roof", "asphalt_shingle", "clay_roof_tile")
_SLOPES = {Roof.GABLE: (0.55, 1.0), Roof.HIP: (0.45, 0.8), Roof.MANSARD: (2.0, 2.8), Roof.FLAT: (0.0, 0.0)}


@dataclass(frozen=True)
class Heating:
    """What is heated in a world.

    Attributes
    ----------
    cold_share : float
        Share of rooms nobody heats, in buildings that are heated.
    cold_K : float
        Air temperature there, and in unheated buildings [K].
    cold_sheds, running : float
        Shares of unheated warehouses, and of buildings whose air handlers run.
    """

    cold_share: float
    cold_K: float
    cold_sheds: float
    running: float

    def prepare(self, palette: PaletteBuilder) -> None:
        """Leave room for unheated variants of what may be unheated; before anything else is drawn."""
        for name in ("window_glass", *sorted({*_WALLS[Kind.SHED], *_FLAT_ROOFS})):
            palette.variants(name, MAX_VARIANTS - 1)

    def apply(self, style: Style, kind: Kind, palette: PaletteBuilder, rng: np.random.Generator) -> Style:
        """A style with its heating."""
        cold, runs, warm = rng.uniform(size=3)
        glass = palette.special("window_glass", "unheated", interior_K=self.cold_K)
        unit_K = UNIT_K[0] + warm * (UNIT_K[1] - UNIT_K[0])
        names = [s.material.name for s in palette.surfaces()]

        def unheated(skin: int) -> int:
            return palette.special(names[skin], "unheated", interior_K=self.cold_K)

        unit = (
            palette.special("steel_painted", "air handler", interior_K=unit_K)
            if runs < self.running
            else None
        )
        style = replace(style, cold_glass=glass, cold_share=self.cold_share, unit=unit)
        if kind is not Kind.SHED or cold >= self.cold_sheds:
            return style
        roof = unheated(style.roof) if style.roof_form is Roof.FLAT else style.roof
        return replace(
            style, wall=unheated(style.wall), base=unheated(style.wall), glass=glass, roof=roof, unit=None
        )


UNIT_K = (304.0, 318.0)
"""Air inside the casing of an air handler that runs: exhaust air and the heat of its fans and compressors."""


def draw_style(kind: Kind, form: Roof, palette: PaletteBuilder, rng: np.random.Generator) -> Style:
    """Draw the look of a building of given kind and roof form."""
    modern = kind in (Kind.OFFICE, Kind.TOWER)
    wall = _wall(kind, palette, rng)
    base = palette.pick("concrete_wall", rng) if rng.uniform() < 0.6 else wall
    storey, first = _storeys(kind, rng)
    sill = rng.uniform(0.75, 1.0)
    shops = kind in (Kind.OFFICE, Kind.TERRACE) and rng.uniform() < 0.45
    sloped_shed = kind is Kind.SHED and form is Roof.GABLE
    return Style(
        wall=wall,
        base=base,
        roof=_roof(kind, form, palette, rng),
        cap=palette.pick("bitumen_felt_roof", rng),
        glass=palette.pick("window_glass", rng),
        door=palette.pick("wood_siding", rng),
        metal=palette.pick("metal_galv_weathered", rng),
        roof_form=form,
        storey_m=storey,
        first_storey_m=first,
        pitch_m=rng.uniform(5.0, 7.5) if kind is Kind.SHED else rng.uniform(3.5, 4.8),
        window_share=rng.uniform(0.5, 0.82) if modern else rng.uniform(0.34, 0.52),
        sill_m=sill,
        head_m=min(sill + rng.uniform(1.3, 1.7), storey - 0.4),
        first_sill_m=first - 2.6 if kind is Kind.SHED else sill,
        first_head_m=first - (1.1 if kind is Kind.SHED else 0.7),
        blank_share=rng.uniform(0.3, 0.7) if kind is Kind.SHED else rng.uniform(0.0, 0.12),
        parapet_m=rng.uniform(0.4, 1.0),
        recess_m=rng.uniform(0.08, 0.18),
        shops=shops,
        balconies=kind in (Kind.APARTMENTS, Kind.TOWER) and rng.uniform() < 0.6,
        roof_slope=rng.uniform(0.15, 0.25) if sloped_shed else rng.uniform(*_SLOPES[form]),
    )


def _wall(kind: Kind, palette: PaletteBuilder, rng: np.random.Generator) -> int:
    name = _WALLS[kind][int(rng.integers(5))]
    return palette.pick(name, rng)


def _roof(kind: Kind, form: Roof, palette: PaletteBuilder, rng: np.random.Generator) -> int:
    if kind is Kind.SHED and rng.uniform() < 0.6:
        return palette.pick("metal_roof_painted_mid", rng)
    names = _FLAT_ROOFS if form is Roof.FLAT else _PITCHED_ROOFS
    return palette.pick(names[int(rng.integers(4))], rng)


def _storeys(kind: Kind, rng: np.random.Generator) -> tuple[float, float]:
    """Height of upper storeys and of the ground floor [m]."""
    if kind is Kind.SHED:
        return 5.0, rng.uniform(5.0, 8.5)
    storey = rng.uniform(3.2, 3.8) if kind in (Kind.OFFICE, Kind.TOWER) else rng.uniform(2.8, 3.4)
    return storey, storey + (rng.uniform(0.3, 1.2) if kind is not Kind.HOUSE else 0.0)
