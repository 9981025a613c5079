"""The days of all thermal classes of a world: each solved in full sun, in full shade, and as it is on average."""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np
from jaxtyping import Complex128, Float64, Int64

from scenegen.climate.weather import Weather
from scenegen.heat.balance import DaySolution, Skins, solve_day
from scenegen.heat.classes import ThermalClasses
from scenegen.heat.conduction import admittance, harmonics
from scenegen.heat.construction import construction
from scenegen.heat.forcing import Day
from scenegen.heat.longwave import Neighbours
from scenegen.heat.outlook import Outlook
from scenegen.materials.material import Build, Surface

_EXCHANGES = 3
"""Rounds of radiation between neighbours; against six: 2 mK rms, 14 mK at most (two: 25 and 190)."""


@dataclass(frozen=True, eq=False)
class ClassTraits:
    """What the classes are made of, one entry each.

    Attributes
    ----------
    skins : Skins
    absorptance, direct_factor : float64 (classes,)
        For sunshine; the second is the share of the direct beam that reaches the effective surface.
    ceiling_K : float64 (classes,)
        Highest temperature (melting snow); infinity elsewhere.
    fixed_K : float64 (classes,)
        Prescribed temperature; NaN where the balance decides.
    """

    skins: Skins
    absorptance: Float64[np.ndarray, "classes"]
    direct_factor: Float64[np.ndarray, "classes"]
    ceiling_K: Float64[np.ndarray, "classes"]
    fixed_K: Float64[np.ndarray, "classes"]

    @staticmethod
    def of(
        palette: tuple[Surface, ...],
        entry: Int64[np.ndarray, "classes"],
        normal: Float64[np.ndarray, "classes 3"],
        weather: Weather,
    ) -> ClassTraits:
        """Traits of palette entries facing given ways."""
        surfaces = [palette[p] for p in entry]

        def column(values: list[float]) -> Float64[np.ndarray, "classes"]:
            return np.array(values, dtype=np.float64)

        skins = Skins(
            emissivity=column([s.emissivity for s in surfaces]),
            cos_tilt=normal[:, 2].astype(np.float64),
            roughness_factor=column([s.material.roughness_factor for s in surfaces]),
            convection_factor=column([s.material.convection_factor for s in surfaces]),
            wetness=column([s.material.wetness for s in surfaces]),
            surface_resistance_sm=column([s.material.stomatal_resistance_sm for s in surfaces]),
        )
        return ClassTraits(
            skins=skins,
            absorptance=column([s.solar_absorptance for s in surfaces]),
            direct_factor=column([s.material.direct_factor for s in surfaces]),
            ceiling_K=column([s.material.max_temperature_K for s in surfaces]),
            fixed_K=column([_fixed_K(s, weather) for s in surfaces]),
        )


@dataclass(frozen=True, eq=False)
class ClassDays:
    """Solutions of all classes over one day.

    Attributes
    ----------
    traits : ClassTraits
    admittance : complex128 (classes, harmonics)
    cos_sun : float64 (classes, samples)
        Cosine of incidence of an unobstructed sun on the class normal, never negative.
    neighbours : Neighbours
        Radiosity of the emitter groups after the exchange.
    lit, shaded : DaySolution
        In full sun all day and without any beam, both with the class's mean sky and neighbours.
    """

    traits: ClassTraits
    admittance: Complex128[np.ndarray, "classes harmonics"]
    cos_sun: Float64[np.ndarray, "classes samples"]
    neighbours: Neighbours
    lit: DaySolution
    shaded: DaySolution

    @staticmethod
    def of(
        classes: ThermalClasses,
        palette: tuple[Surface, ...],
        outlook: Outlook,
        sun_hour: Float64[np.ndarray, "times"],
        weather: Weather,
        day: Day,
    ) -> ClassDays:
        """Solve every class of a world for a day."""
        traits = ClassTraits.of(palette, classes.palette, classes.normal, weather)
        Y, inner = conduction_behind(palette, classes.palette, day)
        beam = outlook.beam_over(day, sun_hour)
        neighbours = Neighbours.unknown(day, outlook.neighbour.shape[1])
        guess: Float64[np.ndarray, "classes samples"] | None = None
        for _ in range(_EXCHANGES):
            short, long = mean_irradiance(outlook, neighbours, day)
            absorbed = absorbed_by(traits, short, long, day.direct_Wm2 * beam)
            means = solve_day(absorbed, inner, Y, traits.skins, day.air, guess, tolerance_K=0.02)
            guess = _bounded(means.temperature_K, traits)
            neighbours = Neighbours.of(
                day,
                outlook.membership,
                guess,
                traits.skins.emissivity,
                traits.absorptance,
                short + traits.direct_factor[:, None] * day.direct_Wm2 * beam,
                long,
            )
        short, long = mean_irradiance(outlook, neighbours, day)
        cos_sun = np.maximum(np.einsum("ci,ni->cn", classes.normal, day.sun), 0.0) * (day.sun[:, 2] > 0.0)
        lit = solve_day(
            absorbed_by(traits, short, long, day.direct_Wm2 * cos_sun), inner, Y, traits.skins, day.air, guess
        )
        shaded = solve_day(
            absorbed_by(traits, short, long, 0.0 * cos_sun), inner, Y, traits.skins, day.air, guess
        )
        return ClassDays(traits, Y, cos_sun, neighbours, lit, shaded)


def mean_irradiance(
    outlook: Outlook, neighbours: Neighbours, day: Day
) -> tuple[Float64[np.ndarray, "classes samples"], Float64[np.ndarray, "classes samples"]]:
    """Diffuse short-wave and long-wave irradiance on the mean site of each class [W/m^2]."""
    lost = np.maximum(1.0 - outlook.sky - outlook.neighbour.sum(axis=1), 0.0)[:, None]
    sky = outlook.sky[:, None]
    short = sky * day.diffuse_Wm2 + lost * day.ground_short_Wm2
    long = sky * day.sky_Wm2 + lost * day.ground_long_Wm2
    short = short + np.einsum("cg,gn->cn", outlook.neighbour, neighbours.short_Wm2)
    return short, long + np.einsum("cg,gn->cn", outlook.neighbour, neighbours.long_Wm2)


def absorbed_by(
    traits: ClassTraits,
    short_Wm2: Float64[np.ndarray, "classes samples"],
    long_Wm2: Float64[np.ndarray, "classes samples"],
    beam_Wm2: Float64[np.ndarray, "classes samples"],
) -> Float64[np.ndarray, "classes samples"]:
    """Radiation that classes absorb of what falls on them [W/m^2]."""
    sun = short_Wm2 + traits.direct_factor[:, None] * beam_Wm2
    return np.asarray(traits.absorptance[:, None] * sun + traits.skins.emissivity[:, None] * long_Wm2)


def _bounded(
    temperature_K: Float64[np.ndarray, "classes samples"], traits: ClassTraits
) -> Float64[np.ndarray, "classes samples"]:
    fixed = traits.fixed_K[:, None]
    return np.where(np.isfinite(fixed), fixed, np.minimum(temperature_K, traits.ceiling_K[:, None]))


def conduction_behind(
    palette: tuple[Surface, ...], entry: Int64[np.ndarray, "classes"], day: Day
) -> tuple[Complex128[np.ndarray, "classes harmonics"], Float64[np.ndarray, "classes samples"]]:
    """Admittance of palette entries, and the heat their inner spaces send out [W/m^2]."""
    samples = day.hour.size
    omega = harmonics(samples)
    Y = np.zeros((len(palette), omega.size), dtype=np.complex128)
    inner = np.zeros((len(palette), samples))
    for i, surface in enumerate(palette):
        built = construction(surface)
        Y[i], transfer = admittance(built.stack, omega)
        space = np.full(samples, built.inner_K) if math.isfinite(built.inner_K) else day.air.temperature_K
        inner[i] = np.fft.irfft(transfer * np.fft.rfft(space), n=samples) + built.arriving_Wm2
    return Y[entry], inner[entry]


def _fixed_K(surface: Surface, weather: Weather) -> float:
    """Prescribed temperature; open water without one stays near the mean of the air, and never freezes."""
    if math.isfinite(surface.prescribed_K) or surface.material.build is not Build.WATER:
        return surface.prescribed_K
    return max(weather.air_mean_K, 273.35) - 0.2
