"""From a lot or a sector of a perimeter block to a building: kind, size, storeys, roof, tiers."""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np
import shapely

from scenegen.buildings.building import Building, Volume, Wish, fit_footprint, outline_of, rings_of
from scenegen.buildings.lots import Lot
from scenegen.buildings.styles import Heating, Kind, Roof, Style, draw_style
from scenegen.climate.climatology import normals
from scenegen.maps.city.uses import Use
from scenegen.maps.city.workshop import CityWorkshop

_BELOW_GROUND_M = 0.8
_KERB_AND_STEP_M = 0.18
_SMALLEST_TIER_M2 = 110.0
_STUFFY_K, _FROST_FREE_K = 2.0, 278.0
"""Unheated rooms are warmer than the mean of the outdoor air by so much, and never colder than this."""

_WISHES = {
    Kind.HOUSE: Wish((9.0, 15.0), (8.5, 11.5), (1.5, 5.0), 1.3, shaped=False),
    Kind.APARTMENTS: Wish((18.0, 46.0), (11.0, 17.0), (1.0, 7.0), 2.2, shaped=True),
    Kind.OFFICE: Wish((22.0, 52.0), (16.0, 38.0), (1.2, 4.5), 2.0, shaped=True),
    Kind.TOWER: Wish((24.0, 44.0), (22.0, 36.0), (1.2, 5.0), 2.0, shaped=False),
    Kind.SHED: Wish((24.0, 60.0), (18.0, 42.0), (4.0, 10.0), 2.5, shaped=False),
}


@dataclass(frozen=True, eq=False)
class Constructor:
    """What all buildings of a world have in common.

    Attributes
    ----------
    shop : CityWorkshop
    tower_share, terrace_storeys, setback_share : float
        Of this world: share of towers on estates; mean storeys of perimeter blocks; share of flat-roofed buildings
        of four storeys or more whose upper storeys step back.
    heating : Heating
    """

    shop: CityWorkshop
    tower_share: float
    terrace_storeys: float
    setback_share: float
    heating: Heating

    @staticmethod
    def draw(shop: CityWorkshop, rng: np.random.Generator) -> Constructor:
        """Draw the world's own values from the knobs."""
        knobs = shop.knobs
        low, high = knobs.storeys
        spans = (
            knobs.tower_share, (0.5 * (low + high), high), knobs.setback_share, knobs.unheated_share,
            knobs.unheated_warehouse_share, knobs.running_units_share,
        )  # fmt: skip
        towers, storeys, setbacks, cold, sheds, running = (float(rng.uniform(*span)) for span in spans)
        room_K = max(normals(shop.season).expected_C + 273.15 + _STUFFY_K, _FROST_FREE_K)
        heating = Heating(cold, room_K, sheds, running)
        heating.prepare(shop.palette)
        return Constructor(shop, towers, storeys, setbacks, heating)

    def on_lot(self, lot: Lot, use: Use, rng: np.random.Generator) -> Building | None:
        """A detached building, or None where nothing sensible fits."""
        kind = self._kind(use, rng)
        fit = fit_footprint(lot, _WISHES[kind], rng)
        if fit is None and kind in (Kind.TOWER, Kind.OFFICE):
            kind = Kind.APARTMENTS
            fit = fit_footprint(lot, _WISHES[kind], rng)
        if fit is None:
            return None
        rings, front = fit
        form = _form(kind, rings, rng)
        style = self._style(kind, form, rng)
        storeys = self._storeys(kind, rng)
        floor, depth = self._stand(rings)
        volumes: tuple[Volume, ...] = (Volume(rings, floor, storeys, depth, form),)
        if kind is Kind.TOWER:
            volumes = self._tower(volumes[0], style, rng)
        elif kind in (Kind.OFFICE, Kind.APARTMENTS):
            volumes = self._stepped(volumes[0], style, rng)
        return Building(kind, self.shop.builder.new_objects(), style, volumes, outline_of(rings), front)

    def terrace(self, sector: shapely.Polygon, rng: np.random.Generator) -> Building:
        """A building of a perimeter block, wall to wall with its neighbours."""
        form = Roof.MANSARD if rng.uniform() < 0.45 else Roof.FLAT
        style = self._style(Kind.TERRACE, form, rng)
        storeys = max(2, round(rng.normal(self.terrace_storeys, 0.9)) - (form is Roof.MANSARD))
        rings = rings_of(sector)
        floor, depth = self._stand(rings)
        volumes = self._stepped(Volume(rings, floor, storeys, depth, form), style, rng)
        return Building(Kind.TERRACE, self.shop.builder.new_objects(), style, volumes, sector)

    def _style(self, kind: Kind, form: Roof, rng: np.random.Generator) -> Style:
        style = draw_style(kind, form, self.shop.palette, rng)
        return self.heating.apply(style, kind, self.shop.palette, rng)

    def _kind(self, use: Use, rng: np.random.Generator) -> Kind:
        choice = rng.uniform()
        if use is Use.INDUSTRY:
            return Kind.SHED if choice < 0.8 else Kind.OFFICE
        if use is Use.OFFICES:
            return Kind.TOWER if choice < 4 * self.tower_share else Kind.OFFICE
        if use is Use.ESTATE:
            return Kind.TOWER if choice < self.tower_share else Kind.APARTMENTS
        return Kind.HOUSE if choice < 0.88 else Kind.APARTMENTS

    def _storeys(self, kind: Kind, rng: np.random.Generator) -> int:
        low, high = self.shop.knobs.storeys
        if kind is Kind.SHED:
            return 1
        if kind is Kind.HOUSE:
            return int(rng.choice([1, 2, 2, 3]))
        return max(2, round(rng.uniform(low, high) + (1.0 if kind is Kind.OFFICE else 0.0)))

    def _tower(self, base: Volume, style: Style, rng: np.random.Generator) -> tuple[Volume, ...]:
        """Split a footprint into a podium of two storeys and a slimmer shaft."""
        storeys = round(rng.uniform(*self.shop.knobs.tower_storeys))
        whole = replace(base, storeys=storeys, form=Roof.FLAT)
        inset_m, plain = rng.uniform(2.5, 4.5), rng.uniform() < 0.2
        return (whole,) if plain else _tiers(whole, style, 2, inset_m)

    def _stepped(self, base: Volume, style: Style, rng: np.random.Generator) -> tuple[Volume, ...]:
        """Set the uppermost storeys back, perhaps."""
        inset_m, chance, upper = rng.uniform(1.8, 3.2), rng.uniform(), int(rng.integers(1, 3))
        if (
            base.form is not Roof.FLAT
            or base.storeys < 4
            or len(base.rings) > 1
            or chance >= self.setback_share
        ):
            return (base,)
        return _tiers(base, style, base.storeys - upper, inset_m)

    def _stand(self, rings: tuple[np.ndarray, ...]) -> tuple[float, float]:
        """Floor height just above the highest ground at the walls, and the depth of the foundation."""
        outline = shapely.segmentize(shapely.Polygon(rings[0]).exterior, 4.0)
        ground = self.shop.relief(shapely.get_coordinates(outline))
        floor = float(ground.max()) + _KERB_AND_STEP_M
        return floor, floor - float(ground.min()) + _BELOW_GROUND_M


def _tiers(base: Volume, style: Style, lower: int, inset_m: float) -> tuple[Volume, ...]:
    """A volume in two tiers, the upper one set back on all sides; in one where too little would be left."""
    core = outline_of(base.rings).buffer(-inset_m, join_style="mitre")
    if core.geom_type != "Polygon" or core.area < _SMALLEST_TIER_M2 or base.storeys <= lower:
        return (base,)
    level = base.floor_m + style.first_storey_m + (lower - 1) * style.storey_m
    return (
        replace(base, storeys=lower, covered=core),
        Volume(rings_of(core), level, base.storeys - lower, 0.05, Roof.FLAT),
    )


def _form(kind: Kind, rings: tuple[np.ndarray, ...], rng: np.random.Generator) -> Roof:
    """Pitched roofs on plain houses and some sheds, flat ones elsewhere."""
    choice = rng.uniform()
    if len(rings) > 1 or len(rings[0]) != 4:
        return Roof.FLAT
    if kind is Kind.HOUSE:
        return Roof.GABLE if choice < 0.55 else Roof.HIP if choice < 0.8 else Roof.FLAT
    if kind is Kind.SHED:
        return Roof.GABLE if choice < 0.55 else Roof.FLAT
    if kind is Kind.APARTMENTS:
        return Roof.GABLE if choice < 0.2 else Roof.HIP if choice < 0.4 else Roof.FLAT
    return Roof.FLAT
