"""Rocks at the foot of cliffs, in the surf and on the beach; stacks off shore; the armour of the breakwater."""

from __future__ import annotations

import numpy as np
import shapely

from scenegen.classes import Semantic
from scenegen.geometry.part import Part
from scenegen.geometry.scatter import hexagonal
from scenegen.geometry.template import place
from scenegen.maps.coastline.boulders import block, boulder
from scenegen.maps.coastline.layout import Layout
from scenegen.maps.coastline.workshop import CoastWorkshop

_SHAPES = 5
_PLAN = 1.12
"""Plan radius of a boulder, in sizes."""

_WAIST = 0.95
"""The same where it meets the ground, on average."""


def build_rocks(rock: str, shop: CoastWorkshop, rng: np.random.Generator) -> tuple[list[Part], np.ndarray]:
    """Rocks as parts, and their footprints: ground below them is never seen.

    Parameters
    ----------
    rock : str
        Material.
    shop : CoastWorkshop
    rng : numpy.random.Generator
    """
    xy, scale = _draw(shop, rng)
    ground = shop.relief(xy)
    radius = np.linalg.norm(scale[:, :2], axis=1) / np.sqrt(2)
    bounds = shapely.buffer(shapely.points(xy), _PLAN * scale[:, :2].max(axis=1), quad_segs=4)
    good = shop.coast.inside(xy, 6.0) & (ground + 0.4 * scale[:, 2] > 0.1)
    good[good] = shop.claims.take(bounds[good], 0.3)
    xy, scale, ground, radius = xy[good], scale[good], ground[good], radius[good]
    count = len(xy)
    owner = shop.builder.new_objects(count) + np.arange(count)
    position = np.column_stack([xy, ground - rng.uniform(0.05, 0.3, count) * scale[:, 2]])
    heading = rng.uniform(0.0, 2 * np.pi, count)
    skins = np.array([[shop.palette.pick(rock, rng)] for _ in range(count)], np.int64).reshape(-1, 1)
    grade = np.digitize(radius, (0.9, 3.0))
    shape = rng.integers(_SHAPES, size=count)
    parts = []
    for splits in range(3):
        for k in range(_SHAPES):
            template = boulder(rng, Semantic.ROCK, splits + 1, 13 + 5 * splits)
            mine = np.flatnonzero((grade == splits) & (shape == k))
            parts.append(
                place(template, position[mine], heading[mine], scale[mine], skins[mine], owner[mine])
            )
    return parts, _footprints(xy, scale, heading)


def _footprints(xy: np.ndarray, scale: np.ndarray, heading: np.ndarray) -> np.ndarray:
    """Ellipses of about the rocks' outline at the ground."""
    turn = 2 * np.pi * np.arange(12) / 12
    c, s = np.cos(heading)[:, None], np.sin(heading)[:, None]
    x, y = scale[:, :1] * np.cos(turn), scale[:, 1:2] * np.sin(turn)
    ring = np.stack([c * x - s * y, s * x + c * y], axis=-1) * _WAIST
    return np.asarray(shapely.polygons(ring + xy[:, None]))


def _draw(shop: CoastWorkshop, rng: np.random.Generator) -> tuple[np.ndarray, np.ndarray]:
    """Plan and half axes of candidates, the largest first."""
    coast = shop.coast
    along = np.arange(-1.4 * coast.half_m, 1.4 * coast.half_m, 2.0)
    share = coast.cliff(along)
    share = np.where(coast.inside(coast.plan(along, 0 * along), 0.0), share, 0.0)
    wanted = rng.uniform(*shop.knobs.rocks_per_100_m) * (2.0 * share.sum() + 8.0) / 100
    weight = (share + 0.02) / (share + 0.02).sum()
    count = int(2.0 * wanted)
    s = along[rng.choice(len(along), count, p=weight)] + rng.uniform(-2.0, 2.0, count)
    size = np.clip(0.35 * (1 - rng.uniform(size=count)) ** -0.62, 0.35, 4.5)
    low, high = -16.0 - 10.0 * rng.uniform(size=count), coast.beach(s) - 0.8 * size
    q = np.where(rng.uniform(size=count) < 0.6, high - rng.exponential(5.0, count), rng.uniform(low, high))
    stacks = int(wanted / 14.0)
    s = np.concatenate([s, along[rng.choice(len(along), stacks, p=weight)]])
    q = np.concatenate([q, -rng.uniform(8.0, 60.0, stacks)])
    size = np.concatenate([size, rng.uniform(2.5, 7.0, stacks)])
    flat = rng.uniform(0.55, 1.0, len(s))
    flat[count:] = rng.uniform(1.2, 2.0, stacks)
    scale = size[:, None] * np.column_stack([np.ones(len(s)), rng.uniform(0.65, 1.0, len(s)), flat])
    order = np.argsort(-size, kind="stable")
    return coast.plan(s, q)[order], scale[order]


def build_armour(
    layout: Layout, rock: str, owner: int, shop: CoastWorkshop, rng: np.random.Generator
) -> list[Part]:
    """Rocks or concrete blocks on both slopes of the breakwater and around its head: one object with its core."""
    mound = layout.mound
    cubes = rng.uniform() < 0.5
    size = rng.uniform(0.75, 0.95) if cubes else rng.uniform(0.85, 1.25)
    reach = mound.half_m + (mound.crown_m + 1.2) / mound.slope
    x0, y0, x1, y1 = mound.line.buffer(reach).bounds
    xy = hexagonal(x0, y0, x1, y1, 1.72 * size, rng, 0.12)
    distance = shapely.distance(shapely.points(xy), mound.line)
    xy = xy[(distance > mound.half_m + 0.62 * size) & (distance < reach)]
    ground, natural = shop.relief(xy), shop.unbuilt(xy)
    xy, ground = xy[ground > natural + 0.3], ground[ground > natural + 0.3]
    count = len(xy)
    name = "concrete_pavement" if cubes else rock
    skins = np.array([[shop.palette.pick(name, rng)] for _ in range(count)], np.int64).reshape(-1, 1)
    position = np.column_stack([xy, ground + 0.18 * size])
    scale = (
        size * rng.uniform(0.88, 1.1, (count, 1)) * np.ones(3) * np.array([1.0, 1.0, 1.0 if cubes else 0.85])
    )
    heading, shape = rng.uniform(0.0, 2 * np.pi, count), rng.integers(_SHAPES, size=count)
    parts = []
    for k in range(_SHAPES):
        mine = np.flatnonzero(shape == k)
        template = block(rng, Semantic.BARRIER) if cubes else boulder(rng, Semantic.BARRIER, 1)
        objects = np.full(len(mine), owner)
        parts.append(place(template, position[mine], heading[mine], scale[mine], skins[mine], objects))
    return parts
