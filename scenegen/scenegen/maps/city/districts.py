"""What each block is used for, and the buildings that follow from it."""

from __future__ import annotations

from dataclasses import dataclass
from enum import StrEnum

import numpy as np
import shapely

from scenegen.geometry.builder import GeometryBuilder
from scenegen.geometry.relief import WaveRelief
from scenegen.maps.city.buildings import Building, Kind, Volume, draw_style, plan_building
from scenegen.maps.city.knobs import CityKnobs
from scenegen.maps.city.lots import divide_lots
from scenegen.maps.city.streets import StreetPlan
from scenegen.materials.palette import PaletteBuilder

_MITRE = {"join_style": "mitre"}
_DEPTH_BELOW_M = 0.8


class Use(StrEnum):
    """Use of a block."""

    HOMES = "homes"
    OFFICES = "offices"
    PERIMETER = "perimeter"
    INDUSTRY = "industry"
    PARK = "park"


@dataclass(frozen=True, eq=False)
class Block:
    """A block and what lies on it.

    Attributes
    ----------
    outline, yard : shapely.Polygon
        Kerb line; the part behind the sidewalk.
    use : Use
    open_lots : tuple of shapely.Polygon
        Lots without a building.
    """

    outline: shapely.Polygon
    yard: shapely.Polygon
    use: Use
    open_lots: tuple[shapely.Polygon, ...]


@dataclass(frozen=True, eq=False)
class Layout:
    """Blocks and buildings of a city."""

    blocks: tuple[Block, ...]
    buildings: tuple[Building, ...]


def lay_out(
    plan: StreetPlan,
    knobs: CityKnobs,
    relief: WaveRelief,
    palette: PaletteBuilder,
    builder: GeometryBuilder,
    rng: np.random.Generator,
) -> Layout:
    """Give each block a use and put buildings on it."""
    uses = _uses(plan, knobs, rng)
    density = rng.uniform(*knobs.building_density)
    tower_share = rng.uniform(*knobs.tower_share)
    blocks, buildings = [], []
    for outline, use in zip(plan.blocks, uses, strict=True):
        child = rng.spawn(1)[0]
        yard = _yard(outline, child.uniform(2.6, 4.2))
        open_lots: list[shapely.Polygon] = []
        if use is not Use.PARK:
            for lot in divide_lots(yard, _LOT_AREA[use], child):
                built = None
                if child.uniform() < density:
                    built = _build(lot, use, tower_share, knobs, relief, palette, builder, child)
                if built is None:
                    open_lots.append(lot)
                else:
                    buildings.append(built)
        blocks.append(Block(outline, yard, use, tuple(open_lots)))
    return Layout(tuple(blocks), tuple(buildings))


_LOT_AREA = {
    Use.HOMES: (420.0, 800.0),
    Use.OFFICES: (700.0, 1500.0),
    Use.PERIMETER: (600.0, 1100.0),
    Use.INDUSTRY: (1300.0, 2600.0),
}


def _yard(outline: shapely.Polygon, sidewalk_m: float) -> shapely.Polygon:
    inner = outline.buffer(-sidewalk_m, **_MITRE)
    pieces = list(getattr(inner, "geoms", [inner]))
    return max(pieces, key=lambda p: p.area).simplify(0.1)


def _uses(plan: StreetPlan, knobs: CityKnobs, rng: np.random.Generator) -> list[Use]:
    """Parks first (a middle-sized block near the centre), then industry towards one side, offices near the centre."""
    centre = np.array([shapely.get_coordinates(b.centroid)[0] for b in plan.blocks])
    area = np.array([b.area for b in plan.blocks])
    reach = np.linalg.norm(centre, axis=1) / np.sqrt(plan.outline.area)
    wanted = rng.uniform(*knobs.park_area_share) * plan.outline.area
    uses: list[Use | None] = [None] * len(area)
    for k in np.argsort(reach + rng.uniform(0.0, 0.5, len(area)) - area / 3e4):
        if wanted <= 0:
            break
        uses[k] = Use.PARK
        wanted -= area[k]
    heading = rng.uniform(0.0, 2 * np.pi)
    side = centre @ np.array([np.cos(heading), np.sin(heading)])
    quarter = np.quantile(side, 1 - rng.uniform(*knobs.industry_share))
    for k, use in enumerate(uses):
        if use is None and side[k] > quarter:
            uses[k] = Use.INDUSTRY
        elif use is None:
            near = reach[k] + rng.normal(0.0, 0.12) < 0.25
            uses[k] = Use.OFFICES if near else Use.HOMES
    return [u for u in uses if u is not None]


def _build(
    lot: shapely.Polygon,
    use: Use,
    tower_share: float,
    knobs: CityKnobs,
    relief: WaveRelief,
    palette: PaletteBuilder,
    builder: GeometryBuilder,
    rng: np.random.Generator,
) -> Building | None:
    kind = {Use.HOMES: Kind.HOUSE, Use.OFFICES: Kind.OFFICE, Use.INDUSTRY: Kind.SHED}.get(use, Kind.OFFICE)
    storeys = 1 if kind is Kind.SHED else round(rng.uniform(*knobs.storeys))
    planned = plan_building(lot, kind, storeys, palette, rng)
    if planned is None:
        return None
    style, footprint, _ = planned
    floor, depth = _stand(footprint, relief)
    volumes = [Volume(footprint, floor, storeys, depth)]
    if kind is Kind.OFFICE and rng.uniform() < 3 * tower_share:
        core = footprint.buffer(-rng.uniform(3.0, 5.0), **_MITRE)
        if core.geom_type == "Polygon" and core.area > 180.0 and core.buffer(-5.0).area > 10.0:
            kind = Kind.TOWER
            style = draw_style(kind, False, palette, rng)
            podium = Volume(footprint, floor, 2, depth, covered=core)
            tower = Volume(core, podium.roof_m(style), round(rng.uniform(*knobs.tower_storeys)) - 2, 0.05)
            volumes = [podium, tower]
    return Building(kind, builder.new_objects(), style, tuple(volumes), footprint)


def _stand(footprint: shapely.Polygon, relief: WaveRelief) -> tuple[float, float]:
    """Floor height (just above the highest ground at the walls) and the depth of the foundation below it."""
    ground = relief(shapely.get_coordinates(shapely.segmentize(footprint.exterior, 4.0)))
    floor = float(ground.max()) + 0.12 + 0.06
    return floor, floor - float(ground.min()) + _DEPTH_BELOW_M
