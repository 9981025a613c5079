"""Round bales of hay on freshly mown meadows."""

from __future__ import annotations

import numpy as np
import shapely
from jaxtyping import Float64

from scenegen.classes import Semantic
from scenegen.geometry.modelling import Modeller
from scenegen.geometry.part import Part
from scenegen.geometry.placement import clear_of, first_come
from scenegen.geometry.relief import Relief
from scenegen.geometry.template import Template, place
from scenegen.maps.field.country import Country, Cover
from scenegen.maps.field.workshop import FieldWorkshop

RADIUS_M, LENGTH_M = 0.7, 1.25
_SIDES = 14
_HALF_CELL_M = 3.0
_PER_HECTARE = (6.0, 18.0)


def build_bales(
    country: Country, taken: np.ndarray, half_m: float, shop: FieldWorkshop, rng: np.random.Generator
) -> tuple[list[Part], np.ndarray]:
    """Bales along the swaths of hay meadows of the detailed square, and their plans."""
    room = shapely.box(-half_m, -half_m, half_m, half_m)
    rows = [np.zeros((0, 3))]
    for parcel in country.parcels:
        meadow = parcel.outline.buffer(-6.0).intersection(room)
        if parcel.cover is not Cover.HAY or meadow.is_empty:
            continue
        x0, y0, x1, y1 = meadow.bounds
        count = rng.poisson(rng.uniform(*_PER_HECTARE) * (x1 - x0) * (y1 - y0) / 1e4)
        xy = rng.uniform((x0, y0), (x1, y1), (count, 2))
        xy = xy[shapely.contains_xy(meadow, xy)]
        turn = parcel.heading_rad + np.pi / 2 + rng.normal(0.0, 0.25, len(xy))
        rows.append(np.column_stack([xy, turn]))
    table = np.concatenate(rows)
    discs = shapely.buffer(shapely.points(table[:, :2]), 1.3)
    keep = clear_of(discs, taken, 1.0)
    keep[np.flatnonzero(keep)] = first_come(discs[keep])
    table = table[keep]
    count = len(table)
    if not count:
        return [], discs[keep]
    position = np.column_stack([table[:, :2], _lowest_lie(shop.relief, table[:, :2])])
    skin = shop.palette.variants("grass_dry")
    skins = np.array(skin)[rng.integers(len(skin), size=count)][:, None]
    owner = shop.builder.new_objects(count) + np.arange(count)
    size = rng.uniform(0.9, 1.1, (count, 1)) * np.ones(3)
    return [place(bale(), position, table[:, 2], size, skins, owner)], discs[keep]


def _lowest_lie(relief: Relief, xy: Float64[np.ndarray, "points 2"]) -> Float64[np.ndarray, "points"]:
    """Height of the relief, or of the mesh where its cells cut off a crest: the mean of a ring of half a cell."""
    angle = 2 * np.pi * np.arange(6) / 6
    ring = _HALF_CELL_M * np.column_stack([np.cos(angle), np.sin(angle)])
    around = relief((xy[:, None, :] + ring).reshape(-1, 2)).reshape(-1, len(ring))
    return np.asarray(np.minimum(relief(xy), around.mean(axis=1)))


def bale() -> Template:
    """A round bale that lies on z = 0, its axis along y, sunk in a little. Slot: 0. Five sites."""
    model = Modeller()
    sink = 0.1
    angle = 2 * np.pi * np.arange(_SIDES) / _SIDES
    rim = RADIUS_M * np.column_stack([np.cos(angle), np.zeros(_SIDES), np.sin(angle)])
    middle = np.array([0.0, 0.0, RADIUS_M - sink])
    half = np.array([0.0, LENGTH_M / 2, 0.0])
    points = np.concatenate([middle + rim - half, middle + rim + half])
    k, after = np.arange(_SIDES), (np.arange(_SIDES) + 1) % _SIDES
    quads = np.stack([after, k, k + _SIDES, after + _SIDES], axis=1)
    facing = np.array([[1.0, 0.0, 0.35], [0.0, 0.0, 1.0], [-1.0, 0.0, 0.35]])
    facing /= np.linalg.norm(facing, axis=1)[:, None]
    sites = np.array([model.site(middle + RADIUS_M * f, f) for f in facing])
    outward = rim[k] + rim[after]
    site = sites[np.argmax(outward @ facing.T, axis=1)]
    faces = quads[:, [0, 1, 2, 0, 2, 3]].reshape(-1, 3)
    corner = np.repeat(np.repeat(site, 2)[:, None], 3, axis=1)
    model.mesh(points, faces, 0, Semantic.OTHER, corner)
    fan = np.stack([np.zeros(_SIDES - 2, np.int64), np.arange(1, _SIDES - 1), np.arange(2, _SIDES)], axis=1)
    for side, shift, turned in ((-1.0, 0, fan), (1.0, _SIDES, fan[:, ::-1])):
        end = model.site(middle + side * half, np.array([0.0, side, 0.0]))
        model.mesh(points, shift + turned, 0, Semantic.OTHER, np.full(turned.shape, end))
    return model.finish()
