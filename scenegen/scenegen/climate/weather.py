"""The weather of one clip's day, as a few numbers the heat balance and the sky need."""

from __future__ import annotations

from dataclasses import dataclass


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
