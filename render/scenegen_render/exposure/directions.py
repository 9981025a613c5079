"""Directions over the hemisphere of a site: equal cosine weight each, low discrepancy, exact under a level sky."""

from __future__ import annotations

from functools import cache

import numpy as np
from jaxtyping import Float32, Float64
from scipy.optimize import fsolve

from scenegen.radiometry.sky import air_mass

_GOLDEN = (np.sqrt(5.0) - 1.0) / 2.0
_MIDDLE, _DRY, _HUMID = 0.12, 0.10, 0.25
"""Optical depths of clear skies in the long-wave window: in between, and two that are reproduced exactly."""
_POWER = 0.788
"""Exponent of the air mass in them."""
_FINE = 512


@cache
def cosine_directions(count: int) -> Float64[np.ndarray, "count 3"]:
    """Unit vectors about +z, each standing for the share 1/count of the cosine-weighted hemisphere.

    Golden-angle spiral on the projected disc ("sunflower"): the disc is cut into rings of equal area, one direction
    each. Sky radiance rises steeply towards the horizon, so that a direction in the middle of its ring would not stand
    for the ring. Each direction lies where a middling clear sky has its ring mean, and the two lowest are moved within
    their rings until a dry and a humid sky are integrated exactly: the irradiance of an unobstructed horizontal site is
    then right to 1e-4 under any clear sky, from 64 directions on.
    """
    height = _heights(count)
    azimuth = 2.0 * np.pi * ((np.arange(count) * _GOLDEN) % 1.0)
    radius = np.sqrt(1.0 - height**2)
    found = np.stack([radius * np.cos(azimuth), radius * np.sin(azimuth), height], axis=1)
    found.flags.writeable = False
    return found


def _heights(count: int) -> Float64[np.ndarray, "count"]:
    """Sine of the elevation of each direction, rising."""
    share = np.linspace(0.0, 1.0, count * _FINE + 1)
    fine = np.sqrt(0.5 * (share[1:] + share[:-1]))
    sine = np.linspace(0.0, 1.0, 200_001)
    ring_mean = _reference_sky(fine, _MIDDLE).reshape(count, _FINE).mean(axis=1)
    height = np.interp(-ring_mean, -_reference_sky(sine, _MIDDLE), sine)
    exact = [float(_reference_sky(fine, depth).mean()) for depth in (_DRY, _HUMID)]

    def surplus(lowest: Float64[np.ndarray, "2"]) -> list[float]:
        moved = np.concatenate([lowest, height[2:]])
        means = [float(_reference_sky(moved, depth).mean()) for depth in (_DRY, _HUMID)]
        return [found / wanted - 1.0 for found, wanted in zip(means, exact, strict=True)]

    height[:2] = fsolve(surplus, height[:2])
    return np.asarray(np.round(height, 10))


def _reference_sky(sine: Float64[np.ndarray, "samples"], depth: float) -> Float64[np.ndarray, "samples"]:
    """Emissivity of a reference sky, falling with the sine of the elevation."""
    return np.asarray(1.0 - np.exp(-depth * air_mass(sine) ** _POWER))


@cache
def split_directions(count: int) -> Float64[np.ndarray, "count 3"]:
    """The same for walls: half of the directions above the horizontal plane through the normal, half below.

    A wall's horizon cuts its hemisphere in two equal parts, sky and hot ground; a plain spiral puts one direction more
    or less into each at random, which was the largest error of a wall's temperature.

    Returns
    -------
    float64 (count, 3)
        Sine of the angle to the wall's plane; place within the half circle, 0..1, to which each site adds its own
        turn; 0 for the upper and 1 for the lower half.
    """
    half = np.arange(count) % 2
    ring, rings = np.arange(count) // 2, np.where(half == 0, (count + 1) // 2, count // 2)
    height = np.sqrt((ring + 0.5) / rings)
    found = np.stack([height, (ring * _GOLDEN + 0.5 * half * _GOLDEN) % 1.0, half], axis=1)
    found.flags.writeable = False
    return found


def upright_frame(
    normal: Float32[np.ndarray, "sites 3"],
) -> tuple[Float32[np.ndarray, "sites 3"], Float32[np.ndarray, "sites 3"]]:
    """Horizontal and upward unit vectors in the planes of walls (of anything, for normals that are not vertical)."""
    n = normal.astype(np.float64)
    length = np.maximum(np.hypot(n[:, 0], n[:, 1]), 1e-9)
    level = np.stack([-n[:, 1] / length, n[:, 0] / length, np.zeros(len(n))], axis=1)
    return level.astype(np.float32), np.cross(n, level).astype(np.float32)


def tangents(
    normal: Float32[np.ndarray, "sites 3"], turn: Float32[np.ndarray, "sites"]
) -> tuple[Float32[np.ndarray, "sites 3"], Float32[np.ndarray, "sites 3"]]:
    """Two unit vectors that complete each normal to a right-handed frame, turned about it.

    Parameters
    ----------
    normal : float32 (sites, 3)
        Unit normals.
    turn : float32 (sites,)
        Rotation about the normal in whole turns, 0..1.
    """
    n = normal.astype(np.float64)
    # Duff et al. 2017, "Building an orthonormal basis, revisited", JCGT 6(1)
    sign = np.where(n[:, 2] < 0.0, -1.0, 1.0)
    a = -1.0 / (sign + n[:, 2])
    b = n[:, 0] * n[:, 1] * a
    first = np.stack([1.0 + sign * n[:, 0] ** 2 * a, sign * b, -sign * n[:, 0]], axis=1)
    second = np.stack([b, sign + n[:, 1] ** 2 * a, -n[:, 1]], axis=1)
    c = np.cos(2.0 * np.pi * turn.astype(np.float64))[:, None]
    s = np.sin(2.0 * np.pi * turn.astype(np.float64))[:, None]
    return (c * first + s * second).astype(np.float32), (c * second - s * first).astype(np.float32)
