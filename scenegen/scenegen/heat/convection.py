"""Heat carried away by the air: the DOE-2 model as EnergyPlus documents it, smoothed for a Newton iteration."""

from __future__ import annotations

import numpy as np
from jaxtyping import Float64

_LEAST_WIND_MPS = 0.5
"""Air never stands still outdoors; at zero the wet surfaces do not converge."""
_SMOOTH_DT_K2 = 0.25
_SWITCH_K = 0.5


def natural_convection(
    excess_K: Float64[np.ndarray, "*shape"], cos_tilt: Float64[np.ndarray, "*#shape"]
) -> Float64[np.ndarray, "*shape"]:
    """Coefficient in still air [W m^-2 K^-1] (Walton 1983).

    Parameters
    ----------
    excess_K : float64
        Surface minus air temperature.
    cos_tilt : float64
        Vertical component of the outward normal: 1 a roof, 0 a wall, -1 a ceiling. A warm surface facing up, or a
        cold one facing down, stirs the air; the switch between the two branches is smoothed over half a kelvin.
    """
    drive = np.cbrt(np.sqrt(excess_K**2 + _SMOOTH_DT_K2))
    tilt = np.abs(cos_tilt)
    unstable = 9.482 * drive / (7.283 - tilt)
    stable = 1.810 * drive / (1.382 + tilt)
    share = 0.5 * (1.0 + np.tanh(excess_K * np.sign(cos_tilt) / _SWITCH_K))
    return np.asarray(share * unstable + (1.0 - share) * stable)


def convection_coefficient(
    excess_K: Float64[np.ndarray, "*shape"],
    cos_tilt: Float64[np.ndarray, "*#shape"],
    wind_mps: float,
    roughness_factor: Float64[np.ndarray, "*#shape"],
) -> Float64[np.ndarray, "*shape"]:
    """Convection coefficient h [W m^-2 K^-1] of a windward surface.

    ``h = h_n + R_f (h_glass - h_n)``, ``h_glass^2 = h_n^2 + (3.26 V^0.89)^2``; R_f 2.17 very rough .. 1.00 glass.
    """
    natural = natural_convection(excess_K, cos_tilt)
    forced = 3.26 * max(wind_mps, _LEAST_WIND_MPS) ** 0.89
    glass = np.sqrt(natural**2 + forced**2)
    return np.asarray(natural + roughness_factor * (glass - natural))
