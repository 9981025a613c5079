"""Averaging over neighbours on the same facet, exact for anything that varies linearly along it.

Sky view and irradiance vary smoothly along a plane face of a building or a stretch of ground, while the error of
tracing a finite number of directions differs from site to site. Replacing each value by a plane fitted to it and its
mesh neighbours shares their rays. Faces belong to one facet, so nothing is averaged across an edge.
"""

from __future__ import annotations

from dataclasses import dataclass
from weakref import WeakKeyDictionary

import numpy as np
from jaxtyping import Float32, Float64, Int64
from scipy import sparse

from scenegen.world import World
from scenegen_render.exposure.directions import tangents

_SAME_PLANE = 0.97
"""Cosine between normals up to which two neighbours count as one facet (14 deg: rolling ground, not crowns)."""
_RIDGE = 1e-3
"""Damping of the slopes relative to the spread of the neighbours, for sites whose neighbours lie on one line."""


@dataclass(frozen=True, eq=False)
class FacetAverage:
    """Linear operator on values at sites.

    Attributes
    ----------
    weights : scipy.sparse.csr_array (sites, sites)
        Rows sum to one.
    """

    weights: sparse.csr_array

    @staticmethod
    def of(world: World) -> FacetAverage:
        """Operator of a world's mesh; fitted once, kept as long as the world lives."""
        if world not in _FITTED:
            _FITTED[world] = FacetAverage._fit(world)
        return _FITTED[world]

    @staticmethod
    def _fit(world: World) -> FacetAverage:
        site, neighbour = _pairs(world)
        position, normal = world.sites.position, world.sites.normal
        first, second = tangents(normal, np.zeros(len(normal), np.float32))
        step = (position[neighbour] - position[site]).astype(np.float64)
        along = np.einsum("pk,pk->p", step, first[site])
        across = np.einsum("pk,pk->p", step, second[site])
        weight = _plane_weights(site, along, across, len(normal)).astype(np.float32)
        shape = (len(normal), len(normal))
        return FacetAverage(sparse.csr_array((weight, (site, neighbour)), shape=shape))

    def __call__(
        self, values: Float32[np.ndarray, "sites *any"], rounds: int
    ) -> Float32[np.ndarray, "sites *any"]:
        """Average `rounds` times."""
        for _ in range(rounds):
            values = self.weights @ values
        return np.asarray(values, np.float32)


def _pairs(world: World) -> tuple[Int64[np.ndarray, "pairs"], Int64[np.ndarray, "pairs"]]:
    """Ordered pairs of sites that share a mesh edge and a plane, each site with itself included; sorted, no repeats."""
    sites = len(world.sites.area)
    corner = world.corner_site.astype(np.int64)
    a = np.concatenate([corner[:, 0], corner[:, 1], corner[:, 2]])
    b = np.concatenate([corner[:, 1], corner[:, 2], corner[:, 0]])
    apart = a != b
    a, b = a[apart], b[apart]
    normal = world.sites.normal
    level = np.einsum("pk,pk->p", normal[a], normal[b]) > _SAME_PLANE
    a, b = a[level], b[level]
    own = np.arange(sites)
    row, column = np.concatenate([a, b, own]), np.concatenate([b, a, own])
    graph = sparse.csr_array((np.ones(len(row), np.int32), (row, column)), shape=(sites, sites))
    graph.sum_duplicates()
    return np.repeat(own, np.diff(graph.indptr)), graph.indices.astype(np.int64)


def _plane_weights(
    site: Int64[np.ndarray, "pairs"],
    x: Float64[np.ndarray, "pairs"],
    y: Float64[np.ndarray, "pairs"],
    sites: int,
) -> Float64[np.ndarray, "pairs"]:
    """Weights with which neighbours at (x, y) enter the least-squares plane, taken at each site's own place."""

    def total(of: Float64[np.ndarray, "pairs"]) -> Float64[np.ndarray, "sites"]:
        return np.bincount(site, weights=of, minlength=sites)

    n, sx, sy = np.bincount(site, minlength=sites).astype(np.float64), total(x), total(y)
    xx, xy, yy = total(x * x), total(x * y), total(y * y)
    ridge = _RIDGE * (xx + yy) + 1e-9
    xx, yy = xx + ridge, yy + ridge
    # First row of the inverse of [[n, sx, sy], [sx, xx, xy], [sy, xy, yy]], by cofactors.
    c0, c1, c2 = xx * yy - xy * xy, xy * sy - sx * yy, sx * xy - xx * sy
    determinant = n * c0 + sx * c1 + sy * c2
    c0, c1, c2 = c0 / determinant, c1 / determinant, c2 / determinant
    weight = c0[site] + c1[site] * x + c2[site] * y
    return np.asarray(weight / total(weight)[site])


_FITTED: WeakKeyDictionary[World, FacetAverage] = WeakKeyDictionary()
