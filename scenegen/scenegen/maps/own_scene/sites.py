"""Where heat lives in a scene that knows nothing of it: at the vertices of large surfaces, in lumps of small ones.

A vertex of a large surface is a site, with the normal of that surface there. Where vertices lie closer than half the
spacing, one of them stands for all. Surfaces smaller than a square of the spacing (leaves, railings, steps) are lumped:
one site for all that lie close together in one object and look the same way.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from jaxtyping import Bool, Float64, Int64

from scenegen.geometry.part import STANDOFF_M

MAX_SITES = 300_000

LUMP_STANDOFF_M = 0.06
"""Where rays of a lump start [m]: beyond the leaf or the board they start on."""

_GROWTH = 1.25


@dataclass(frozen=True, eq=False)
class Placement:
    """Sites of a mesh.

    Attributes
    ----------
    corner_site : int64 (faces, 3)
    position, normal : float64 (sites, 3)
        On the mesh [m]; unit vectors.
    standoff : float64 (sites,)
        [m], see `scenegen.world.Sites`.
    """

    corner_site: Int64[np.ndarray, "faces 3"]
    position: Float64[np.ndarray, "sites 3"]
    normal: Float64[np.ndarray, "sites 3"]
    standoff: Float64[np.ndarray, "sites"]


@dataclass(frozen=True, eq=False)
class Skin:
    """A mesh with what decides its sites.

    Attributes
    ----------
    vertices : float64 (vertices, 3)
    faces : int64 (faces, 3)
    normal : float64 (faces, 3)
    area : float64 (faces,)
        [m^2].
    facet : int64 (faces,)
        Smooth surface of each face.
    group : int64 (faces,)
        Object and material of each face as one number.
    """

    vertices: Float64[np.ndarray, "vertices 3"]
    faces: Int64[np.ndarray, "faces 3"]
    normal: Float64[np.ndarray, "faces 3"]
    area: Float64[np.ndarray, "faces"]
    facet: Int64[np.ndarray, "faces"]
    group: Int64[np.ndarray, "faces"]


def place_sites(skin: Skin, spacing_m: float, most: int = MAX_SITES) -> Placement:
    """Place at most `most` sites, `spacing_m` apart or, if that makes too many, farther."""
    large = np.bincount(skin.facet, skin.area)[skin.facet] >= spacing_m**2
    while True:
        surface, lumps = _on_surfaces(skin, large, spacing_m / 2), _in_lumps(skin, ~large, spacing_m)
        if len(surface.position) + len(lumps.position) <= most:
            break
        spacing_m *= _GROWTH
        large = large & (np.bincount(skin.facet, skin.area)[skin.facet] >= spacing_m**2)
    corner_site = np.empty(skin.faces.shape, np.int64)
    corner_site[large] = surface.corner_site
    corner_site[~large] = lumps.corner_site + len(surface.position)
    return Placement(
        corner_site,
        np.concatenate([surface.position, lumps.position]),
        np.concatenate([surface.normal, lumps.normal]),
        np.concatenate([surface.standoff, lumps.standoff]),
    )


def _on_surfaces(skin: Skin, chosen: Bool[np.ndarray, "faces"], cell_m: float) -> Placement:
    faces, facet, area, face_normal = (a[chosen] for a in (skin.faces, skin.facet, skin.area, skin.normal))
    corners = facet.repeat(3) * len(skin.vertices) + faces.ravel()
    own, corner = np.unique(corners, return_inverse=True)
    corner = corner.ravel()
    normal = _unit(_summed(corner, len(own), (face_normal * area[:, None]).repeat(3, axis=0)))
    place = skin.vertices[own % max(len(skin.vertices), 1)]
    cluster, count = _codes(own // max(len(skin.vertices), 1), _voxel(place, cell_m), _towards(normal))
    mean = _summed(cluster, count, place) / np.maximum(np.bincount(cluster, minlength=count), 1)[:, None]
    chief = _nearest(cluster, count, np.linalg.norm(place - mean[cluster], axis=1))
    together = _unit(_summed(cluster, count, normal))
    return Placement(cluster[corner].reshape(-1, 3), place[chief], together, np.full(count, STANDOFF_M))


def _in_lumps(skin: Skin, chosen: Bool[np.ndarray, "faces"], cell_m: float) -> Placement:
    faces, group, area, face_normal = (a[chosen] for a in (skin.faces, skin.group, skin.area, skin.normal))
    middle = skin.vertices[faces].mean(axis=1)
    axis = np.argmax(np.abs(face_normal), axis=1)
    side = 2 * axis + (np.take_along_axis(face_normal, axis[:, None], axis=1)[:, 0] < 0)
    cluster, count = _codes(group, _voxel(middle, cell_m), side)
    total = np.bincount(cluster, area, count)[:, None]
    mean = _summed(cluster, count, middle * area[:, None]) / total
    chief = _nearest(cluster, count, np.linalg.norm(middle - mean[cluster], axis=1))
    normal = _unit(_summed(cluster, count, face_normal * area[:, None]))
    return Placement(
        np.repeat(cluster[:, None], 3, axis=1), middle[chief], normal, np.full(count, LUMP_STANDOFF_M)
    )


def _codes(*keys: np.ndarray) -> tuple[np.ndarray, int]:
    """Number the different combinations of whole-numbered keys; returns the number of each row and how many."""
    code = np.zeros(len(keys[0]), np.int64)
    count = 1
    for key in keys:
        values, rank = np.unique(key, return_inverse=True)
        present, code = np.unique(code * max(len(values), 1) + rank.ravel(), return_inverse=True)
        code, count = code.ravel(), len(present)
    return code, count if len(code) else 0


def _voxel(place: Float64[np.ndarray, "places 3"], cell_m: float) -> Int64[np.ndarray, "places"]:
    """Number of the cube a place lies in."""
    cell = np.floor(place / cell_m).astype(np.int64)
    return np.asarray(((cell[:, 0] << 42) ^ ((cell[:, 1] & 0x1FFFFF) << 21)) ^ (cell[:, 2] & 0x1FFFFF))


def _towards(normal: Float64[np.ndarray, "places 3"]) -> Int64[np.ndarray, "places"]:
    """One of 54 solid angles: nine on each side of a cube."""
    axis = np.argmax(np.abs(normal), axis=1)
    chief = np.take_along_axis(normal, axis[:, None], axis=1)
    share = np.take_along_axis(normal, (axis[:, None] + [1, 2]) % 3, axis=1) / np.maximum(
        np.abs(chief), 1e-12
    )
    # Shifted off the axes, where most normals of most scenes lie and rounding would decide.
    third = np.clip(np.floor((share + 1.0) * 1.5 + 0.013), 0, 2).astype(np.int64)
    return np.asarray((2 * axis + (chief[:, 0] < 0)) * 9 + third[:, 0] * 3 + third[:, 1])


def _nearest(
    cluster: Int64[np.ndarray, "members"], count: int, distance: Float64[np.ndarray, "members"]
) -> Int64[np.ndarray, "clusters"]:
    """First of the members with the least distance in each cluster."""
    order = np.lexsort((np.arange(len(cluster)), np.round(distance, 6), cluster))
    first = np.searchsorted(cluster[order], np.arange(count))
    return np.asarray(order[first])


def _summed(
    cluster: Int64[np.ndarray, "members"], count: int, values: Float64[np.ndarray, "members 3"]
) -> Float64[np.ndarray, "clusters 3"]:
    columns = [np.bincount(cluster, values[:, k], count) for k in range(3)]
    return np.stack(columns, axis=1).astype(np.float64)  # counts of nothing are whole numbers


def _unit(vectors: Float64[np.ndarray, "rows 3"]) -> Float64[np.ndarray, "rows 3"]:
    """Normalised; up where opposite directions cancel."""
    length = np.linalg.norm(vectors, axis=1, keepdims=True)
    return np.where(length > 1e-12, vectors / np.maximum(length, 1e-12), [0.0, 0.0, 1.0])
