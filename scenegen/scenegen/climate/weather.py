"""The weather of one clip's day, as a few numbers the heat balance and the sky need."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from jaxtyping import Float64

from scenegen.climate.humidity import saturation_pressure_hPa
from scenegen.radiometry.atmosphere import Atmosphere


@dataclass(frozen=True)
class Weather:
    """One periodic day.

    Attributes
    ----------
    air_mean_K : float
        Daily mean air temperature [K].
    air_amplitude_K : float
        Half the daily range [K].
    air_peak_hour : float
        Local mean solar time of the maximum [h].
    dew_point_K : float
        Constant over the day [K]; never above the air's minimum.
    wind_mps : float
        At 10 m height [m/s].
    cloud_fraction : float
        0 clear .. 1 overcast.
    linke_turbidity : float
        2 very clear, 3 clear, 5 hazy.
    visibility_km : float
        Meteorological range, for the aerosol part of the path.
    sky_optical_depth_factor : float
        Multiplier of the in-band sky's optical depth, 0.85-1.15: profile-to-profile scatter of real skies.
    """

    air_mean_K: float
    air_amplitude_K: float
    air_peak_hour: float
    dew_point_K: float
    wind_mps: float
    cloud_fraction: float
    linke_turbidity: float
    visibility_km: float = 23.0
    sky_optical_depth_factor: float = 1.0

    def air_K(self, hour: Float64[np.ndarray, "*shape"]) -> Float64[np.ndarray, "*shape"]:
        """Air temperature [K] at hours of the day, a cosine with its maximum at `air_peak_hour`."""
        phase = 2 * np.pi * (np.asarray(hour, dtype=np.float64) - self.air_peak_hour) / 24.0
        return np.asarray(self.air_mean_K + self.air_amplitude_K * np.cos(phase))

    @property
    def vapour_pressure_hPa(self) -> float:
        """Partial pressure of water vapour [hPa]."""
        return float(saturation_pressure_hPa(np.array(self.dew_point_K)))

    def atmosphere(self, hour: float) -> Atmosphere:
        """Air, in-band sky and path at an hour of this day, as the camera sees them."""
        air = float(self.air_K(np.array(hour, dtype=np.float64)))
        return Atmosphere(
            air_K=air,
            vapour_pressure_hPa=self.vapour_pressure_hPa,
            cloud_fraction=self.cloud_fraction,
            cloud_K=cloud_base_K(air, self.dew_point_K),
            visibility_km=self.visibility_km,
            sky_optical_depth_factor=self.sky_optical_depth_factor,
        )


def cloud_base_K(air_K: float, dew_point_K: float) -> float:
    """Temperature [K] at the lifting condensation level: 125 m per kelvin of dew point depression, 6.5 K/km."""
    return air_K - 6.5e-3 * 125.0 * max(air_K - dew_point_K, 0.0)
