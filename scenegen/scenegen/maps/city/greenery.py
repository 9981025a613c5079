"""Trees in streets, yards and parks."""

from __future__ import annotations

import numpy as np
import shapely

from scenegen.geometry.builder import GeometryBuilder
from scenegen.geometry.part import Part
from scenegen.geometry.placement import along, clear_of, first_come
from scenegen.geometry.relief import WaveRelief
from scenegen.geometry.template import place
from scenegen.geometry.trees import broadleaf, conifer
from scenegen.maps.city.districts import Layout, Use
from scenegen.maps.city.knobs import CityKnobs
from scenegen.maps.city.terrain import KERB_M
from scenegen.materials.palette import PaletteBuilder


def build_trees(
    layout: Layout,
    knobs: CityKnobs,
    relief: WaveRelief,
    palette: PaletteBuilder,
    builder: GeometryBuilder,
    rng: np.random.Generator,
) -> tuple[list[Part], int]:
    """Trees as parts (one per template) and their number."""
    xy, height = _spots(layout, knobs, rng)
    species = rng.choice(6, len(xy), p=[0.24, 0.22, 0.2, 0.16, 0.1, 0.08])
    radius = height * 0.36 * 0.7
    footprints = np.array([b.footprint for b in layout.buildings], dtype=object)
    crowns = shapely.buffer(shapely.points(xy), radius, quad_segs=4)
    keep = clear_of(crowns, footprints, 0.3) & first_come(crowns)
    xy, height, species = xy[keep], height[keep], species[keep]
    first = builder.new_objects(len(xy))
    skins = np.column_stack(
        [[palette.pick("bark_trunk", rng) for _ in range(len(xy))], [palette.pick("tree_crown", rng) for _ in range(len(xy))]]
    )
    position = np.column_stack([xy, relief(xy) + KERB_M])
    heading = rng.uniform(0.0, 2 * np.pi, len(xy))
    wide = rng.uniform(0.85, 1.15, len(xy))
    parts = []
    for k in range(6):
        mine = np.flatnonzero(species == k)
        template = broadleaf(rng) if k < 4 else conifer(rng)
        scale = height[mine, None] * np.column_stack([wide[mine], wide[mine], np.ones(len(mine))])
        parts.append(place(template, position[mine], heading[mine], scale, skins[mine], first + mine))
    return parts, len(xy)


def _spots(layout: Layout, knobs: CityKnobs, rng: np.random.Generator) -> tuple[np.ndarray, np.ndarray]:
    """Candidate places and heights."""
    yard_rate = rng.uniform(*knobs.yard_trees_per_1000_m2)
    park_rate = rng.uniform(*knobs.park_trees_per_1000_m2)
    places, heights = [], []
    for block in layout.blocks:
        if rng.uniform() < 0.7 and block.use is not Use.INDUSTRY:
            line = shapely.get_coordinates(block.outline.buffer(-1.1, join_style="mitre").exterior)
            length = shapely.LineString(line).length
            spots = np.arange(5.0, length - 2.0, rng.uniform(*knobs.street_tree_spacing_m))
            xy, _ = along(line, spots, np.zeros(len(spots)))
            places.append(xy)
            heights.append(rng.uniform(5.5, 9.0, len(xy)))
        rate = park_rate if block.use is Use.PARK else 0.3 * yard_rate if block.use is Use.INDUSTRY else yard_rate
        area = block.yard.buffer(-1.0)
        x0, y0, x1, y1 = area.bounds
        xy = rng.uniform((x0, y0), (x1, y1), (int(rate * (x1 - x0) * (y1 - y0) / 1000), 2))
        xy = xy[shapely.contains_xy(area, xy)]
        places.append(xy)
        heights.append(rng.uniform(6.0, 16.0, len(xy)) if block.use is Use.PARK else rng.uniform(4.5, 11.0, len(xy)))
    return np.concatenate(places), np.concatenate(heights)
