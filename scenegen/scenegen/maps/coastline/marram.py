"""Marram grass: tufts of thin arching blades on the dunes."""

from __future__ import annotations

import numpy as np
import shapely
from scipy.spatial import cKDTree

from scenegen.classes import Semantic
from scenegen.geometry.modelling import Modeller
from scenegen.geometry.part import LUMP_STANDOFF_M, Part
from scenegen.geometry.template import Template, place
from scenegen.maps.coastline.workshop import CoastWorkshop

_SHAPES = 4
_BESIDE_M = 0.75


def tuft(rng: np.random.Generator, blades: int = 13) -> Template:
    """A tuft of unit height on z = 0. Slot: 0."""
    model = Modeller()
    turn = 2 * np.pi * (np.arange(blades) + rng.uniform(-0.4, 0.4, blades)) / blades
    lean, tall, wide = (rng.uniform(a, b, blades) for a, b in ((0.2, 0.75), (0.6, 1.0), (0.03, 0.055)))
    out = np.column_stack([np.cos(turn), np.sin(turn), np.zeros(blades)])
    across = np.column_stack([-np.sin(turn), np.cos(turn), np.zeros(blades)]) * wide[:, None]
    up = np.array([0.0, 0.0, 1.0])
    foot = 0.08 * out - 0.06 * up
    knee = 0.08 * out + 0.35 * lean[:, None] * out + 0.62 * tall[:, None] * up
    tip = 0.08 * out + lean[:, None] * out + (tall - 0.28 * lean**2)[:, None] * up
    points = np.stack([foot - across, foot + across, knee + 0.8 * across, knee - 0.8 * across, tip], axis=1)
    base = 5 * np.arange(blades)[:, None, None]
    faces = (base + np.array([[0, 1, 2], [0, 2, 3], [3, 2, 4]])).reshape(-1, 3)
    site = model.site(np.array([0, 0, 0.8]), np.array([0, 0, 1.0]), LUMP_STANDOFF_M)
    model.mesh(points.reshape(-1, 3), faces, 0, Semantic.GRASS, np.full(faces.shape, site))
    return model.finish()


def build_marram(ground: Part, shop: CoastWorkshop, rng: np.random.Generator) -> list[Part]:
    """Tufts on dunes, thicker on their backs; all of them are one piece of vegetation.

    None stands on a site of the ground: that would lie in its shade and darken metres of sand around it.
    """
    coast = shop.coast
    rate = rng.uniform(*shop.knobs.tufts_per_1000_m2) / 1000.0
    along = np.arange(-1.4 * coast.half_m, 1.4 * coast.half_m, 2.0)
    depth = np.maximum(coast.back(along) + 12.0 - coast.beach(along), 0.0) * (coast.cliff(along) < 0.5)
    count = rng.poisson(2.0 * rate * depth)
    s = np.repeat(along, count) + rng.uniform(0.0, 2.0, count.sum())
    share = rng.uniform(size=len(s)) ** 0.75
    q = coast.beach(s) + 1.0 + share * (coast.back(s) + 12.0 - coast.beach(s))
    clump = np.sin(s / 7.3) + np.sin(q / 5.1 + s / 23.0) + np.sin(s / 3.1 - q / 4.2)
    xy = coast.plan(s, q)
    keep = coast.inside(xy, 1.0) & (clump > 0.6 - 2.0 * share) & shop.claims.free(shapely.points(xy), 0.35)
    xy = xy[keep]
    beside, _ = cKDTree(ground.site_position[:, :2]).query(xy)
    xy = xy[beside > _BESIDE_M]
    size = rng.uniform(0.45, 1.0, len(xy))
    position = np.column_stack([xy, shop.relief(xy)])
    skin, owner = shop.palette.pick("grass_dry", rng), shop.builder.new_objects()
    kind, heading = rng.integers(_SHAPES, size=len(xy)), rng.uniform(0.0, 2 * np.pi, len(xy))
    parts = []
    for k in range(_SHAPES):
        mine = np.flatnonzero(kind == k)
        scale = size[mine, None] * np.array([0.9, 0.9, 1.0])
        skins, objects = np.full((len(mine), 1), skin), np.full(len(mine), owner)
        parts.append(place(tuft(rng), position[mine], heading[mine], scale, skins, objects))
    return parts
