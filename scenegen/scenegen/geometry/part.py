"""A part: some triangles, what they are, and where their heat lives; parts are merged into a world."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from jaxtyping import Float64, Int64

STANDOFF_M = 0.005
"""Where exposure rays of an ordinary facet start [m]."""

LUMP_STANDOFF_M = 0.15
"""The same for a site that stands for a lump (crown, shrub, tube, tyres): thicker than the posts and gaps it must
not see, less than its height above ground."""

_BLOCK = 16_384


@dataclass(frozen=True, eq=False)
class Part:
    """Triangles and their thermal sites, indices local to the part.

    Attributes
    ----------
    vertices : float64 (vertices, 3)
        [m], ENU.
    faces : int64 (faces, 3)
        Counter-clockwise seen from outside.
    surface, semantic, object : int64 (faces,)
        Palette index, `scenegen.classes.Semantic` and instance id of each face.
    corner_site : int64 (faces, 3)
        Site of each corner.
    site_position, site_normal : float64 (sites, 3)
        [m] and outward unit vectors.
    site_standoff : float64 (sites,)
        [m], see `scenegen.world.Sites`.
    """

    vertices: Float64[np.ndarray, "vertices 3"]
    faces: Int64[np.ndarray, "faces 3"]
    surface: Int64[np.ndarray, "faces"]
    semantic: Int64[np.ndarray, "faces"]
    object: Int64[np.ndarray, "faces"]
    corner_site: Int64[np.ndarray, "faces 3"]
    site_position: Float64[np.ndarray, "sites 3"]
    site_normal: Float64[np.ndarray, "sites 3"]
    site_standoff: Float64[np.ndarray, "sites"]


def concatenate(parts: Sequence[Part]) -> Part:
    """Merge parts in the order given."""
    vertex = np.cumsum([0, *(len(p.vertices) for p in parts)])
    site = np.cumsum([0, *(len(p.site_position) for p in parts)])
    return Part(
        vertices=np.concatenate([p.vertices for p in parts]),
        faces=np.concatenate([p.faces + offset for p, offset in zip(parts, vertex[:-1], strict=True)]),
        surface=np.concatenate([p.surface for p in parts]),
        semantic=np.concatenate([p.semantic for p in parts]),
        object=np.concatenate([p.object for p in parts]),
        corner_site=np.concatenate(
            [p.corner_site + offset for p, offset in zip(parts, site[:-1], strict=True)]
        ),
        site_position=np.concatenate([p.site_position for p in parts]),
        site_normal=np.concatenate([p.site_normal for p in parts]),
        site_standoff=np.concatenate([p.site_standoff for p in parts]),
    )


def face_normals(
    vertices: Float64[np.ndarray, "vertices 3"], faces: Int64[np.ndarray, "faces 3"]
) -> tuple[Float64[np.ndarray, "faces 3"], Float64[np.ndarray, "faces"]]:
    """Unit normals and areas [m^2]; a face without area has a zero normal."""
    cross = _doubled_area_vectors(_columns(vertices), faces)
    length = np.sqrt((cross**2).sum(axis=0))
    return (cross / np.maximum(length, 1e-300)).T, 0.5 * length


def face_areas(
    vertices: Float64[np.ndarray, "vertices 3"], faces: Int64[np.ndarray, "faces 3"]
) -> Float64[np.ndarray, "faces"]:
    """Areas [m^2], a block of faces at a time: fresh memory for a world's would take longer than the sums."""
    columns, area = _columns(vertices), np.empty(len(faces))
    for start in range(0, len(faces), _BLOCK):
        block = slice(start, start + _BLOCK)
        x, y, z = _doubled_area_vectors(columns, faces[block])
        area[block] = 0.5 * np.sqrt(x * x + y * y + z * z)
    return area


def _columns(vertices: np.ndarray) -> list[np.ndarray]:
    return [np.ascontiguousarray(vertices[:, k]) for k in range(3)]


def _doubled_area_vectors(columns: list[np.ndarray], faces: np.ndarray) -> np.ndarray:
    """Cross products of two edges, (3, faces); by column, which is much faster than rows of three."""
    i, j, k = (np.ascontiguousarray(faces[:, n]) for n in range(3))
    origin = [c[i] for c in columns]
    ux, uy, uz = (c[j] - o for c, o in zip(columns, origin, strict=True))
    vx, vy, vz = (c[k] - o for c, o in zip(columns, origin, strict=True))
    return np.stack([uy * vz - uz * vy, uz * vx - ux * vz, ux * vy - uy * vx])
