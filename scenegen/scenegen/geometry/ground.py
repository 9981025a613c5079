"""The ground: a triangulated plan draped over a relief, with steps (kerbs, banks) where regions change level.

A ray from above can never slip through: plan neighbours share vertices, and where their levels differ the
gap is closed by vertical quads between duplicated vertices.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
import shapely
from jaxtyping import Bool, Float64, Int64

from scenegen.geometry.part import STANDOFF_M, Part, concatenate, face_normals
from scenegen.geometry.patch import quads_to_triangles
from scenegen.geometry.planar import Triangulation
from scenegen.geometry.relief import Relief

_NUDGE_M = 0.04
"""How far sites on a region's outline move inwards, to lie clear of the plane of a wall or kerb [m]."""
_KERB_CELL_M, _WAYS = 3.5, 16
"""Kerbs share a site within such a cell and a sixteenth of the compass."""


@dataclass(frozen=True, eq=False)
class Region:
    """A piece of the ground plan.

    Attributes
    ----------
    outline : shapely.Polygon
    surface, semantic, object : int
        Labels of its faces.
    level_m : float
        Height above the relief [m], or above zero if `absolute`.
    hole : bool
        True where there is no ground at all: under a building.
    absolute : bool
        True for a level surface: a pond, a flat roof.
    lumped : bool
        One thermal site for the whole region: it is too small to have a gradient.
    grain_m : float
        Cells of this size [m] have one site at most; 0 to give each vertex its own.
    merge_m : float
        The same for its neighbours along its outline. For paint: it cuts the mesh, but changes nothing in what the
        asphalt beside it sees.
    """

    outline: shapely.Polygon
    surface: int
    semantic: int
    object: int
    level_m: float = 0.0
    hole: bool = False
    absolute: bool = False
    lumped: bool = False
    grain_m: float = 0.0
    merge_m: float = 0.0


def drape(plan: Triangulation, regions: Sequence[Region], relief: Relief) -> Part:
    """Lift a triangulated plan to the relief.

    Vertices are shared by regions of one level; sites by regions that agree in surface and object.

    Parameters
    ----------
    plan : Triangulation
        Of the outlines of `regions`, in the same order.
    regions : sequence of Region
    relief : callable
        Height [m] at plan points.
    """
    table = _Table.of(regions)
    keep = (plan.region >= 0) & ~table.hole[plan.region]
    triangles, region = plan.triangles[keep], plan.region[keep]
    height = relief(plan.points)
    flat = _surface(plan.points, height, triangles, region, table)
    steps = _steps(plan.points, height, triangles, region, table)
    return concatenate([flat, *steps])


@dataclass(frozen=True, eq=False)
class _Table:
    """Columns of the regions."""

    surface: Int64[np.ndarray, "regions"]
    semantic: Int64[np.ndarray, "regions"]
    object: Int64[np.ndarray, "regions"]
    level: Float64[np.ndarray, "regions"]
    hole: Bool[np.ndarray, "regions"]
    absolute: Bool[np.ndarray, "regions"]
    lumped: Bool[np.ndarray, "regions"]
    grain: Float64[np.ndarray, "regions"]
    merge: Float64[np.ndarray, "regions"]

    @staticmethod
    def of(regions: Sequence[Region]) -> _Table:
        return _Table(
            np.array([r.surface for r in regions], np.int64),
            np.array([r.semantic for r in regions], np.int64),
            np.array([r.object for r in regions], np.int64),
            np.array([r.level_m for r in regions], np.float64),
            np.array([r.hole for r in regions], bool),
            np.array([r.absolute for r in regions], bool),
            np.array([r.lumped for r in regions], bool),
            np.array([r.grain_m for r in regions], np.float64),
            np.array([r.merge_m for r in regions], np.float64),
        )

    def height(self, region: np.ndarray, relief_m: np.ndarray) -> np.ndarray:
        """Height [m] of points of regions where the relief has the given height."""
        return np.asarray(self.level[region] + np.where(self.absolute[region], 0.0, relief_m))


def _surface(
    points: np.ndarray, height: np.ndarray, triangles: np.ndarray, region: np.ndarray, table: _Table
) -> Part:
    keys = np.stack([table.level, table.absolute], axis=1)
    _, sample, level_index = np.unique(keys, axis=0, return_index=True, return_inverse=True)
    level_index = level_index.ravel()
    pairs = triangles.ravel() * len(sample) + np.repeat(level_index[region], 3)
    vertex, faces = np.unique(pairs, return_inverse=True)
    point = vertex // len(sample)
    vertices = np.column_stack([points[point], table.height(sample[vertex % len(sample)], height[point])])
    faces = faces.reshape(-1, 3)

    kinds, kind = np.unique(
        np.stack([table.surface, table.object, level_index], axis=1), axis=0, return_inverse=True
    )
    corner_region = np.repeat(region, 3)
    codes = triangles.ravel() * len(kinds) + kind.ravel()[corner_region]
    codes = np.where(table.lumped[corner_region], -1 - corner_region, codes)
    site, corner = np.unique(codes, return_inverse=True)
    cell = np.zeros(len(points))
    np.maximum.at(cell, triangles.ravel(), np.repeat(table.merge[region], 3))
    grain = np.zeros(len(kinds))
    np.maximum.at(grain, kind.ravel(), table.grain)
    merged, count = _merged(points, site, cell, grain)
    corner_site = merged[corner].reshape(-1, 3)
    position, normal = _site_frame(vertices, faces, corner_site, count)
    return Part(
        vertices=vertices,
        faces=faces,
        surface=table.surface[region],
        semantic=table.semantic[region],
        object=table.object[region],
        corner_site=corner_site,
        site_position=position,
        site_normal=normal,
        site_standoff=np.full(count, STANDOFF_M),
    )


def _merged(
    points: np.ndarray, code: np.ndarray, cell_m: np.ndarray, grain_m: np.ndarray
) -> tuple[np.ndarray, int]:
    """Site of each code (point times kinds plus kind; negative for lumps), those in one cell made one; their number."""
    point, kind = np.divmod(np.maximum(code, 0), len(grain_m))
    size = np.where(code < 0, 0.0, np.maximum(cell_m[point], grain_m[kind]))
    whole = np.flatnonzero(size > 0)
    square = np.floor(points[point[whole]] / size[whole, None]).astype(np.int64)
    label = np.stack([*square.T, np.rint(size[whole] * 1e3).astype(np.int64), kind[whole]], axis=1)
    low = label.min(axis=0, initial=0)
    span = label.max(axis=0, initial=0) - low + 1
    key = np.ravel_multi_index(tuple((label - low).T), tuple(span.tolist()))
    _, first, group = np.unique(key, return_index=True, return_inverse=True)
    lead = np.arange(len(code))
    lead[whole] = whole[first][group]
    kept, site = np.unique(lead, return_inverse=True)
    return site, len(kept)


def _site_frame(
    vertices: np.ndarray, faces: np.ndarray, corner_site: np.ndarray, count: int
) -> tuple[np.ndarray, np.ndarray]:
    """Position (nudged towards the faces the site stands for) and area-weighted normal of ground sites."""
    normals, area = face_normals(vertices, faces)
    corners = corner_site.ravel()
    weight = np.repeat(area, 3)
    summed = np.stack([np.bincount(corners, p, count) for p in vertices[faces.ravel()].T], axis=1)
    position = summed / np.maximum(np.bincount(corners, minlength=count), 1.0)[:, None]
    total = np.maximum(np.bincount(corners, weight, count), 1e-12)

    def mean(values: np.ndarray) -> np.ndarray:
        columns = [np.bincount(corners, weight * np.repeat(values[:, k], 3), count) / total for k in range(3)]
        return np.stack(columns, axis=1)

    normal = mean(normals)
    length = np.linalg.norm(normal, axis=1)[:, None]
    # A site all of whose triangles are slivers has no normal; it goes with them when parts are merged.
    normal = np.where(length > 0.0, normal / np.maximum(length, 1e-300), np.array([0.0, 0.0, 1.0]))
    pull = mean(vertices[faces].mean(axis=1)) - position
    # Along the ground: on a crest it would sink in.
    pull -= np.einsum("sk,sk->s", pull, normal)[:, None] * normal
    length = np.linalg.norm(pull, axis=1)
    return position + pull * np.minimum(_NUDGE_M / np.maximum(length, 1e-9), 0.5)[:, None], normal


def _steps(
    points: np.ndarray, height: np.ndarray, triangles: np.ndarray, region: np.ndarray, table: _Table
) -> list[Part]:
    """Vertical quads along edges between regions of different level; they belong to the higher region."""
    start = triangles[:, [0, 1, 2]].ravel()
    end = triangles[:, [1, 2, 0]].ravel()
    owner = np.repeat(region, 3)
    code = np.minimum(start, end) * len(points) + np.maximum(start, end)
    order = np.argsort(code, kind="stable")
    pair = code[order][1:] == code[order][:-1]
    one, two = order[:-1][pair], order[1:][pair]
    middle = (height[start[one]] + height[end[one]]) / 2
    rise = table.height(owner[one], middle) - table.height(owner[two], middle)
    high = np.concatenate([one[rise > 1e-6], two[rise < -1e-6]])
    low = np.concatenate([two[rise > 1e-6], one[rise < -1e-6]])
    if not len(high):
        return []
    a, b, upper, lower = start[high], end[high], owner[high], owner[low]
    ends = ((a, lower), (b, lower), (b, upper), (a, upper))
    corners = np.stack(
        [np.column_stack([points[p], table.height(side, height[p])]) for p, side in ends],
        axis=1,
    )
    return [_step_part(corners, owner[high], table)]


def _step_part(corners: np.ndarray, region: np.ndarray, table: _Table) -> Part:
    """Kerb quads; those of a region that look the same way in one cell share a site: a kerb is too low for more."""
    count = len(corners)
    faces = quads_to_triangles(np.arange(4 * count).reshape(-1, 4))
    vertices = corners.reshape(-1, 3)
    normals, area = face_normals(vertices, faces)
    way = (
        np.rint(np.arctan2(normals[::2, 1], normals[::2, 0]) * (_WAYS / (2 * np.pi))).astype(np.int64) % _WAYS
    )
    cell = np.floor(corners[:, :, :2].mean(axis=1) / _KERB_CELL_M).astype(np.int64)
    _, site = np.unique(np.column_stack([region, way, cell]), axis=0, return_inverse=True)
    site = site.ravel()
    weight = area[::2] + area[1::2]
    total = np.bincount(site, weight)

    def mean(values: np.ndarray) -> np.ndarray:
        return np.stack([np.bincount(site, weight * v) / total for v in values.T], axis=1)

    normal = mean(normals[::2])
    return Part(
        vertices=vertices,
        faces=faces,
        surface=np.repeat(table.surface[region], 2),
        semantic=np.repeat(table.semantic[region], 2),
        object=np.repeat(table.object[region], 2),
        corner_site=np.repeat(np.repeat(site, 2)[:, None], 3, axis=1),
        site_position=mean(corners.mean(axis=1)),
        site_normal=normal / np.linalg.norm(normal, axis=1)[:, None],
        site_standoff=np.full(len(total), STANDOFF_M),
    )
