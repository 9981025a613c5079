"""Building plans become walls, parapets and flat roofs; all buildings of a world at once."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
import shapely

from scenegen.classes import Semantic
from scenegen.geometry.facade import BLANK, DOOR, WINDOW, Walls, facades
from scenegen.geometry.ground import Region, drape
from scenegen.geometry.part import Part, concatenate
from scenegen.geometry.patch import patches
from scenegen.geometry.planar import triangulate
from scenegen.maps.city.buildings import Building, Volume

_PARAPET_WIDTH_M = 0.28
_TUCK_M = 0.02
_ROOF_SPACING_M = 2.6


def build_shells(buildings: Sequence[Building], rng: np.random.Generator) -> Part:
    """Walls with windows, parapets and flat roofs of all volumes."""
    volumes = [(b, v) for b in buildings for v in b.volumes]
    walls, filling = _walls(volumes, rng)
    return concatenate([facades(walls, filling), _parapets(volumes), _flat_roofs(volumes, rng)])


def rings(outline: shapely.Polygon) -> list[np.ndarray]:
    """Open rings with the solid on the left: outer counter-clockwise, courtyards clockwise."""
    oriented = shapely.orient_polygons(outline)
    return [shapely.get_coordinates(r)[:-1] for r in (oriented.exterior, *oriented.interiors)]


def _walls(volumes: Sequence[tuple[Building, Volume]], rng: np.random.Generator) -> tuple[Walls, np.ndarray]:
    starts, ends, owner = [], [], []
    for k, (_, volume) in enumerate(volumes):
        for ring in rings(volume.outline):
            starts.append(ring)
            ends.append(np.roll(ring, -1, axis=0))
            owner.append(np.full(len(ring), k))
    start, end, index = np.concatenate(starts), np.concatenate(ends), np.concatenate(owner)

    def column(values: list[float]) -> np.ndarray:
        return np.array(values, np.float64)[index]

    styles = [b.style for b, _ in volumes]
    length = np.linalg.norm(end - start, axis=1)
    roof = column([v.roof_m(b.style) + b.style.parapet_m for b, v in volumes])
    walls = Walls(
        start=start,
        end=end,
        floor_m=column([v.floor_m for _, v in volumes]),
        foundation_m=column([v.foundation_m for _, v in volumes]),
        top_m=roof,
        storeys=np.array([v.storeys for _, v in volumes])[index],
        first_storey_m=column([s.first_storey_m for s in styles]),
        storey_m=column([s.storey_m for s in styles]),
        columns=np.maximum(np.rint(length / column([s.pitch_m for s in styles])).astype(np.int64), 1),
        window_share=column([s.window_share for s in styles]),
        sill_m=column([s.sill_m for s in styles]),
        head_m=column([s.head_m for s in styles]),
        first_sill_m=column([s.first_sill_m for s in styles]),
        first_head_m=column([s.first_head_m for s in styles]),
        surface=np.array([s.wall for s in styles])[index],
        glass=np.array([s.glass for s in styles])[index],
        door=np.array([s.door for s in styles])[index],
        object=np.array([b.object for b, _ in volumes])[index],
        recess_m=column([s.recess_m for s in styles]),
    )
    return walls, _filling(walls, column([s.blank_share for s in styles]), length, rng)


def _filling(walls: Walls, blank_share: np.ndarray, length: np.ndarray, rng: np.random.Generator) -> np.ndarray:
    """Windows nearly everywhere, a door on some walls, nothing on short walls."""
    wall, column, storey = walls.cells()
    filling = np.where(rng.uniform(size=len(wall)) < blank_share[wall], BLANK, WINDOW)
    entrance = (rng.uniform(size=len(length)) * walls.columns).astype(np.int64)
    has_door = (rng.uniform(size=len(length)) < 0.5) & (walls.foundation_m > 0)
    filling[(storey == 0) & (column == entrance[wall]) & has_door[wall]] = DOOR
    filling[(length < 1.8)[wall]] = BLANK
    return filling


def _inset(ring: np.ndarray, distance_m: float) -> np.ndarray:
    """Ring moved towards the solid (its left side), mitred; same number of points."""
    before, after = ring - np.roll(ring, 1, axis=0), np.roll(ring, -1, axis=0) - ring
    before = before / np.linalg.norm(before, axis=1)[:, None]
    after = after / np.linalg.norm(after, axis=1)[:, None]
    left = np.column_stack([-(before + after)[:, 1], (before + after)[:, 0]]) / 2
    return ring + left * (distance_m / np.maximum((left**2).sum(axis=1), 0.2))[:, None]


def _parapets(volumes: Sequence[tuple[Building, Volume]]) -> Part:
    """Coping and inner side of the parapet along every wall."""
    corners, surface, owner = [], [], []
    for building, volume in volumes:
        roof = volume.roof_m(building.style)
        top = roof + building.style.parapet_m
        for ring in rings(volume.outline):
            inner = _inset(ring, _PARAPET_WIDTH_M)
            outer_next, inner_next = np.roll(ring, -1, axis=0), np.roll(inner, -1, axis=0)
            corners.append(_lift([ring, outer_next, inner_next, inner], [top, top, top, top]))
            corners.append(_lift([inner_next, inner, inner, inner_next], [roof - 0.05, roof - 0.05, top, top]))
            surface.append(np.full(2 * len(ring), building.style.wall))
            owner.append(np.full(2 * len(ring), building.object))
    semantic = np.full(sum(len(s) for s in surface), int(Semantic.WALL))
    return patches(np.concatenate(corners), 4.0, np.concatenate(surface), semantic, np.concatenate(owner))


def _lift(plan: list[np.ndarray], heights: list[float]) -> np.ndarray:
    return np.stack([np.column_stack([p, np.full(len(p), h)]) for p, h in zip(plan, heights, strict=True)], axis=1)


def _flat_roofs(volumes: Sequence[tuple[Building, Volume]], rng: np.random.Generator) -> Part:
    """All flat roofs in one triangulation: in plan they do not overlap."""
    regions = []
    for building, volume in volumes:
        ring_list = [_inset(r, _PARAPET_WIDTH_M - _TUCK_M) for r in rings(volume.outline)]
        outline = shapely.Polygon(ring_list[0], ring_list[1:])
        if volume.covered is not None:
            outline = outline.difference(volume.covered.buffer(-_TUCK_M, join_style="mitre"))
        regions.append(
            Region(
                outline,
                building.style.roof,
                int(Semantic.ROOF),
                building.object,
                level_m=volume.roof_m(building.style),
            )
        )
    outlines = [r.outline for r in regions]
    plan = triangulate(outlines, _roof_points(outlines, rng), _ROOF_SPACING_M)
    return drape(plan, regions, lambda xy: np.zeros(len(xy)))


def _roof_points(outlines: Sequence[shapely.Polygon], rng: np.random.Generator) -> np.ndarray:
    """Jittered lattice over the bounding boxes of the roofs; the triangulation keeps what lies inside."""
    boxes = shapely.bounds(np.asarray(outlines, dtype=object))
    points = []
    for x0, y0, x1, y1 in boxes:
        x, y = np.meshgrid(np.arange(x0, x1, _ROOF_SPACING_M), np.arange(y0, y1, _ROOF_SPACING_M))
        points.append(np.column_stack([x.ravel(), y.ravel()]))
    cloud = np.concatenate(points)
    tree = shapely.STRtree(np.asarray(outlines, dtype=object))
    inside = np.unique(tree.query(shapely.points(cloud), predicate="within")[0])
    return cloud[inside] + rng.uniform(-0.15, 0.15, (len(inside), 2))
