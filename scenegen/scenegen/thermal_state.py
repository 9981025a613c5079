"""One weather, one hour: the temperatures of a world and the air between them and the camera."""

from __future__ import annotations

from dataclasses import dataclass, field

import numpy as np
from jaxtyping import Float32

from scenegen.climate.season import Season
from scenegen.climate.weather import Weather
from scenegen.radiometry.atmosphere import Atmosphere


@dataclass(frozen=True, eq=False)
class ThermalState:
    """Solved temperatures of one world at one moment.

    Attributes
    ----------
    season : Season
    hour : float
        Local mean solar time [h].
    weather : Weather
    atmosphere : Atmosphere
        Air, in-band sky and path of this moment, as the camera sees them.
    temperature_K : float32 (sites,)
        Kinetic temperature [K].
    texture_K : float32 (palette,)
        Amplitude of the small-scale temperature variation of each palette entry at this moment [K].
    moving_K : float32 (moving,)
        Temperature of the sites of all movers, in the order of `World.movers` [K].
    """

    season: Season
    hour: float
    weather: Weather
    atmosphere: Atmosphere
    temperature_K: Float32[np.ndarray, "sites"]
    texture_K: Float32[np.ndarray, "palette"]
    moving_K: Float32[np.ndarray, "moving"] = field(default_factory=lambda: np.zeros(0, np.float32))
