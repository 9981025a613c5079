"""Boats at anchor, in the lee of the breakwater, and drawn up on the sand."""

from __future__ import annotations

import numpy as np
import shapely

from scenegen.geometry.part import Part
from scenegen.geometry.placement import rectangles
from scenegen.maps.coastline.layout import Layout
from scenegen.maps.coastline.sea import Sea
from scenegen.maps.coastline.workshop import CoastWorkshop
from scenegen.parts.boats.moor import moor, size_m

KINDS = {"rowing": 0.25, "sailing": 0.35, "motor": 0.25, "fishing": 0.15}
"""Kinds and their shares afloat."""

_DEPTH_M = {"rowing": 0.7, "sailing": 2.4, "motor": 1.2, "fishing": 2.0}
_KEEL_M = 0.13
_BEACHED = 0.2
_MESH_M = 1.7


def build_boats(
    layout: Layout, sea: Sea, shop: CoastWorkshop, rng: np.random.Generator
) -> tuple[list[Part], int]:
    """Boats that stay where they are, and their number."""
    wanted = round(rng.uniform(*shop.knobs.boats))
    ashore = round(_BEACHED * wanted)
    parts, count = _beached(ashore, shop, rng)
    xy = _anchorages(layout, 14 * wanted, shop, rng)
    kind = rng.choice(list(KINDS), len(xy), p=list(KINDS.values()))
    depth = np.array([_DEPTH_M[str(k)] for k in kind])
    size = np.array([size_m(str(k))[:2] for k in kind]).reshape(-1, 2)
    wind = shop.coast.frame.heading_rad + rng.uniform(-np.pi, np.pi)
    heading = wind + rng.normal(0.0, 0.2, len(xy))
    shapes = rectangles(xy, 1.15 * size[:, 0] + 3.0, 1.15 * size[:, 1] + 3.0, heading)
    good = shop.coast.inside(xy, 14.0) & (shop.relief(xy) < -depth)
    chosen = np.flatnonzero(good)
    chosen = chosen[shop.claims.take(shapes[chosen], 2.0)][: max(wanted - ashore, 0)]
    level = sea.height(xy[chosen], np.full(len(chosen), _MESH_M))
    position = np.column_stack([xy[chosen], level])
    for name in KINDS:
        mine = kind[chosen] == name
        running = name == "fishing" and bool(rng.uniform() < 0.5)
        parts += moor(name, position[mine], heading[chosen][mine], shop, rng, running)
    return parts, count + len(chosen)


def _anchorages(layout: Layout, count: int, shop: CoastWorkshop, rng: np.random.Generator) -> np.ndarray:
    """Candidates: half between breakwater and pier, half along the coast."""
    coast = shop.coast
    harbour = np.concatenate([shapely.get_coordinates(layout.mound.line)[1:], layout.pier])
    middle = harbour.mean(axis=0)
    near = middle + rng.normal(0.0, 34.0, (count // 2, 2))
    s = rng.uniform(-1.3, 1.3, count - count // 2) * coast.half_m
    far = coast.plan(s, -18.0 - rng.gamma(2.0, 45.0, len(s)))
    return np.concatenate([near, far])


def _beached(wanted: int, shop: CoastWorkshop, rng: np.random.Generator) -> tuple[list[Part], int]:
    """Rowing boats on the dry sand, bows uphill, keels in the sand."""
    coast, count = shop.coast, 30 * wanted
    s = rng.uniform(-1.2, 1.2, count) * coast.half_m
    q = coast.wet(s) + rng.uniform(3.0, 8.0, count)
    xy = coast.plan(s, q)
    heading = coast.frame.heading_rad + 0.5 * np.pi + rng.normal(0.0, 0.35, count)
    length, beam, _ = size_m("rowing")
    shapes = rectangles(xy, np.full(count, 1.15 * length), np.full(count, 1.15 * beam + 0.5), heading)
    good = np.flatnonzero((coast.cliff(s) < 0.3) & (q < coast.beach(s) - 6.0) & coast.inside(xy, 12.0))
    chosen = good[shop.claims.take(shapes[good], 0.5)][:wanted]
    position = np.column_stack([xy[chosen], shop.relief(xy[chosen]) + _KEEL_M])
    return moor("rowing", position, heading[chosen], shop, rng), len(chosen)
