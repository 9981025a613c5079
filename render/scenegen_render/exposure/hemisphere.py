"""The gather list: what every ray over the hemisphere of every site meets."""

from __future__ import annotations

import math
from typing import Any

import numpy as np
from jaxtyping import Float32, UInt32

from scenegen.exposure import SKY_BINS
from scenegen_render import backend
from scenegen_render.exposure.directions import cosine_directions, split_directions, tangents, upright_frame
from scenegen_render.exposure.lanes import Lanes, Together, launches
from scenegen_render.exposure.rays import SiteRays
from scenegen_render.scene import LoadedWorld

_WALL = 0.05
"""Largest vertical part of the normal of a wall (3 deg)."""
_SECTORS = 8
"""Directions are traced sector by sector of the azimuth, so that rays of one packet look the same way."""


def gather_list(
    loaded: LoadedWorld, rays: SiteRays, directions: int, turn: Float32[np.ndarray, "sites"]
) -> UInt32[np.ndarray, "directions some"]:
    """Trace `directions` rays from each site of `rays` and note the site or sky bin each one meets.

    A hit is noted as the site of the nearest corner, a miss as ``sites + bin``; see `scenegen.exposure.Exposure`.

    Parameters
    ----------
    loaded : LoadedWorld
    rays : SiteRays
        Of all sites of the world, or of some.
    directions : int
    turn : float32 (sites,)
        Of all sites of the world: rotation of each one's directions about its normal, in turns. Neighbours with
        different turns have independent errors, which smoothing within the facet then averages out.
    """
    mi, dr = backend.modules()
    sites = len(rays.order)
    fan = _Fan(loaded, rays, directions, turn)
    met = dr.empty(mi.UInt, directions * sites)
    for lanes in launches(sites, directions, Together.ROWS_OF_A_PLACE):
        entry = fan.trace(lanes)
        target = lanes.row * fan.columns + dr.gather(mi.UInt, rays.site, lanes.place, lanes.active)
        dr.scatter(met, entry, target, lanes.active, mode=dr.ReduceMode.Permute)
        dr.eval(met)
    return np.asarray(met).reshape(directions, sites)


class _Fan:
    """The direction sets, turned for each site, and the kernel that traces them."""

    def __init__(
        self, loaded: LoadedWorld, rays: SiteRays, directions: int, turn: Float32[np.ndarray, "sites"]
    ) -> None:
        mi, dr = backend.modules()
        self.loaded, self.rays = loaded, rays
        normal = loaded.world.sites.normal[rays.order]
        wall = np.abs(normal[:, 2]) < _WALL
        axes = zip(upright_frame(normal), tangents(normal, np.zeros(len(normal), np.float32)), strict=True)
        first, second = (np.where(wall[:, None], upright, plain) for upright, plain in axes)
        self.first, self.second = backend.upload(first), backend.upload(second)
        self.turn = backend.upload(np.stack([turn[rays.order], wall.astype(np.float32)], axis=1))
        spiral, split = cosine_directions(directions), split_directions(directions)
        whole = np.arctan2(spiral[:, 1], spiral[:, 0]) / (2.0 * np.pi) % 1.0
        sector = np.lexsort((spiral[:, 2], np.floor(whole * _SECTORS)))
        self.spiral = backend.upload(np.stack([spiral[:, 2], whole], axis=1)[sector].astype(np.float32))
        sector = np.lexsort((split[:, 0], np.floor(split[:, 1] * (_SECTORS // 2)), split[:, 2]))
        self.split = backend.upload(split[sector].astype(np.float32))
        self.columns = dr.opaque(mi.UInt, len(rays.order))
        self.sites = dr.opaque(mi.UInt, len(turn))

    def trace(self, lanes: Lanes) -> Any:
        """What each ray of a launch meets: a site, or the number of sites plus a sky bin."""
        _, dr = backend.modules()
        toward = self._toward(lanes)
        start = self.rays.start(lanes.place, toward, lanes.active)
        hit = self.loaded.scene.ray_intersect_preliminary(start, coherent=True, active=lanes.active)
        valid = hit.is_valid()
        site = self.loaded.nearest_site(dr.select(valid, hit.prim_index, 0), hit.prim_uv)
        return dr.select(valid, site, self.sites + sky_bin(toward.z))

    def _toward(self, lanes: Lanes) -> Any:
        """World direction of each ray: its place on the disc, by the set that suits the site, then the site's frame."""
        mi, dr = backend.modules()
        own = dr.gather(mi.Vector2f, self.turn, lanes.place, lanes.active)
        spiral = dr.gather(mi.Vector2f, self.spiral, lanes.row, lanes.active)
        split = dr.gather(mi.Vector3f, self.split, lanes.row, lanes.active)
        wall, along = own.y > 0.5, split.y + own.x
        half_circle = math.pi * (along - dr.floor(along) + split.z)
        azimuth = dr.select(wall, half_circle, (2.0 * math.pi) * (spiral.y + own.x))
        height = dr.select(wall, split.x, spiral.x)
        sine, cosine = dr.sincos(azimuth)
        radius = dr.sqrt(dr.maximum(1.0 - height * height, 0.0))
        axes = (self.first, self.second, self.rays.normal)
        first, second, normal = (dr.gather(mi.Vector3f, axis, lanes.place, lanes.active) for axis in axes)
        return dr.normalize(first * (radius * cosine) + second * (radius * sine) + normal * height)


def sky_bin(sine: Any) -> Any:
    """Sky bin of a direction with this sine of elevation (a device array); 0 at and below the horizon."""
    mi, dr = backend.modules()
    return dr.minimum(mi.UInt(dr.sqrt(dr.maximum(sine, 0.0)) * SKY_BINS), SKY_BINS - 1)
