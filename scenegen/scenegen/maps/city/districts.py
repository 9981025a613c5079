"""What each block is used for, and the buildings that follow from it."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import shapely

from scenegen.buildings.building import Building
from scenegen.buildings.lots import Lot, divide_lots, perimeter_sectors, row_lots
from scenegen.maps.city.construction import Constructor
from scenegen.maps.city.streets import StreetPlan
from scenegen.maps.city.uses import LOT_AREA_M2, Use, assign_uses
from scenegen.maps.city.workshop import CityWorkshop

_CAR_PARK_SHARE = {Use.ESTATE: 0.6, Use.OFFICES: 0.6, Use.INDUSTRY: 1.0}


@dataclass(frozen=True, eq=False)
class Block:
    """A block and what lies on it.

    Attributes
    ----------
    outline, yard : shapely.Polygon
        Kerb line; the part behind the sidewalk.
    use : Use
    lots : tuple of Lot
        All lots; empty for parks and perimeter blocks.
    open_lots : tuple of Lot
        Those without a building.
    car_parks : tuple of Lot
        Open lots paved for cars.
    """

    outline: shapely.Polygon
    yard: shapely.Polygon
    use: Use
    lots: tuple[Lot, ...]
    open_lots: tuple[Lot, ...]
    car_parks: tuple[Lot, ...]


@dataclass(frozen=True, eq=False)
class Layout:
    """Blocks and buildings of a city."""

    blocks: tuple[Block, ...]
    buildings: tuple[Building, ...]


def lay_out(
    plan: StreetPlan,
    shop: CityWorkshop,
    rng: np.random.Generator,
) -> Layout:
    """Give each block a use and put buildings on it."""
    uses = assign_uses(plan, shop.knobs, rng)
    density = rng.uniform(*shop.knobs.building_density)
    constructor = Constructor.draw(shop, rng)
    blocks: list[Block] = []
    buildings: list[Building] = []
    for outline, use in zip(plan.blocks, uses, strict=True):
        child = rng.spawn(1)[0]
        yard = _yard(outline, child.uniform(2.6, 4.2))
        block, built = _fill(outline, yard, use, density, constructor, child)
        blocks.append(block)
        buildings += built
    return Layout(tuple(blocks), tuple(buildings))


def _fill(
    outline: shapely.Polygon,
    yard: shapely.Polygon,
    use: Use,
    density: float,
    constructor: Constructor,
    rng: np.random.Generator,
) -> tuple[Block, list[Building]]:
    if use is Use.PARK:
        return Block(outline, yard, use, (), (), ()), []
    if use is Use.PERIMETER:
        sectors = perimeter_sectors(yard, rng.uniform(11.5, 13.5), (15.0, 27.0), rng)
        if len(sectors) >= 4:
            chosen = [s for s in sectors if rng.uniform() < 0.93]
            return Block(outline, yard, use, (), (), ()), [constructor.terrace(s, rng) for s in chosen]
        use = Use.ESTATE
    homes = use is Use.HOMES
    lots = row_lots(yard, (13.5, 21.0), rng) if homes else divide_lots(yard, LOT_AREA_M2[use], rng)
    built: list[Building] = []
    empty: list[Lot] = []
    for lot in lots:
        wanted = lot.frontage_m > 8.0 and rng.uniform() < density
        building = constructor.on_lot(lot, use, rng) if wanted else None
        if building is None:
            empty.append(lot)
        else:
            built.append(building)
    share = _CAR_PARK_SHARE.get(use, 0.0)
    paved = tuple(
        lot for lot in empty if lot.frontage_m > 8.0 and lot.area.area > 250.0 and rng.uniform() < share
    )
    return Block(outline, yard, use, tuple(lots), tuple(empty), paved), built


def _yard(outline: shapely.Polygon, sidewalk_m: float) -> shapely.Polygon:
    inner = outline.buffer(-sidewalk_m, join_style="mitre")
    pieces = list(getattr(inner, "geoms", [inner]))
    return max(pieces, key=lambda p: p.area).simplify(0.1)
