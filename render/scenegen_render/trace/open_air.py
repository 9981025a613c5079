"""Diffuse in-band irradiance of movers: the open sky above, the mean ground below.

What they reflect is a few per cent; where exactly in the world they are would change it by millikelvins of
brightness, but by jumps.
"""

from __future__ import annotations

import math

import numpy as np
from jaxtyping import Float32, Float64

from scenegen.materials.material import Build
from scenegen.movers.company import Company
from scenegen.radiometry.atmosphere import Atmosphere
from scenegen.radiometry.planck import band_radiance
from scenegen.radiometry.sky import sky_radiance
from scenegen.thermal_state import ThermalState
from scenegen.world import World

_BELOW = frozenset({Build.GROUND, Build.CANOPY_GROUND, Build.WATER})
_TILTS = np.linspace(-1.0, 1.0, 33)


def irradiance(
    company: Company,
    world: World,
    state: ThermalState,
    of_world: Float32[np.ndarray, "world_sites"],
    band_um: tuple[float, float],
) -> Float32[np.ndarray, "sites"]:
    """Irradiance of the sites of a company in a band [W m^-2]; by the tilt of their normals alone.

    Parameters
    ----------
    company : Company
    world : World
    state : ThermalState
        Of the world.
    of_world : float32 (world_sites,)
        Irradiance of the world's own sites, which the ground reflects.
    band_um : (float, float)
    """
    if not company.movers:
        return np.zeros(0, np.float32)
    table = _from_sky(_TILTS, state.atmosphere, band_um)
    ground = math.pi * _ground(world, state, of_world, band_um)
    tilt = company.body.site_normal[:, 2]
    return np.asarray(np.interp(tilt, _TILTS, table) + 0.5 * (1.0 - tilt) * ground, np.float32)


def _from_sky(
    cos_tilt: Float64[np.ndarray, "tilts"], atmosphere: Atmosphere, band_um: tuple[float, float]
) -> Float64[np.ndarray, "tilts"]:
    """Irradiance from the sky on tilted surfaces: midpoint rule over elevation and azimuth, 32 x 64 directions."""
    sine = ((np.arange(32) + 0.5) / 32)[:, None]
    azimuth = 2.0 * np.pi * (np.arange(64) + 0.5) / 64
    falling = sky_radiance(sine[:, 0], atmosphere, band_um)
    level = np.sqrt(1.0 - sine**2) * np.cos(azimuth)
    flat = np.sqrt(np.maximum(1.0 - cos_tilt**2, 0.0))
    cosine = np.maximum(cos_tilt[:, None, None] * sine + flat[:, None, None] * level, 0.0)
    return np.asarray(np.einsum("tea,e->t", cosine, falling) * (2.0 * np.pi / cosine[0].size))


def _ground(
    world: World,
    state: ThermalState,
    of_world: Float32[np.ndarray, "world_sites"],
    band_um: tuple[float, float],
) -> float:
    """Mean radiance of ground and water [W m^-2 sr^-1]; of everything where there is none."""
    lies = np.array([s.material.build in _BELOW for s in world.palette])[world.sites.surface]
    sites = np.flatnonzero(lies) if lies.any() else np.arange(len(lies))
    area = world.sites.area[sites].astype(np.float64)
    eps = np.array([s.emissivity for s in world.palette])[world.sites.surface[sites]]
    emitted = band_radiance(state.temperature_K[sites].astype(np.float64), band_um)
    leaving = eps * emitted + (1.0 - eps) * of_world[sites] / math.pi
    return float(np.einsum("s,s->", area, leaving) / area.sum())
