"""From a world, its exposure and the weather to the temperature of every site."""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np
from jaxtyping import Float32, Float64

from scenegen.climate.humidity import dew_point_K
from scenegen.climate.season import Season
from scenegen.climate.weather import Weather
from scenegen.exposure import Exposure
from scenegen.heat.class_days import ClassDays, mean_irradiance
from scenegen.heat.classes import ThermalClasses
from scenegen.heat.expansion import Expansion, site_temperatures
from scenegen.heat.forcing import Day
from scenegen.heat.moving import moving_temperatures
from scenegen.heat.outlook import Outlook
from scenegen.heat.shadow import memory
from scenegen.heat.texture import NIGHT_SHARE, amplitude_factor, solar_memory
from scenegen.movers.company import Company
from scenegen.radiometry.atmosphere import Atmosphere
from scenegen.thermal_state import ThermalState
from scenegen.world import World


@dataclass(frozen=True, eq=False)
class HeatModel:
    """A world and its exposure, sorted once for any number of weathers and hours.

    Attributes
    ----------
    world : World
    exposure : Exposure
    classes : ThermalClasses
    outlook : Outlook
    company : Company
        The world's movers.
    """

    world: World
    exposure: Exposure
    classes: ThermalClasses
    outlook: Outlook
    company: Company

    @staticmethod
    def of(world: World, exposure: Exposure) -> HeatModel:
        """Sort the sites into classes and average what each class sees."""
        classes = ThermalClasses.of(world)
        outlook = Outlook.of(classes, world.palette, exposure, world.sites.area.astype(np.float64))
        return HeatModel(world, exposure, classes, outlook, Company.of(world.movers))

    def seeing(self, exposure: Exposure) -> HeatModel:
        """The same world with single sites seen more closely; classes, and what they see on average, stay."""
        return replace(self, exposure=exposure)

    def solve(self, weather: Weather, hour: float) -> ThermalState:
        """Temperatures at one hour of a periodic day of this weather."""
        exposure = self.exposure
        day = Day.of(exposure.season, weather, hour)
        days = ClassDays.of(self.classes, self.world.palette, self.outlook, exposure.sun_hour, weather, day)
        felt_lit = memory(days.lit.slope_Wm2K, days.admittance)
        felt_shaded = memory(days.shaded.slope_Wm2K, days.admittance)
        sun, seen = days.cos_sun, (days, day, self.outlook, exposure.sun_hour)
        lit = Expansion.of(days.lit, felt_lit, sun, *seen)
        shaded = Expansion.of(days.shaded, felt_shaded, 0.0 * sun, *seen)
        temperature = np.empty(self.world.sites.area.size, dtype=np.float32)
        for c in range(self.classes.palette.size):
            sites = self.classes.members(c)
            if np.isfinite(days.traits.fixed_K[c]):
                temperature[sites] = days.traits.fixed_K[c]
                continue
            T = site_temperatures(lit, shaded, c, exposure, sites)
            temperature[sites] = np.minimum(T, np.float32(days.traits.ceiling_K[c]))
        return ThermalState(
            season=exposure.season,
            hour=float(hour),
            weather=weather,
            atmosphere=weather.atmosphere(hour),
            temperature_K=temperature,
            texture_K=self._texture(days, day, felt_lit),
            moving_K=moving_temperatures(self.company, self.world.palette, self.classes, days, day, weather),
        )

    def _texture(
        self, days: ClassDays, day: Day, felt: Float64[np.ndarray, "classes samples"]
    ) -> Float32[np.ndarray, "palette"]:
        """Texture amplitude of each palette entry now: area mean over its classes."""
        short, _ = mean_irradiance(self.outlook, days.neighbours, day)
        short = short + day.direct_Wm2 * self.outlook.beam_over(day, self.exposure.sun_hour)
        solar = solar_memory(felt, short)
        entries = len(self.world.palette)
        area = np.bincount(self.classes.palette, weights=self.classes.area_m2, minlength=entries)
        total = np.bincount(
            self.classes.palette, weights=self.classes.area_m2 * amplitude_factor(solar), minlength=entries
        )
        factor = np.where(area > 0.0, total / np.where(area > 0.0, area, 1.0), NIGHT_SHARE)
        return (factor * [s.material.texture_K for s in self.world.palette]).astype(np.float32)


def solve(world: World, exposure: Exposure, weather: Weather, hour: float) -> ThermalState:
    """Temperatures of a world at one hour of a periodic day.

    Parameters
    ----------
    world : World
    exposure : Exposure
        Of the same world; brings the season.
    weather : Weather
    hour : float
        Local mean solar time [h], 0 <= hour < 24.

    Notes
    -----
    Several states of one world share the sorting: ``model = HeatModel.of(world, exposure)``, then
    ``model.solve(weather, hour)``.
    """
    return HeatModel.of(world, exposure).solve(weather, hour)


def solve_uniform(world: World, temperature_K: float, atmosphere: Atmosphere) -> ThermalState:
    """State in which every site has one temperature and no texture: test scenes and the isothermal room."""
    weather = Weather(
        air_mean_K=atmosphere.air_K,
        air_amplitude_K=0.0,
        air_peak_hour=15.0,
        dew_point_K=dew_point_K(atmosphere.vapour_pressure_hPa),
        wind_mps=0.0,
        cloud_fraction=atmosphere.cloud_fraction,
        linke_turbidity=3.0,
        visibility_km=atmosphere.visibility_km,
        sky_optical_depth_factor=atmosphere.sky_optical_depth_factor,
    )
    return ThermalState(
        season=Season(0.0, 3, 21),
        hour=0.0,
        weather=weather,
        atmosphere=atmosphere,
        temperature_K=np.full(world.sites.area.size, temperature_K, dtype=np.float32),
        texture_K=np.zeros(len(world.palette), dtype=np.float32),
        moving_K=np.full(
            sum(len(m.body.site_position) for m in world.movers), temperature_K, dtype=np.float32
        ),
    )
