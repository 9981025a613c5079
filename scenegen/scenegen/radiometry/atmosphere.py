"""The air of one moment, as a long-wave camera sees it."""

from __future__ import annotations

from dataclasses import dataclass


@dataclass(frozen=True)
class Atmosphere:
    """Air, in-band sky and path. Everything the tracer needs to know of the weather.

    Attributes
    ----------
    air_K : float
        Air temperature near the ground [K].
    vapour_pressure_hPa : float
    cloud_fraction : float
        0 clear .. 1 overcast.
    cloud_K : float
        Temperature of the cloud base [K].
    visibility_km : float
    sky_optical_depth_factor : float
        Multiplier of the clear sky's in-band optical depth.
    uniform_sky_K : float
        If finite, the whole sky is a blackbody of this temperature (test scenes); NaN for the real sky.
    path : bool
        False switches path transmission and path radiance off (a vacuum; counterfactual and test renders).
    """

    air_K: float
    vapour_pressure_hPa: float
    cloud_fraction: float = 0.0
    cloud_K: float = 280.0
    visibility_km: float = 23.0
    sky_optical_depth_factor: float = 1.0
    uniform_sky_K: float = float("nan")
    path: bool = True
