"""Diffuse in-band irradiance of every site: what a matt surface has to reflect into a long-wave camera.

Tracing a random bounce per pixel would leave half a kelvin of grain. Instead each site sums what the rays of its
gather list meet, once per thermal state:

    L = eps B(T) + (1 - eps) E / pi,      E / pi = mean over the list of L (sites) and L_sky (sky bins)

repeated a few times from E = pi B(T). Everything is carried as a deviation from one reference radiance, so that an
isothermal world is exact to rounding and long float32 sums keep their digits.
"""

from __future__ import annotations

import math
from functools import cache

import numpy as np
from jaxtyping import Float32, Float64
from scipy.interpolate import CubicHermiteSpline

from scenegen.exposure import Exposure, sky_bin_sin_elevation
from scenegen.radiometry.atmosphere import Atmosphere
from scenegen.radiometry.planck import band_radiance, band_radiance_slope
from scenegen.radiometry.sky import sky_radiance
from scenegen.thermal_state import ThermalState
from scenegen_render import backend
from scenegen_render.exposure.views import mean_over_list
from scenegen_render.scene import LoadedWorld

_BOUNCES = 3
"""Passes over the list. Each shrinks what is missing by the mean reflectance of the surroundings (0.03-0.1)."""


def bake(
    loaded: LoadedWorld,
    exposure: Exposure,
    state: ThermalState,
    band_um: tuple[float, float],
) -> Float32[np.ndarray, "sites"]:
    """Diffuse irradiance of each site in a band [W m^-2].

    Parameters
    ----------
    loaded : LoadedWorld
    exposure : Exposure
        Of the same world.
    state : ThermalState
        Temperatures and air; clouds enter by their mean cover.
    band_um : (float, float)
        Spectral band of the camera [um].
    """
    mi, dr = backend.modules()
    world = loaded.world
    directions, _ = exposure.gather.shape
    emitted = _planck(band_um)(state.temperature_K)
    reference = float(emitted[0])
    emissivity = np.array([s.emissivity for s in world.palette], np.float32)[world.sites.surface]
    own = (emitted - reference).astype(np.float32)
    sky = (_sky(state.atmosphere, band_um) - reference).astype(np.float32)
    gather, table = backend.upload(exposure.gather), backend.upload(np.concatenate([own, sky]))
    emission, reflectance = backend.upload(emissivity * own), backend.upload(1.0 - emissivity)
    site = dr.arange(mi.UInt, len(own))
    for bounce in range(_BOUNCES):
        incoming = mean_over_list(gather, table, directions)
        if bounce + 1 < _BOUNCES:
            dr.scatter(table, dr.fma(reflectance, incoming, emission), site)
            dr.eval(table)
    met = np.array(incoming)
    if exposure.smoother is not None:
        met = np.asarray(exposure.smoother @ met, np.float32)
    for closer in exposure.closer:
        met[closer.site] = mean_over_list(backend.upload(closer.gather), table, len(closer.gather))
    return np.asarray(math.pi * (met.astype(np.float64) + reference), np.float32)


@cache
def _planck(band_um: tuple[float, float]) -> CubicHermiteSpline:
    """B(T) on 150-1000 K: cubic pieces of 1 K through exact values and slopes, 1e-9 relative and fast on many sites."""
    T = np.arange(150.0, 1001.0)
    return CubicHermiteSpline(T, band_radiance(T, band_um), band_radiance_slope(T, band_um))


def _sky(atmosphere: Atmosphere, band_um: tuple[float, float]) -> Float64[np.ndarray, "bins"]:
    """Radiance of each sky bin; bin 0 is ground beyond the edge of the world."""
    sine = sky_bin_sin_elevation()
    sine[0] = -1.0
    return sky_radiance(sine, atmosphere, band_um)
