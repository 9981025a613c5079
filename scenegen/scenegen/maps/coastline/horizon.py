"""Beyond the detailed square: farmhouses and groves on the hills, islets in the sea."""

from __future__ import annotations

import numpy as np
import shapely

from scenegen.classes import Semantic
from scenegen.geometry.part import Part
from scenegen.geometry.placement import first_come, rectangles
from scenegen.geometry.standing import mesh_slopes
from scenegen.geometry.template import place
from scenegen.maps.coastline.boulders import boulder
from scenegen.maps.coastline.huts import hut
from scenegen.maps.coastline.workshop import CoastWorkshop
from scenegen.parts.vegetation.grove import grove

_NEAREST_M, _REACH_M = 30.0, 4200.0
_GROVES, _FARMS = 420, 150
_CROWNS = 4
"""Of a grove."""
_STEEPEST = 0.3
"""Slope up to which a farm is built [m/m]."""


def build_horizon(rock: str, ground: Part, shop: CoastWorkshop, rng: np.random.Generator) -> list[Part]:
    """Everything beyond the detailed square but ground and sea.

    Parameters
    ----------
    rock : str
        Material of this coast's rock.
    ground : Part
        Its triangles are large out there: things stand on them, not on the relief.
    shop : CoastWorkshop
    rng : numpy.random.Generator
    """
    land_rng, islet_rng = rng.spawn(2)
    xy, built, size, heading = _spots(shop, land_rng)
    corners = ground.vertices[ground.faces]
    beyond = np.abs(corners[..., :2]).max(axis=(1, 2)) > shop.coast.half_m
    height, slope = mesh_slopes(corners[beyond], xy)
    farm, wood = built & (slope < _STEEPEST), ~built & np.isfinite(slope)
    foot = np.column_stack([xy, height])
    return [
        _farms(foot[farm], size[farm], heading[farm], shop, land_rng),
        _groves(foot[wood], size[wood], shop, land_rng),
        *_islets(rock, shop, islet_rng),
    ]


def _spots(
    shop: CoastWorkshop, rng: np.random.Generator
) -> tuple[np.ndarray, np.ndarray, np.ndarray, np.ndarray]:
    """Plan, kind, size and heading of farmhouses and groves, denser towards the coast."""
    coast, count = shop.coast, 2 * (_GROVES + _FARMS)
    built = np.arange(count) % (_GROVES + _FARMS) < _FARMS
    s = rng.uniform(-1.0, 1.0, count) ** 3 * _REACH_M
    behind = 25.0 + _REACH_M * rng.uniform(0.0, 1.0, count) ** 2.2
    xy = coast.frame.world(np.column_stack([s, coast.road(s) + behind]))
    size = np.where(built, rng.uniform(3.2, 5.0, count), rng.uniform(14.0, 42.0, count))
    heading = coast.frame.heading_rad + 0.5 * np.pi * rng.integers(0, 4, count) + rng.normal(0.0, 0.2, count)
    across = np.where(built, 3.6 * size, 1.3 * size)
    shapes = rectangles(xy, across, across, heading)
    outside = np.abs(xy).max(axis=1) > coast.half_m + _NEAREST_M + across
    chosen = np.flatnonzero(outside & shop.claims.free(shapes, 8.0))
    chosen = chosen[first_come(shapes[chosen])]
    return xy[chosen], built[chosen], size[chosen], heading[chosen]


def _farms(
    foot: np.ndarray, size: np.ndarray, heading: np.ndarray, shop: CoastWorkshop, rng: np.random.Generator
) -> Part:
    walls = [*shop.palette.variants("stucco_render"), *shop.palette.variants("brick_red")]
    roofs = shop.palette.variants("clay_roof_tile")
    wood, glass = shop.palette.variants("timber_weathered"), shop.palette.variants("window_glass")
    skins = np.array(
        [[k[int(rng.integers(len(k)))] for k in (walls, roofs, wood, glass)] for _ in range(len(foot))],
        np.int64,
    ).reshape(-1, 4)
    owner = shop.builder.new_objects(len(foot)) + np.arange(len(foot))
    scale = size[:, None] * np.array([1.0, 1.0, 0.75])
    return place(hut(), foot, heading, scale, skins, owner)


def _groves(foot: np.ndarray, size: np.ndarray, shop: CoastWorkshop, rng: np.random.Generator) -> Part:
    leaves = np.array(shop.palette.variants("tree_crown"), np.int64)
    skins = leaves[rng.integers(len(leaves), size=len(foot))][:, None]
    owner = shop.builder.new_objects(len(foot)) + np.arange(len(foot))
    template = grove(rng, _CROWNS)
    scale = np.column_stack([size, size, rng.uniform(9.0, 15.0, len(foot))])
    return place(template, foot, rng.uniform(0.0, 2 * np.pi, len(foot)), scale, skins, owner)


def _islets(rock: str, shop: CoastWorkshop, rng: np.random.Generator) -> list[Part]:
    """A few rocky islets one to five kilometres out."""
    coast, count = shop.coast, int(rng.integers(1, 6))
    s = rng.uniform(-3500.0, 3500.0, count)
    xy = coast.plan(s, -coast.half_m * 1.6 - rng.uniform(300.0, 4200.0, count))
    wide = rng.uniform(25.0, 150.0, count)
    free = first_come(shapely.buffer(shapely.points(xy), 1.5 * wide))
    free &= np.abs(xy).max(axis=1) > coast.half_m + 2.0 * wide
    xy, wide = xy[free], wide[free]
    count = len(xy)
    scale = np.column_stack([wide, wide * rng.uniform(0.4, 0.9, count), wide * rng.uniform(0.15, 0.4, count)])
    skins = np.full((count, 1), shop.palette.pick(rock, rng))
    owner = shop.builder.new_objects(count) + np.arange(count)
    position = np.column_stack([xy, np.full(count, -1.0)])
    heading = rng.uniform(0.0, 2 * np.pi, count)
    parts = []
    for k in range(count):
        shape, one = boulder(rng, Semantic.ROCK, 3, 26), slice(k, k + 1)
        parts.append(place(shape, position[one], heading[one], scale[one], skins[one], owner[one]))
    return parts
