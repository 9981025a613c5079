"""The gather list: what every ray over the hemisphere of every site meets."""

from __future__ import annotations

import math
from typing import Any

import numpy as np
from jaxtyping import Float32, UInt32

from scenegen.exposure import SKY_BINS
from scenegen_render import backend
from scenegen_render.exposure.directions import cosine_directions, tangents
from scenegen_render.exposure.rays import SiteRays
from scenegen_render.scene import LoadedWorld

_BLOCK = 256
"""Sites that stay together for all directions: their surroundings stay in the cache (1.3 times faster than one
direction of the whole world at a time)."""
_LAUNCH_RAYS = 4_000_000
"""Rays of one launch: well below a second, so that an interrupt is answered."""


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
    places = max(_BLOCK, _LAUNCH_RAYS // directions // _BLOCK * _BLOCK)
    for first in range(0, sites, places):
        blocks = math.ceil(min(places, sites - first) / _BLOCK)
        fan.trace(met, first, blocks)
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
        self.first, self.second = mi.Float(first.reshape(-1)), mi.Float(second.reshape(-1))
        self.local = mi.Float(cosine_directions(directions).astype(np.float32).reshape(-1))
        self.directions = dr.opaque(mi.UInt, directions)
        self.sites = dr.opaque(mi.UInt, len(rays.order))

    def trace(self, met: Any, first: int, blocks: int) -> None:
        """Trace all directions of some blocks of sites and write what they meet."""
        mi, dr = backend.modules()
        lane = dr.arange(mi.UInt, blocks * _BLOCK * dr.slice(self.directions))
        row, column = lane // _BLOCK, lane % _BLOCK
        block = row // self.directions
        direction = row - block * self.directions
        place = dr.opaque(mi.UInt, first) + block * _BLOCK + column
        active = place < self.sites
        toward = self._toward(direction, place, active)
        hit = self.loaded.scene.ray_intersect_preliminary(
            self.rays.start(place, toward, active), coherent=False, active=active
        )
        valid = hit.is_valid()
        met_site = self.loaded.nearest_site(dr.select(valid, hit.prim_index, 0), hit.prim_uv)
        entry = dr.select(valid, met_site, self.sites + sky_bin(toward.z))
        target = direction * self.sites + dr.gather(mi.UInt, self.rays.site, place, active)
        dr.scatter(met, entry, target, active, mode=dr.ReduceMode.Permute)
        dr.eval(met)

    def _toward(self, direction: Any, place: Any, active: Any) -> Any:
        mi, dr = backend.modules()
        local = dr.gather(mi.Vector3f, self.local, direction, active)
        frame = [
            dr.gather(mi.Vector3f, axis, place, active)
            for axis in (self.first, self.second, self.rays.normal)
        ]
        return dr.normalize(frame[0] * local.x + frame[1] * local.y + frame[2] * local.z)


def sky_bin(sine: Any) -> Any:
    """Sky bin of a direction with this sine of elevation (a device array); 0 at and below the horizon."""
    mi, dr = backend.modules()
    return dr.minimum(mi.UInt(dr.sqrt(dr.maximum(sine, 0.0)) * SKY_BINS), SKY_BINS - 1)
