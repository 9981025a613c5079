"""Gardens of houses: a lawn, a paved path from the road to the front, a fence on three sides."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
import shapely

from scenegen.buildings.building import Building
from scenegen.classes import Semantic
from scenegen.geometry.ground import Region
from scenegen.geometry.part import Part
from scenegen.maps.coastline.houses import GARDEN_M
from scenegen.maps.coastline.layout import Layout
from scenegen.maps.coastline.relief import ROAD_HALF_M
from scenegen.maps.coastline.workshop import CoastWorkshop
from scenegen.parts.fixtures.fences import fence

_STYLES = ("picket", "rail", "board", "wall")
_FENCED = 0.65


def build_gardens(
    houses: Sequence[Building], layout: Layout, shop: CoastWorkshop, rng: np.random.Generator
) -> tuple[list[Region], list[Part]]:
    """Ground of the gardens, and their fences."""
    lawn = shop.palette.variants("grass_watered")
    paved = shop.palette.pick("concrete_pavement", rng)
    regions, parts = [], []
    for house in houses:
        plot = house.footprint.buffer(GARDEN_M - 0.6, join_style="mitre")
        gate, ring = _towards_road(plot, layout.road)
        skin = lawn[int(rng.integers(len(lawn)))]
        regions.append(Region(plot, skin, int(Semantic.GRASS), shop.builder.new_objects()))
        wall = shapely.get_coordinates(house.footprint.centroid)[0]
        path = shapely.LineString([gate[0], wall]).buffer(0.7, cap_style="flat")
        regions.append(Region(path, paved, int(Semantic.SIDEWALK), shop.builder.new_objects()))
        if rng.uniform() < _FENCED:
            style = _STYLES[int(rng.choice(len(_STYLES), p=(0.35, 0.25, 0.25, 0.15)))]
            parts += fence(ring, style, float(rng.uniform(0.9, 1.3)), shop, rng)
    return regions, parts


def _towards_road(plot: shapely.Polygon, road: shapely.LineString) -> tuple[np.ndarray, np.ndarray]:
    """Edge of the road before a plot and the plot's front; the plot's outline but for its front."""
    middle = plot.centroid
    foot = shapely.get_coordinates(road.interpolate(road.project(middle)))[0]
    ring = shapely.get_coordinates(shapely.orient_polygons(plot).exterior)[:-1]
    sides = (ring + np.roll(ring, -1, axis=0)) / 2
    front = int(np.argmin(np.linalg.norm(sides - foot, axis=1)))
    away = sides[front] - foot
    edge = foot + away * (ROAD_HALF_M - 0.1) / np.linalg.norm(away)
    return np.array([edge, sides[front]]), np.roll(ring, -(front + 1), axis=0)
