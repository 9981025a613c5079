"""The gather list: what every ray over the hemisphere of every site meets."""

from __future__ import annotations

from typing import Any

import numpy as np
from jaxtyping import Float32, UInt32

from scenegen.exposure import SKY_BINS
from scenegen_render import backend
from scenegen_render.exposure.directions import cosine_directions, tangents
from scenegen_render.exposure.lanes import Lanes, launches
from scenegen_render.exposure.rays import SiteRays
from scenegen_render.scene import LoadedWorld


def gather_list(
    loaded: LoadedWorld, rays: SiteRays, directions: int, turn: Float32[np.ndarray, "sites"]
) -> UInt32[np.ndarray, "directions sites"]:
    """Trace `directions` rays from each site and note the site or sky bin each one meets.

    A hit is noted as the site of the nearest corner, a miss as ``sites + bin``; see `scenegen.exposure.Exposure`.

    Parameters
    ----------
    loaded : LoadedWorld
    rays : SiteRays
    directions : int
    turn : float32 (sites,)
        Rotation of each site's directions about its normal, in turns. Neighbours with different turns have
        independent errors, which smoothing within the facet then averages out.
    """
    mi, dr = backend.modules()
    sites = len(rays.order)
    fan = _Fan(loaded, rays, directions, turn)
    met = dr.empty(mi.UInt, directions * sites)
    for lanes in launches(sites, directions):
        entry = fan.trace(lanes)
        target = lanes.row * fan.sites + dr.gather(mi.UInt, rays.site, lanes.place, lanes.active)
        dr.scatter(met, entry, target, lanes.active, mode=dr.ReduceMode.Permute)
        dr.eval(met)
    return np.asarray(met).reshape(directions, sites)


class _Fan:
    """One direction set, turned for each site, and the kernel that traces it."""

    def __init__(
        self, loaded: LoadedWorld, rays: SiteRays, directions: int, turn: Float32[np.ndarray, "sites"]
    ) -> None:
        mi, dr = backend.modules()
        self.loaded, self.rays = loaded, rays
        normal = loaded.world.sites.normal[rays.order]
        first, second = tangents(normal, turn[rays.order])
        self.first, self.second = backend.upload(first), backend.upload(second)
        self.local = backend.upload(cosine_directions(directions).astype(np.float32))
        self.sites = dr.opaque(mi.UInt, len(rays.order))

    def trace(self, lanes: Lanes) -> Any:
        """What each ray of a launch meets: a site, or the number of sites plus a sky bin."""
        _, dr = backend.modules()
        toward = self._toward(lanes)
        start = self.rays.start(lanes.place, toward, lanes.active)
        hit = self.loaded.scene.ray_intersect_preliminary(start, coherent=False, active=lanes.active)
        valid = hit.is_valid()
        site = self.loaded.nearest_site(dr.select(valid, hit.prim_index, 0), hit.prim_uv)
        return dr.select(valid, site, self.sites + sky_bin(toward.z))

    def _toward(self, lanes: Lanes) -> Any:
        mi, dr = backend.modules()
        local = dr.gather(mi.Vector3f, self.local, lanes.row, lanes.active)
        axes = (self.first, self.second, self.rays.normal)
        first, second, normal = (dr.gather(mi.Vector3f, axis, lanes.place, lanes.active) for axis in axes)
        return dr.normalize(first * local.x + second * local.y + normal * local.z)


def sky_bin(sine: Any) -> Any:
    """Sky bin of a direction with this sine of elevation (a device array); 0 at and below the horizon."""
    mi, dr = backend.modules()
    return dr.minimum(mi.UInt(dr.sqrt(dr.maximum(sine, 0.0)) * SKY_BINS), SKY_BINS - 1)
