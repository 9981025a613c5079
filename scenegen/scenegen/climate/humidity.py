"""Water vapour in air: saturation pressure and its slope."""

from __future__ import annotations

import math

import numpy as np
from jaxtyping import Float, Float64


def saturation_pressure_hPa(temperature_K: Float[np.ndarray, "*shape"]) -> Float64[np.ndarray, "*shape"]:
    """Saturation vapour pressure over water [hPa], Tetens' equation as in FAO-56 (equation 11)."""
    celsius = np.asarray(temperature_K, dtype=np.float64) - 273.15
    return np.asarray(6.108 * np.exp(17.27 * celsius / (celsius + 237.3)))


def saturation_slope_hPaK(temperature_K: Float[np.ndarray, "*shape"]) -> Float64[np.ndarray, "*shape"]:
    """Derivative of the saturation pressure [hPa/K] (FAO-56, equation 13)."""
    celsius = np.asarray(temperature_K, dtype=np.float64) - 273.15
    return np.asarray(4098.0 / (celsius + 237.3) ** 2 * saturation_pressure_hPa(temperature_K))


def dew_point_K(vapour_pressure_hPa: float) -> float:
    """Temperature at which air of this vapour pressure is saturated [K], the inverse of Tetens' equation."""
    x = math.log(vapour_pressure_hPa / 6.108)
    return 273.15 + 237.3 * x / (17.27 - x)
