"""Reflectance of a smooth absorbing surface, for the few materials in which a thermal camera sees a mirror image."""

from __future__ import annotations

import numpy as np
from jaxtyping import Float, Float64

from scenegen.materials.material import ComplexIndex


def fresnel_reflectance(
    cos_incidence: Float[np.ndarray, "*shape"], index: ComplexIndex
) -> Float64[np.ndarray, "*shape"]:
    """Unpolarised Fresnel reflectance of a medium n + ik in air (Born and Wolf, section 14.2).

    Parameters
    ----------
    cos_incidence : float array
        Cosine of the angle between ray and normal, 0..1.
    index : ComplexIndex
        Effective index of the band; emissivity is one minus the result (Kirchhoff).
    """
    c = np.asarray(cos_incidence, dtype=np.float64)
    sin2 = 1.0 - c**2
    d = index.n**2 - index.k**2 - sin2
    root = np.sqrt(d**2 + 4.0 * (index.n * index.k) ** 2)
    a = np.sqrt(np.maximum(0.5 * (root + d), 0.0))
    perpendicular = (root + c**2 - 2 * a * c) / (root + c**2 + 2 * a * c)
    parallel = (
        perpendicular
        * (root * c**2 + sin2**2 - 2 * a * c * sin2)
        / (root * c**2 + sin2**2 + 2 * a * c * sin2)
    )
    return np.asarray(0.5 * (perpendicular + parallel))
