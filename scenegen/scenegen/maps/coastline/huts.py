"""Huts at the head of the beach: plank walls, a gable roof, a door; and the wooden cabin on the pier's head."""

from __future__ import annotations

import numpy as np
from jaxtyping import Float64

from scenegen.classes import Semantic
from scenegen.geometry.modelling import Modeller
from scenegen.geometry.part import Part
from scenegen.geometry.placement import rectangles
from scenegen.geometry.relief import slopes
from scenegen.geometry.template import Template, place
from scenegen.maps.coastline.workshop import CoastWorkshop

WALL, ROOF, DOOR, GLASS = 0, 1, 2, 3
"""Surface slots of a hut."""

_SINK_M = 0.7


def hut(length_m: float = 3.0, width_m: float = 2.4, eaves_m: float = 2.1, ridge_m: float = 2.9) -> Template:
    """A hut on z = 0, gable and door towards +x; its walls reach into the sand."""
    model, x, y = Modeller(), length_m / 2, width_m / 2
    model.box((-x, -y, -_SINK_M), (x, y, eaves_m), WALL, Semantic.WALL, covered=True)
    for side in (-1.0, 1.0):
        base = np.array(
            [[x * side, -y * side, eaves_m], [x * side, y * side, eaves_m], [x * side, 0, ridge_m]]
        )
        model.quads(np.concatenate([base, base[2:]])[None], WALL, Semantic.WALL)
    out, slope = 0.22, (ridge_m - eaves_m) / y
    lip, edge = eaves_m - slope * out, x + 0.25
    for side in (-1.0, 1.0):
        low, high = [side * (y + out), lip], [0.0, ridge_m]
        quad = np.array([[edge, *low], [edge, *high], [-edge, *high], [-edge, *low]])
        quad = quad if side > 0 else quad[::-1]
        model.quads(quad[None] + np.array([0, 0, 0.07]), ROOF, Semantic.ROOF)
        model.quads(quad[None, ::-1], ROOF, Semantic.ROOF)
        rim = [[quad[k], quad[(k + 1) % 4]] for k in range(4)]
        up = np.array([0.0, 0.0, 0.07])
        model.quads(np.array([[a, b, b + up, a + up] for a, b in rim]), ROOF, Semantic.ROOF)
    front = x + 0.02
    model.quads(
        np.array([[[front, -0.4, 0.1], [front, 0.4, 0.1], [front, 0.4, 1.95], [front, -0.4, 1.95]]]),
        DOOR,
        Semantic.DOOR,
    )
    model.quads(
        np.array(
            [[[0.35, -y - 0.02, 1.1], [0.95, -y - 0.02, 1.1], [0.95, -y - 0.02, 1.7], [0.35, -y - 0.02, 1.7]]]
        ),
        GLASS,
        Semantic.WINDOW,
    )
    return model.finish()


def draw_huts(shop: CoastWorkshop, rng: np.random.Generator) -> Float64[np.ndarray, "huts 3"]:
    """Places and headings (x, y, rad) in rows at the dune foot, doors to the sea; claims their ground."""
    coast, wanted = shop.coast, round(rng.uniform(*shop.knobs.huts))
    along = np.arange(-1.3 * coast.half_m, 1.3 * coast.half_m, 3.9)
    along = along + rng.uniform(-0.3, 0.3, len(along))
    q = coast.beach(along) - 3.6
    xy = coast.plan(along, q)
    good = (coast.cliff(along) < 0.12) & coast.inside(xy, 25.0) & (q - coast.wet(along) > 8.0)
    good &= np.sin(along / 31.0 + rng.uniform(0, 6)) > -0.2
    step = coast.plan(along + 2.0, coast.beach(along + 2.0)) - coast.plan(
        along - 2.0, coast.beach(along - 2.0)
    )
    heading = np.arctan2(step[:, 1], step[:, 0]) - 0.5 * np.pi + rng.normal(0.0, 0.03, len(along))
    rows = np.column_stack([xy, heading])[good]
    shapes = rectangles(rows[:, :2], np.full(len(rows), 3.6), np.full(len(rows), 3.0), rows[:, 2])
    return np.asarray(rows[shop.claims.take(shapes, 0.4)][:wanted])


def build_huts(
    rows: Float64[np.ndarray, "huts 3"],
    height_m: Float64[np.ndarray, "huts"],
    shop: CoastWorkshop,
    rng: np.random.Generator,
) -> list[Part]:
    """Huts at given places (x, y, rad) and heights [m] of their floor, in three sizes."""
    count = len(rows)
    owner = shop.builder.new_objects(count) + np.arange(count)
    wood, paint = shop.palette.variants("timber_weathered"), shop.palette.variants("steel_painted")
    glass = shop.palette.only("vehicle_glass")
    choice = rng.integers(4, size=(count, 3))
    skins = np.column_stack(
        [
            np.array(wood)[choice[:, 0] % len(wood)],
            np.array((*wood, *paint))[choice[:, 1]],
            np.array(paint)[choice[:, 2] % len(paint)],
            np.full(count, glass),
        ]
    ).astype(np.int64)
    position = np.column_stack([rows[:, :2], height_m])
    kind, parts = rng.integers(3, size=count), []
    for k, size in enumerate(((3.0, 2.4, 2.1, 2.9), (2.6, 2.2, 2.2, 3.1), (3.3, 2.7, 2.0, 2.7))):
        mine = np.flatnonzero(kind == k)
        ones = np.ones((len(mine), 3))
        parts.append(place(hut(*size), position[mine], rows[mine, 2], ones, skins[mine], owner[mine]))
    return parts


def standing_height(rows: Float64[np.ndarray, "huts 3"], shop: CoastWorkshop) -> Float64[np.ndarray, "huts"]:
    """Height [m] of the floor of huts: just above the highest sand around them."""
    tilt = np.abs(slopes(shop.relief, rows[:, :2])).sum(axis=1)
    return np.asarray(shop.relief(rows[:, :2]) + np.minimum(1.1 * tilt, 0.5))
