"""The ground of the coast: all regions in one triangulation, fine at the shore and on cliffs, out to the horizon."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

import numpy as np
import shapely

from scenegen.geometry.ground import Region, drape
from scenegen.geometry.part import Part, face_normals
from scenegen.geometry.planar import triangulate
from scenegen.geometry.ragged import ragged_arange
from scenegen.geometry.scatter import contact_points, graded_points, hexagonal
from scenegen.maps.coastline.covers import breakwater, fields, heath, roads
from scenegen.maps.coastline.layout import Layout
from scenegen.maps.coastline.shape import FAR_M, Coast
from scenegen.maps.coastline.strips import Strips
from scenegen.maps.coastline.things import Things
from scenegen.maps.coastline.workshop import CoastWorkshop

_FINE_M, _OPEN_M, _FACE_M = 2.1, 4.0, 1.05
_FINE_POINTS = 30_000
"""Points of the fine lattice, at most: where the shore is long, everything is a little coarser."""
_LOW_CLIFF_M = 4.0
_CONTACT_M = 1.2
_AROUND = ((1.0, 0.25), (1.5, 1.1))
"""Spacing and distance of the rows of points around rocks [m]."""
_CLEAR_M = 0.01
_FOLD = 0.45
"""Sites rise by this share of what the highest face around them rises over their plane."""


def build_ground(
    layout: Layout,
    things: Things,
    rock: str,
    sea_K: float,
    shop: CoastWorkshop,
    rng: np.random.Generator,
) -> Part:
    """All solid ground, a little below the sea's edge to the far edge of the land.

    Parameters
    ----------
    layout : Layout
    things : Things
        No ground below buildings, no sites below rocks (whose heat would be seen around them), gardens.
    rock : str
        Material of this coast's rock.
    sea_K : float
        Temperature of the water [K].
    shop : CoastWorkshop
    rng : numpy.random.Generator
    """
    strips = Strips(shop)
    regions = [*strips.land(rng), *fields(layout, shop, rng), *strips.shore(rock, sea_K, rng)]
    regions += [*heath(layout, shop, rng), *things.lawns, *roads(layout, shop, rng)]
    regions += breakwater(layout, rock, shop, rng)
    regions += [Region(p, regions[0].surface, 0, 0, hole=True) for p in things.holes]
    points = _points(strips, things.holes, things.stones, rng)
    half = shop.coast.half_m
    spacing = np.array([_CONTACT_M if r.hole else _FINE_M for r in regions])
    plan = triangulate([r.outline for r in regions], points, spacing, (1.1 * half, 0.1))
    return _above_skin(drape(plan, regions, shop.relief))


def _above_skin(ground: Part) -> Part:
    """Lift sites clear of curved ground: on a crest they would lie just below the faces around them, and in a fold, as
    at the foot of a dune, their rays, which start a little aside, would start below the steeper side."""
    corner = ground.corner_site.ravel()
    normal, _ = face_normals(ground.vertices, ground.faces)
    first = ground.vertices[ground.faces[:, 0]]
    middle = ground.vertices[ground.faces].mean(axis=1)
    here, out = ground.site_position[ground.corner_site], ground.site_normal[ground.corner_site]
    depth = ((first[:, None] - here) * normal[:, None]).sum(axis=2).ravel()
    over = ((middle[:, None] - here) * out).sum(axis=2).ravel()
    rise = np.zeros((2, len(ground.site_position)))
    np.maximum.at(rise[0], corner, np.minimum(depth + _CLEAR_M, 0.5))
    np.maximum.at(rise[1], corner, np.minimum(over, 1.0))
    lift = rise[0] + _FOLD * rise[1]
    return replace(ground, site_position=ground.site_position + lift[:, None] * ground.site_normal)


def _points(
    strips: Strips, holes: Sequence[shapely.Polygon], stones: np.ndarray, rng: np.random.Generator
) -> np.ndarray:
    """Fine near the shore and the road, finer on faces of cliffs, coarse on open land and beyond."""
    coast = strips.coast

    def zone(xy: np.ndarray) -> np.ndarray:
        sq = coast.offset(xy)
        road = coast.road(sq[:, 0]) - coast.shore(sq[:, 0]) + 26.0
        return np.asarray((sq[:, 1] > np.interp(sq[:, 0], strips.s, strips.foot)) & (sq[:, 1] < road))

    nominal = hexagonal(*coast.core(), 2.0 * _FINE_M, rng)
    grain = max(float(np.sqrt(4.0 * zone(nominal).sum() / _FINE_POINTS)), 1.0)
    fine, face = (
        hexagonal(*coast.core(), grain * _FINE_M, rng),
        _faces_of_cliffs(strips, grain * _FACE_M, rng),
    )
    far = graded_points(shapely.box(*coast.core()), FAR_M, grain * _OPEN_M, rng)
    square = np.abs(far).max(axis=1) < coast.half_m
    sq_far = coast.offset(far)
    dry = sq_far[:, 1] > np.interp(sq_far[:, 0], strips.s, strips.foot)
    large = [s for s in stones if s.area > 3.0]
    rows = [contact_points(list(holes), _CONTACT_M, 0.9), *(contact_points(large, s, d) for s, d in _AROUND)]
    fine = fine[zone(fine)]
    fine = fine[~_on_cliff(coast, fine)]
    points = np.concatenate([*rows, face, fine, far[dry & ~(square & zone(far))]])
    hidden = shapely.STRtree(stones).query(shapely.points(points), predicate="within")[0]
    return np.asarray(np.delete(points, np.unique(hidden), axis=0))


def _on_cliff(coast: Coast, xy: np.ndarray) -> np.ndarray:
    sq = coast.offset(xy)
    on_face = (sq[:, 1] > coast.beach(sq[:, 0]) - 1.0) & (sq[:, 1] < coast.brow(sq[:, 0]) + 1.0)
    return np.asarray(on_face & (coast.cliff_m(sq[:, 0]) > _LOW_CLIFF_M))


def _faces_of_cliffs(strips: Strips, spacing_m: float, rng: np.random.Generator) -> np.ndarray:
    """A jittered lattice in s and q on the faces of cliffs."""
    coast = strips.coast
    along = np.arange(-1.45 * coast.half_m, 1.45 * coast.half_m, 0.9 * spacing_m)
    along = along[coast.cliff_m(along) > _LOW_CLIFF_M]
    low, high = coast.beach(along) - 0.7, coast.brow(along) + 0.7
    count = np.maximum(((high - low) / spacing_m).astype(np.int64), 1)
    row, k = ragged_arange(count)
    step = (high - low)[row] / count[row]
    q = low[row] + (k + 0.25 + 0.5 * (row % 2) + rng.uniform(-0.18, 0.18, len(row))) * step
    xy = coast.plan(along[row] + rng.uniform(-0.18, 0.18, len(row)) * spacing_m, q)
    return np.asarray(xy[coast.inside(xy, 0.0)])
