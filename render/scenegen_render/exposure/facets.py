"""Averaging over neighbours on the same facet that see the same, exact for anything linear along it.

The error of tracing a finite number of directions differs from site to site, while sky view and irradiance mostly vary
smoothly along a wall or a street. Replacing a value by a plane fitted to it and its mesh neighbours shares their rays.
Where the surroundings really change from one site to the next (under a car, beside a chimney, below a parapet) the
neighbours disagree by more than their errors, and are left out: averaging all neighbours would lower the random error
of sky view by half, but add five times as much bias on a city's streets and roofs.
"""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np
from jaxtyping import Float32, Float64, Int64, UInt32
from scipy import sparse

from scenegen.world import World
from scenegen_render.exposure.directions import tangents
from scenegen_render.exposure.views import open_share

_SAME_PLANE = 0.97
"""Cosine between normals up to which two neighbours count as one facet (14 deg: rolling ground, not crowns)."""
_RIDGE = 1e-3
"""Damping of the slopes relative to the spread of the neighbours, for sites whose neighbours lie on one line."""
_AGREE = 4.0
"""Standard errors of sky view by which neighbours may differ and still be averaged."""


def sky_view_error(directions: int) -> float:
    """Standard error of the sky view of a site from so many directions, as measured in the city.

    The exponent is that of low-discrepancy points for areas with sharp edges.
    """
    return 0.38 * math.pow(directions, -0.75)


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
    def of(world: World, gather: UInt32[np.ndarray, "directions sites"]) -> FacetAverage:
        """Fit the operator to the mesh of a world and to what its sites see.

        Parameters
        ----------
        world : World
        gather : uint32 (directions, sites)
            The gather list; see `scenegen.exposure.Exposure`.
        """
        site, neighbour = _pairs(world, open_share(gather), _AGREE * sky_view_error(len(gather)))
        position, normal = world.sites.position, world.sites.normal
        first, second = tangents(normal, np.zeros(len(normal), np.float32))
        step = (position[neighbour] - position[site]).astype(np.float64)
        along = np.einsum("pk,pk->p", step, first[site])
        across = np.einsum("pk,pk->p", step, second[site])
        weight = _plane_weights(site, along, across, len(normal)).astype(np.float32)
        shape = (len(normal), len(normal))
        return FacetAverage(sparse.csr_array((weight, (site, neighbour)), shape=shape))

    def __call__(self, values: Float32[np.ndarray, "sites *any"]) -> Float32[np.ndarray, "sites *any"]:
        """Average once."""
        return np.asarray(self.weights @ values, np.float32)


def _pairs(
    world: World, view: Float32[np.ndarray, "sites"], tolerance: float
) -> tuple[Int64[np.ndarray, "pairs"], Int64[np.ndarray, "pairs"]]:
    """Ordered pairs of sites that share a mesh edge, a plane and a view of the sky, each site with itself included.

    Sorted, no repeats. Faces belong to one facet, so nothing is averaged across an edge.
    """
    sites = len(world.sites.area)
    corner = world.corner_site.astype(np.int64)
    a = np.concatenate([corner[:, 0], corner[:, 1], corner[:, 2]])
    b = np.concatenate([corner[:, 1], corner[:, 2], corner[:, 0]])
    alike = (a != b) & (np.abs(view[a] - view[b]) < np.float32(tolerance))
    a, b = a[alike], b[alike]
    level = np.einsum("pk,pk->p", world.sites.normal[a], world.sites.normal[b]) > _SAME_PLANE
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
