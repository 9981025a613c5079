"""Where the rays of the sites start, on the device, in an order that keeps neighbours together."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np
from jaxtyping import Float32, Int64

from scenegen.world import World
from scenegen_render import backend
from scenegen_render.exposure.order import spatial_order

_LIFT_M = 2e-3
"""Origins are lifted along the normal, well above the rounding of float32 coordinates at 1 km (0.06 mm)."""
CONTACT_INSET_M = 0.02
"""For the sun, whose shadow edges must stay where they are: origins on the border of a facet move just so far inwards
that a site on the line where ground meets wall does not start inside the wall's plane and look through it."""
CELL_INSET_M = 0.4
"""For the hemisphere: a border site stands for the cells along its border. What it saw on the very line, half of it
wall, would be interpolated far into the cell; measured on a city, this inset takes a tenth off the error of the bounce,
a third on flat roofs behind parapets."""
_INSET_SHARE = 0.3
"""Never farther than this share of the way to the middle of the faces around the site."""
_LUMP_M = 0.05
"""A larger standoff marks a lumped site (crown, car), which has no border."""


@dataclass(frozen=True, eq=False)
class SiteRays:
    """Ray origins of all sites, or of some, in spatial order.

    Attributes
    ----------
    order : int64 (places,)
        Site at each place of the order.
    site : mitsuba.UInt
        Column of each place in a gather list, on the device: the site, or its number among some.
    origin, normal : mitsuba.Float, 3 per site
        Lifted position [m] and unit normal, packed.
    standoff : mitsuba.Float
        [m] along the ray.
    """

    order: Int64[np.ndarray, "places"]
    site: Any
    origin: Any
    normal: Any
    standoff: Any

    @staticmethod
    def of(world: World) -> tuple[SiteRays, SiteRays]:
        """Sort the sites and put their ray origins on the device: those for the sun, and those for the hemisphere."""
        sites = world.sites
        order = spatial_order(sites.position)
        inward, room = _inward(world, slice(None))
        normal, standoff = backend.upload(sites.normal[order]), backend.upload(sites.standoff[order])
        index = backend.upload(order.astype(np.uint32))

        def inset(farthest_m: float) -> SiteRays:
            origin = _origins(world, inward, room, farthest_m)
            return SiteRays(order, index, backend.upload(origin[order]), normal, standoff)

        return inset(CONTACT_INSET_M), inset(CELL_INSET_M)

    @staticmethod
    def of_some(world: World, *chosen: Int64[np.ndarray, "_"]) -> tuple[SiteRays, ...]:
        """Rays over the hemispheres of some sites, the same as `of` gives; one answer for each of several choices."""
        sites = world.sites
        touched = np.zeros(len(sites.area), bool)
        for some in chosen:
            touched[some] = True
        a, b, c = world.corner_site.T
        inward, room = _inward(world, np.flatnonzero(touched[a] | touched[b] | touched[c]))
        origin = _origins(world, inward, room, CELL_INSET_M)

        def pick(some: Int64[np.ndarray, "_"]) -> SiteRays:
            order = some[spatial_order(sites.position[some])]
            column = np.arange(len(order), dtype=np.uint32)
            kept = (column, origin[order], sites.normal[order], sites.standoff[order])
            return SiteRays(order, *map(backend.upload, kept))

        return tuple(pick(some) for some in chosen)

    def start(self, place: Any, direction: Any, active: Any) -> Any:
        """Rays from places of the order.

        Parameters
        ----------
        place : mitsuba.UInt
        direction : mitsuba.Vector3f
        active : mitsuba.Bool
        """
        mi, dr = backend.modules()
        origin = dr.gather(mi.Point3f, self.origin, place, active)
        return mi.Ray3f(origin + direction * dr.gather(mi.Float, self.standoff, place, active), direction)


def _origins(
    world: World,
    inward: Float32[np.ndarray, "sites 3"],
    room: Float32[np.ndarray, "sites"],
    farthest_m: float,
) -> Float32[np.ndarray, "sites 3"]:
    """Lifted and, on the border of a facet, moved at most so far inwards [m]."""
    lifted = world.sites.position + np.float32(_LIFT_M) * world.sites.normal
    return np.asarray(lifted + np.minimum(np.float32(farthest_m), room)[:, None] * inward)


def _inward(
    world: World, chosen: slice | Int64[np.ndarray, "some"]
) -> tuple[Float32[np.ndarray, "sites 3"], Float32[np.ndarray, "sites"]]:
    """Where origins on the border of a facet may move, along the facet towards the middle of the faces around them.

    Parameters
    ----------
    world : World
    chosen : slice or int64 (some,)
        Faces to look at; the answer holds for sites all of whose faces are among them.

    Returns
    -------
    direction : float32 (sites, 3)
        Unit vector; zero inside a facet.
    room : float32 (sites,)
        How far at most [m]; zero for lumped sites.
    """
    sites, vertices, faces = world.sites, world.mesh.vertices, world.mesh.faces[chosen]
    middle = (vertices[faces[:, 0]] + vertices[faces[:, 1]] + vertices[faces[:, 2]]) / np.float32(3.0)
    corner = world.corner_site[chosen].reshape(-1)
    count = np.maximum(np.bincount(corner, minlength=len(sites.area)), 1)
    shift = np.empty((len(sites.area), 3))
    for axis in range(3):
        total = np.bincount(corner, weights=np.repeat(middle[:, axis], 3), minlength=len(sites.area))
        shift[:, axis] = total / count - sites.position[:, axis]
    shift -= np.einsum("sk,sk->s", shift, sites.normal)[:, None] * sites.normal
    length = np.linalg.norm(shift, axis=1)
    room = np.where(sites.standoff < _LUMP_M, _INSET_SHARE * length, 0.0)
    direction = shift / np.maximum(length, 1e-9)[:, None]
    return np.asarray(direction, np.float32), np.asarray(room, np.float32)
