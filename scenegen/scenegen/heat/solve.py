"""From a world, its exposure and the weather to the temperature of every site."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from jaxtyping import Float32, Float64

from scenegen.climate.season import Season
from scenegen.climate.weather import Weather
from scenegen.exposure import Exposure
from scenegen.heat.balance import DaySolution
from scenegen.heat.class_days import ClassDays, mean_irradiance
from scenegen.heat.classes import ThermalClasses
from scenegen.heat.forcing import Day
from scenegen.heat.outlook import Outlook
from scenegen.heat.shadow import collect, memory
from scenegen.heat.texture import NIGHT_SHARE, amplitude_factor, solar_memory
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
    """

    world: World
    exposure: Exposure
    classes: ThermalClasses
    outlook: Outlook

    @staticmethod
    def of(world: World, exposure: Exposure) -> HeatModel:
        """Sort the sites into classes and average what each class sees."""
        classes = ThermalClasses.of(world)
        outlook = Outlook.of(classes, world.palette, exposure, world.sites.area.astype(np.float64))
        return HeatModel(world, exposure, classes, outlook)

    def solve(self, weather: Weather, hour: float) -> ThermalState:
        """Temperatures at one hour of a periodic day of this weather."""
        exposure = self.exposure
        day = Day.of(exposure.season, weather, hour)
        days = ClassDays.of(self.classes, self.world.palette, self.outlook, exposure.sun_hour, weather, day)
        lit = _Linear.of(days.lit, days.cos_sun, days, day, self)
        shaded = _Linear.of(days.shaded, 0.0 * days.cos_sun, days, day, self)
        temperature = np.empty(self.world.sites.area.size, dtype=np.float32)
        for c in range(self.classes.palette.size):
            sites = self.classes.members(c)
            if np.isfinite(days.traits.fixed_K[c]):
                temperature[sites] = days.traits.fixed_K[c]
                continue
            T = _site_temperatures(lit, shaded, c, exposure, sites)
            temperature[sites] = np.minimum(T, np.float32(days.traits.ceiling_K[c]))
        return ThermalState(
            season=exposure.season,
            hour=float(hour),
            weather=weather,
            atmosphere=weather.atmosphere(hour),
            temperature_K=temperature,
            texture_K=self._texture(days, day),
        )

    def _texture(self, days: ClassDays, day: Day) -> Float32[np.ndarray, "palette"]:
        """Texture amplitude of each palette entry now: area mean over its classes."""
        short, _ = mean_irradiance(self.outlook, days.neighbours, day)
        if self.exposure.sun_hour.size:
            short = short + day.direct_Wm2 * self.outlook.beam[:, day.nearest(self.exposure.sun_hour)]
        solar = solar_memory(memory(days.lit.loss_Wm2K, days.admittance, day.hour.size), short)
        entries = len(self.world.palette)
        area = np.bincount(self.classes.palette, weights=self.classes.area_m2, minlength=entries)
        total = np.bincount(
            self.classes.palette, weights=self.classes.area_m2 * amplitude_factor(solar), minlength=entries
        )
        factor = np.where(area > 0.0, total / np.where(area > 0.0, area, 1.0), NIGHT_SHARE)
        return (factor * [s.material.texture_K for s in self.world.palette]).astype(np.float32)


@dataclass(frozen=True, eq=False)
class _Linear:
    """Temperature of a class's sites now, linear in what each site sees.

    ``T = base + beam @ per_beam + sky * per_sky + neighbour_share @ per_neighbour`` [K].
    """

    base: Float32[np.ndarray, "classes"]
    per_beam: Float32[np.ndarray, "classes times"]
    per_sky: Float32[np.ndarray, "classes"]
    per_neighbour: Float32[np.ndarray, "classes groups"]
    sunned: Float32[np.ndarray, "classes"]

    @staticmethod
    def of(
        solution: DaySolution,
        cos_sun: Float64[np.ndarray, "classes samples"],
        days: ClassDays,
        day: Day,
        model: HeatModel,
    ) -> _Linear:
        """Expand around a class solution that was made with the beam ``direct * cos_sun``."""
        traits, times = days.traits, model.exposure.sun_hour
        felt = memory(solution.loss_Wm2K, days.admittance, day.hour.size)
        alpha, eps = traits.absorptance[:, None] * felt, traits.skins.emissivity[:, None] * felt
        beam = alpha * traits.direct_factor[:, None] * day.direct_Wm2

        def seen(short: Float64[np.ndarray, "*any samples"], long: Float64[np.ndarray, "*any samples"]) -> np.ndarray:
            return np.einsum("cn,...n->c...", alpha, short) + np.einsum("cn,...n->c...", eps, long)

        ground = seen(day.ground_short_Wm2, day.ground_long_Wm2)
        sky = seen(day.diffuse_Wm2, day.sky_Wm2) - ground
        neighbour = seen(days.neighbours.short_Wm2, days.neighbours.long_Wm2) - ground[:, None]
        per_beam = collect(beam, day.nearest(times), times.size) if times.size else np.zeros((beam.shape[0], 0))
        outlook = model.outlook
        usual = np.einsum("cn,cn->c", beam, cos_sun) + sky * outlook.sky
        usual = usual + np.einsum("cg,cg->c", neighbour, outlook.neighbour)
        full = np.einsum("cn,cn->c", beam, days.cos_sun)
        columns = (solution.temperature_K[:, 0] - usual, per_beam, sky, neighbour, full)
        return _Linear(*(np.asarray(x, dtype=np.float32) for x in columns))

    def heat_of_sun(self, c: int, beam: Float32[np.ndarray, "members times"]) -> Float32[np.ndarray, "members"]:
        """Part of the temperature the visible sun is responsible for [K]."""
        return np.einsum("st,t->s", beam, self.per_beam[c])

    def rest(
        self, c: int, sky: Float32[np.ndarray, "members"], share: Float32[np.ndarray, "members groups"]
    ) -> Float32[np.ndarray, "members"]:
        """Everything but the beam."""
        return self.base[c] + sky * self.per_sky[c] + np.einsum("sg,g->s", share, self.per_neighbour[c])


def _site_temperatures(
    lit: _Linear, shaded: _Linear, c: int, exposure: Exposure, sites: np.ndarray
) -> Float32[np.ndarray, "members"]:
    """Temperatures of a class's sites: the two expansions, blended by how much of the full sun a site has had.

    Sums run along rows by `einsum`, in a fixed order and without a threaded linear algebra library, so the bytes do
    not depend on the machine's load.
    """
    beam = exposure.beam[sites].astype(np.float32)
    sky, share = exposure.sky_view[sites], exposure.neighbour_share[sites]
    warm, cool = lit.heat_of_sun(c, beam), shaded.heat_of_sun(c, beam)
    full = lit.sunned[c]
    sunny = np.clip(warm / full, 0.0, 1.0) if full > 1e-3 else np.ones_like(warm)
    T = sunny * (warm + lit.rest(c, sky, share)) + (1.0 - sunny) * (cool + shaded.rest(c, sky, share))
    return np.asarray(T, dtype=np.float32)


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
        dew_point_K=atmosphere.air_K,
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
    )
