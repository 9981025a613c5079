"""Water roughened by wind: slopes too small for the mesh, as the mirror sees them.

Cox and Munk (1954, doi:10.1364/JOSA.44.000838) measured the mean square slope of a wind-blown sea, both axes together:
0.003 + 0.00512 V. Near the camera the slopes are a field fixed in space, so that the image of the sky breaks up in
patches; far away a pixel holds many of them, and what stays is their mean: of a rough sea one sees more of the slopes
that lean towards the eye, hence less grazing reflection and a higher, colder part of the sky. With elevation theta of
the eye and slope s of standard deviation sigma, visible facets weigh as sin(theta) + s cos(theta), which gives
sigma^2 / tan(theta) while sigma < tan(theta) and 1.25 sigma at the horizon.
"""

from __future__ import annotations

import math
from typing import Any

from scenegen_render import backend
from scenegen_render.trace import noise

_RIPPLE_M = 0.7
"""Size of the patches of slope that are resolved near the camera."""
_HORIZON = math.sqrt(math.pi / 2.0)
"""Mean visible slope at the horizon over sigma: the mean of s^2 over the mean of s where s > 0."""


def slope_per_axis(wind_mps: float) -> float:
    """Standard deviation of the slope of a sea along each axis."""
    return math.sqrt(0.5 * (0.003 + 0.00512 * wind_mps))


def visible_slope(sigma: Any, cosine: Any) -> Any:
    """Mean slope towards the eye of what is visible.

    Parameters
    ----------
    sigma : mitsuba.Float
        Standard deviation of the slope along one axis.
    cosine : mitsuba.Float
        Of the angle between the mean normal and the direction to the eye: sin(theta).
    """
    _, dr = backend.modules()
    tangent = cosine * dr.rsqrt(dr.maximum(1.0 - cosine * cosine, 1e-6))
    floor = sigma * (1.0 / _HORIZON)
    return dr.select(
        sigma > 0.0, sigma * sigma * dr.rsqrt(dr.maximum(dr.fma(tangent, tangent, floor * floor), 1e-12)), 0.0
    )


def normal(sigma: Any, mean: Any, unit: Any, place: Any, footprint_m: Any, seed: Any) -> Any:
    """Normal of the facet that mirrors, towards the eye.

    Parameters
    ----------
    sigma : mitsuba.Float
        Standard deviation of the slope along one axis; 0 leaves the mean normal as it is.
    mean : mitsuba.Vector3f
        Unit normal of the mesh, on the side of the eye.
    unit : mitsuba.Vector3f
        Direction from the eye.
    place : mitsuba.Vector3f
        Where the water is met, at rest [m].
    footprint_m : mitsuba.Float
        Longest extent of the pixel on the water.
    seed : mitsuba.UInt
    """
    mi, dr = backend.modules()
    cosine = -dr.dot(mean, unit)
    lean = visible_slope(sigma, cosine)
    aside = dr.fma(mean, cosine, unit)  # along the surface, away from the eye
    aside *= dr.rsqrt(dr.maximum(dr.squared_norm(aside), 1e-12))
    at = noise.tilted(place) * (1.0 / _RIPPLE_M)
    resolved = sigma * dr.clip(2.0 - footprint_m * (1.0 / _RIPPLE_M), 0.0, 1.0) * noise.UNIT
    east = resolved * noise.value_noise(at, seed + 11)
    north = resolved * noise.value_noise(at + 5.7, seed + 12)
    return dr.normalize(mean - aside * lean + mi.Vector3f(east, north, 0.0))
