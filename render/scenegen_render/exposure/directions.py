"""Directions over the hemisphere of a site: equal cosine weight each, low discrepancy, exact under a level sky."""

from __future__ import annotations

from functools import cache

import numpy as np
from jaxtyping import Float32, Float64

from scenegen.radiometry.sky import air_mass

_GOLDEN = (np.sqrt(5.0) - 1.0) / 2.0
_REFERENCE_DEPTH, _REFERENCE_POWER = 0.12, 0.788
"""Optical depth and air-mass power of a clear sky between dry and humid, where the error changes its sign."""
_FINE = 512


@cache
def cosine_directions(count: int) -> Float64[np.ndarray, "count 3"]:
    """Unit vectors about +z, each standing for the share 1/count of the cosine-weighted hemisphere.

    Golden-angle spiral on the projected disc ("sunflower"). The disc is cut into rings of equal area; each ring is
    represented not at its middle but where a middling clear sky has its ring mean, because sky radiance rises steeply
    towards the horizon: that makes the irradiance of an unobstructed horizontal site right to 1e-4.
    """
    share = np.linspace(0.0, 1.0, count * _FINE + 1)
    middle = 0.5 * (share[1:] + share[:-1])
    mean = _reference_sky(np.sqrt(middle)).reshape(count, _FINE).mean(axis=1)
    sine = np.linspace(0.0, 1.0, 200_001)
    height = np.interp(-mean, -_reference_sky(sine), sine)
    azimuth = 2.0 * np.pi * ((np.arange(count) * _GOLDEN) % 1.0)
    radius = np.sqrt(1.0 - height**2)
    found = np.stack([radius * np.cos(azimuth), radius * np.sin(azimuth), height], axis=1)
    found.flags.writeable = False
    return found


def _reference_sky(sine: Float64[np.ndarray, "samples"]) -> Float64[np.ndarray, "samples"]:
    """Emissivity of the reference sky, falling with the sine of the elevation."""
    return np.asarray(1.0 - np.exp(-_REFERENCE_DEPTH * air_mass(sine) ** _REFERENCE_POWER))


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
