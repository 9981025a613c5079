"""The ground plan of the city: far land, streets, sidewalks, yards, parks, and holes under buildings."""

from __future__ import annotations

import numpy as np
import shapely

from scenegen.classes import Semantic
from scenegen.geometry.builder import GeometryBuilder
from scenegen.geometry.ground import Region, drape
from scenegen.geometry.part import Part
from scenegen.geometry.planar import triangulate
from scenegen.geometry.relief import WaveRelief
from scenegen.geometry.scatter import graded_points
from scenegen.maps.city.districts import Layout, Use
from scenegen.maps.city.streets import StreetPlan
from scenegen.materials.palette import PaletteBuilder

KERB_M = 0.12
FAR_M = 2600.0
_TUCK_M = 0.01


def build_terrain(
    plan: StreetPlan,
    layout: Layout,
    relief: WaveRelief,
    palette: PaletteBuilder,
    builder: GeometryBuilder,
    rng: np.random.Generator,
) -> Part:
    """All ground, from the middle of the city to the far edge."""
    road, land = builder.new_objects(), builder.new_objects()
    asphalt = palette.pick("asphalt_aged", rng)
    far = shapely.box(-FAR_M, -FAR_M, FAR_M, FAR_M)
    regions = [
        Region(far, palette.pick("grass_dry", rng), int(Semantic.GRASS), land),
        Region(plan.outline, asphalt, int(Semantic.ROAD), road),
    ]
    for block in layout.blocks:
        sidewalk = builder.new_objects()
        pavement = palette.pick("concrete_pavement", rng)
        regions.append(Region(block.outline, pavement, int(Semantic.SIDEWALK), sidewalk, KERB_M))
        surface, semantic = _yard_surface(block.use, palette, rng)
        regions.append(Region(block.yard, surface, semantic, builder.new_objects(), KERB_M))
    holes = shapely.union_all([b.footprint for b in layout.buildings]).buffer(-_TUCK_M, join_style="mitre")
    regions += [Region(p, asphalt, 0, road, hole=True) for p in getattr(holes, "geoms", [holes])]
    outlines = [r.outline for r in regions]
    half = np.sqrt(plan.outline.area) / 2
    points = graded_points(half + 10.0, FAR_M, 2.4, rng)
    return drape(triangulate(outlines, points, 2.0, (half * 1.2, 0.06)), regions, relief)


def _yard_surface(use: Use, palette: PaletteBuilder, rng: np.random.Generator) -> tuple[int, int]:
    if use is Use.INDUSTRY:
        return palette.pick("asphalt_aged", rng), int(Semantic.ROAD)
    if use is Use.OFFICES:
        return palette.pick("concrete_pavement", rng), int(Semantic.SIDEWALK)
    lawn = "grass_watered" if rng.uniform() < 0.6 else "grass_dry"
    return palette.pick(lawn, rng), int(Semantic.GRASS)
