"""Roofs: flat ones in one triangulation, gables, hips and mansards as lattices."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
import shapely

from scenegen.buildings.building import Building, Volume
from scenegen.buildings.styles import Roof
from scenegen.classes import Semantic
from scenegen.geometry.ground import Region, drape
from scenegen.geometry.part import Part, concatenate
from scenegen.geometry.patch import patches
from scenegen.geometry.planar import triangulate
from scenegen.geometry.rings import inset, strip
from scenegen.geometry.scatter import contact_points

PARAPET_WIDTH_M = 0.28
MANSARD_RUN_M = 1.1
_TUCK_M, _NEEDLE_M = 0.02, 0.03
_FLAT_M, _EDGE_M, _SLOPE_M, _EAVES_SITES_M = 4.0, 2.7, 4.4, 10.0
"""Spacing of sites on flat roofs, along their parapets, on slopes and along eaves."""
_PARAPET_ROW, _GEAR_ROW = (2.3, -1.2), (1.8, 0.1)
"""Spacing and distance of the rows behind parapets and around what stands on roofs: there the view changes."""
_EAVES_M, _VERGE_M, _THICKNESS_M = 0.45, 0.3, 0.18
_BEHIND_M = 0.05

Storeys = Sequence[tuple[Building, Volume]]


def flat_outline(building: Building, volume: Volume) -> tuple[shapely.Polygon, float] | None:
    """Walkable part of a flat roof and its height [m]; None for pitched roofs."""
    style, level = building.style, volume.eave_m(building.style)
    if volume.form is Roof.FLAT:
        rings = [inset(r, PARAPET_WIDTH_M - _TUCK_M) for r in volume.rings]
    elif volume.form is Roof.MANSARD:
        level += MANSARD_RUN_M * style.roof_slope
        rings = [inset(r, MANSARD_RUN_M - _TUCK_M) for r in volume.rings]
    else:
        return None
    outline = _sound(shapely.Polygon(rings[0], rings[1:]))
    if volume.covered is not None:
        outline = outline.difference(volume.covered.buffer(-_TUCK_M, join_style="mitre"))
    return _without_spikes(outline), level


def _sound(outline: shapely.Polygon) -> shapely.Polygon:
    """Outline, or the largest piece of it where insets of narrow parts cross."""
    if outline.is_valid:
        return outline
    pieces = shapely.get_parts(shapely.make_valid(outline))
    return max((p for p in pieces if p.geom_type == "Polygon"), key=lambda p: p.area)


def _without_spikes(outline: shapely.Polygon) -> shapely.Polygon:
    """Outline without the needles that a mitred inset leaves at nearly straight corners."""
    plain = outline.buffer(-_NEEDLE_M, join_style="mitre").buffer(_NEEDLE_M, join_style="mitre")
    return plain if plain.geom_type == "Polygon" else outline


def flat_roofs(volumes: Storeys, occupied: np.ndarray, rng: np.random.Generator) -> Part:
    """All flat roofs in one triangulation: in plan they do not overlap.

    Parameters
    ----------
    volumes : sequence of (Building, Volume)
    occupied : array of shapely.Polygon
        Plan of what stands on the roofs; no sites are put below.
    rng : numpy.random.Generator
    """
    regions = []
    for building, volume in volumes:
        flat = flat_outline(building, volume)
        if flat is not None:
            skin = building.style.roof if volume.form is Roof.FLAT else building.style.cap
            regions.append(
                Region(flat[0], skin, int(Semantic.ROOF), building.object, level_m=flat[1], absolute=True)
            )
    outlines = [r.outline for r in regions]
    rows = [
        contact_points(outlines, *_PARAPET_ROW),
        _within(contact_points(list(occupied), *_GEAR_ROW), outlines),
    ]
    plan = triangulate(outlines, _lattice(outlines, occupied, rng), _EDGE_M, rows=np.concatenate(rows))
    return drape(plan, regions, lambda xy: np.zeros(len(xy)))


def _lattice(
    outlines: Sequence[shapely.Polygon], occupied: np.ndarray, rng: np.random.Generator
) -> np.ndarray:
    """Points on roofs, not below what stands on them."""
    points = []
    for x0, y0, x1, y1 in shapely.bounds(np.asarray(outlines, dtype=object)):
        x, y = np.meshgrid(np.arange(x0 + 1.2, x1, _FLAT_M), np.arange(y0 + 1.2, y1, _FLAT_M))
        points.append(np.column_stack([x.ravel(), y.ravel()]))
    cloud = np.concatenate(points)
    cloud = cloud + rng.uniform(-0.2, 0.2, cloud.shape)
    cloud = _within(cloud, outlines)
    below = shapely.STRtree(occupied).query(shapely.points(cloud), predicate="within")[0]
    return np.delete(cloud, np.unique(below), axis=0)


def _within(cloud: np.ndarray, outlines: Sequence[shapely.Polygon]) -> np.ndarray:
    """Points that lie on a roof."""
    tree = shapely.STRtree(np.asarray(outlines, dtype=object))
    return np.asarray(cloud[np.unique(tree.query(shapely.points(cloud), predicate="within")[0])])


def sloped_roofs(volumes: Storeys) -> Part:
    """Gables, hips, mansards, and the gable walls below them."""
    tops: list[tuple[np.ndarray, int, int, int]] = []
    thin: list[tuple[np.ndarray, int, int, int]] = []
    for building, volume in volumes:
        style, roof = building.style, int(Semantic.ROOF)
        if volume.form is Roof.MANSARD:
            base = volume.eave_m(style)
            for ring in volume.rings:
                upper = inset(ring, MANSARD_RUN_M)
                outer = inset(ring, -0.25)
                tops.append(
                    (
                        strip(ring, base + 0.1, upper, base + MANSARD_RUN_M * style.roof_slope),
                        style.roof,
                        roof,
                        building.object,
                    )
                )
                ledge = np.concatenate(
                    [
                        strip(ring, base - 0.15, outer, base - 0.15),
                        strip(outer, base - 0.15, outer, base + 0.1),
                        strip(outer, base + 0.1, ring, base + 0.1),
                    ]
                )
                thin.append((ledge, style.wall, int(Semantic.WALL), building.object))
        elif volume.form in (Roof.GABLE, Roof.HIP):
            slopes, edges, gables = _pitched(volume, building)
            tops.append((slopes, style.roof, roof, building.object))
            thin.append((edges, style.roof, roof, building.object))
            if len(gables):
                tops.append((gables, style.wall, int(Semantic.WALL), building.object))
    return concatenate([_patched(tops, _SLOPE_M, False), _patched(thin, _EAVES_SITES_M, True)])


def _patched(items: list[tuple[np.ndarray, int, int, int]], spacing_m: float, lumped: bool) -> Part:
    if not items:
        empty = np.zeros(0, np.int64)
        return patches(np.zeros((0, 4, 3)), spacing_m, empty, empty, empty)
    corners = np.concatenate([c for c, _, _, _ in items])
    labels = [np.concatenate([np.full(len(i[0]), i[k]) for i in items]) for k in (1, 2, 3)]
    return patches(corners, spacing_m, labels[0], labels[1], labels[2], lumped_rows=lumped)


def _between(start: tuple[float, float], end: tuple[float, float], share: float) -> tuple[float, float]:
    return (start[0] + share * (end[0] - start[0]), start[1] + share * (end[1] - start[1]))


def _pitched(volume: Volume, building: Building) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Slopes, thin edges and undersides, and gable walls of a rectangular volume."""
    ring = volume.rings[0]
    sides = np.linalg.norm(np.roll(ring, -1, axis=0) - ring, axis=1)
    if sides[0] < sides[1]:
        ring = np.roll(ring, -1, axis=0)
    middle = ring.mean(axis=0)
    x_axis = (ring[1] - ring[0]) / np.linalg.norm(ring[1] - ring[0])
    y_axis = np.array([-x_axis[1], x_axis[0]])
    a, b = max(sides[0], sides[1]) / 2, min(sides[0], sides[1]) / 2
    eave, slope = volume.eave_m(building.style), building.style.roof_slope
    hip = volume.form is Roof.HIP
    over = _EAVES_M if hip else _VERGE_M
    ridge = max(a - b, 0.3) if hip else a + over
    wide, low, high = b + _EAVES_M, eave - _EAVES_M * slope, eave + b * slope
    if hip:
        low = eave - over * slope

    def at(x: float, y: float, z: float) -> list[float]:
        return [*(middle + x * x_axis + y * y_axis), z]

    t = _THICKNESS_M
    left, right = -(a + over), a + over
    e = [(left, -wide), (right, -wide), (right, wide), (left, wide)]
    r = [(-ridge, 0.0), (ridge, 0.0)]
    top = [
        [at(*e[0], low + t), at(*e[1], low + t), at(*r[1], high + t), at(*r[0], high + t)],
        [at(*e[2], low + t), at(*e[3], low + t), at(*r[0], high + t), at(*r[1], high + t)],
    ]
    ends = [
        [at(*e[1], low + t), at(*e[2], low + t), at(*r[1], high + t), at(*r[1], high + t)],
        [at(*e[3], low + t), at(*e[0], low + t), at(*r[0], high + t), at(*r[0], high + t)],
    ]
    # Undersides end just behind the walls: their sites hang outdoors, not in the attic.
    share = (wide - b + _BEHIND_M) / wide
    lip, height = (
        [_between(e[k], r[j], share) for k, j in enumerate((0, 1, 1, 0))],
        low + share * (high - low),
    )
    under = [
        [at(*e[k], low), at(*e[j], low), at(*lip[j], height), at(*lip[k], height)]
        for k, j in ((1, 0), (3, 2))
    ]
    eaves = [[at(*e[k], low), at(*e[k + 1], low), at(*e[k + 1], low + t), at(*e[k], low + t)] for k in (0, 2)]
    if hip:
        under += [
            [at(*e[k], low), at(*e[j], low), at(*lip[j], height), at(*lip[k], height)]
            for k, j in ((2, 1), (0, 3))
        ]
        eaves += [
            [at(*e[k], low), at(*e[(k + 1) % 4], low), at(*e[(k + 1) % 4], low + t), at(*e[k], low + t)]
            for k in (1, 3)
        ]
        return np.array(top + ends), np.array(under + eaves), np.zeros((0, 4, 3))
    back = a - _BEHIND_M
    for k, end, x in ((1, r[1], back), (3, r[0], -back)):
        y = lip[k][1]
        under.append([at(*end, high), at(*lip[k], height), at(x, y, height), at(x, 0.0, high)])
    for k, end, x in ((0, r[0], -back), (2, r[1], back)):
        y = lip[k][1]
        under.append([at(*lip[k], height), at(*end, high), at(x, 0.0, high), at(x, y, height)])
    verges = []
    for k, j, end in ((1, 2, r[1]), (3, 0, r[0])):
        verges.append([at(*e[k], low), at(*end, high), at(*end, high + t), at(*e[k], low + t)])
        verges.append([at(*end, high), at(*e[j], low), at(*e[j], low + t), at(*end, high + t)])
    gables = [
        [at(a, -b, eave), at(a, b, eave), at(a, 0.0, high), at(a, 0.0, high)],
        [at(-a, b, eave), at(-a, -b, eave), at(-a, 0.0, high), at(-a, 0.0, high)],
    ]
    return np.array(top), np.array(under + eaves + verges), np.array(gables)
