"""Heat that evaporation carries away: a big leaf with one resistance."""

from __future__ import annotations

import numpy as np
from jaxtyping import Float64

from scenegen.climate.humidity import saturation_pressure_hPa, saturation_slope_hPaK

AIR_HEAT_CAPACITY_Jm3K = 1206.0
PSYCHROMETRIC_PaK = 66.5


def latent_flux(
    temperature_K: Float64[np.ndarray, "*shape"],
    vapour_pressure_hPa: float,
    convection_Wm2K: Float64[np.ndarray, "*#shape"],
    wetness: Float64[np.ndarray, "*#shape"],
    surface_resistance_sm: Float64[np.ndarray, "*#shape"],
) -> tuple[Float64[np.ndarray, "*shape"], Float64[np.ndarray, "*shape"]]:
    """Latent heat flux and its derivative by surface temperature [W/m^2, W m^-2 K^-1].

    ``LE = wet rho c_p / gamma (e_s(T) - e_a) / (r_a + r_s)``, ``r_a = rho c_p / h`` (FAO-56, chapter 2). Negative
    where dew forms.
    """
    air_resistance = AIR_HEAT_CAPACITY_Jm3K / convection_Wm2K
    per_Pa = wetness * AIR_HEAT_CAPACITY_Jm3K / PSYCHROMETRIC_PaK / (air_resistance + surface_resistance_sm)
    deficit_Pa = 100.0 * (saturation_pressure_hPa(temperature_K) - vapour_pressure_hPa)
    return np.asarray(per_Pa * deficit_Pa), np.asarray(per_Pa * 100.0 * saturation_slope_hPaK(temperature_K))
