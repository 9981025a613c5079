"""Temperatures of movers: the class solutions of bodies that turn every way under the open sky.

A mover has no place, so it has no shadows and no neighbours but the ground: that is the documented simplification.
In the course of the day it heads in all directions, so its sides take the mean of the sun over all headings, and
their temperature does not jump where it turns. Its own speed fans it.
"""

from __future__ import annotations

from dataclasses import replace

import numpy as np
from jaxtyping import Float32, Float64, Int64

from scenegen.climate.weather import Weather
from scenegen.heat.balance import solve_day
from scenegen.heat.class_days import ClassDays, ClassTraits, absorbed_by, conduction_behind
from scenegen.heat.classes import ThermalClasses
from scenegen.heat.emitters import GROUND_GROUPS, WATER_GROUP, group_classes
from scenegen.heat.forcing import Day
from scenegen.materials.material import Surface
from scenegen.movers.company import Company

_TILTS = 4
"""Steps of the vertical component of a normal from a wall to a roof."""
_WIND_STEP_MPS = 2.5
AFLOAT = "boat"
"""Kind of mover that has water below it."""


def moving_temperatures(
    company: Company,
    palette: tuple[Surface, ...],
    classes: ThermalClasses,
    days: ClassDays,
    day: Day,
    weather: Weather,
) -> Float32[np.ndarray, "sites"]:
    """Temperature of every site of a company at sample 0 of a day [K].

    Parameters
    ----------
    company : Company
    palette : tuple of Surface
    classes, days : ThermalClasses, ClassDays
        Of the standing world: what the ground below sends up.
    day : Day
    weather : Weather
    """
    keys, member = np.unique(_keys(company, weather), axis=0, return_inverse=True)
    if not len(keys):
        return np.zeros(0, np.float32)
    entry, tilt, wind, afloat = keys.T
    temperature = np.empty(len(keys))
    for air_speed, below in np.unique(keys[:, 2:], axis=0):
        mine = np.flatnonzero((wind == air_speed) & (afloat == below))
        rising = _rising(classes, palette, days, day, bool(below))
        fanned = replace(day, air=replace(day.air, wind_mps=float(air_speed * _WIND_STEP_MPS)))
        temperature[mine] = _solved(palette, entry[mine], tilt[mine] / _TILTS, rising, fanned, weather)
    return np.asarray(temperature[member.ravel()], np.float32)


def mean_over_headings(
    cos_tilt: Float64[np.ndarray, "*#shape"], sin_elevation: Float64[np.ndarray, "*#shape"]
) -> Float64[np.ndarray, "*shape"]:
    """Cosine of the sun's incidence, not below 0, averaged over all headings of a surface; 0 when the sun is down.

    ``max(0, a + b cos(phi))`` with ``a = cos(tilt) sin(h)``, ``b = sin(tilt) cos(h)``, in closed form.
    """
    a = cos_tilt * sin_elevation
    b = np.sqrt(np.maximum((1.0 - cos_tilt**2) * (1.0 - sin_elevation**2), 0.0))
    edge = np.arccos(np.clip(-a / np.maximum(b, 1e-12), -1.0, 1.0))
    mean = (a * edge + b * np.sin(edge)) / np.pi
    return np.where(sin_elevation > 0.0, np.maximum(mean, 0.0), 0.0)


def _keys(company: Company, weather: Weather) -> Int64[np.ndarray, "sites 4"]:
    """What decides a site's temperature: palette entry, tilt, speed of the air, water below."""
    tilt = np.rint(company.body.site_normal[:, 2] * _TILTS)
    air = np.hypot(company.speed_mps, weather.wind_mps)
    afloat = np.array([m.kind == AFLOAT for m in company.movers], bool)
    owner = company.site_owner
    columns = [company.site_surface, tilt, np.rint(air / _WIND_STEP_MPS)[owner], afloat[owner]]
    return np.column_stack(columns).astype(np.int64)


def _rising(
    classes: ThermalClasses, palette: tuple[Surface, ...], days: ClassDays, day: Day, afloat: bool
) -> tuple[Float64[np.ndarray, "samples"], Float64[np.ndarray, "samples"]]:
    """Short-wave and long-wave radiosity of the ground (or the water), mean over its area [W/m^2]."""
    group = group_classes(palette, classes.palette, classes.orientation)
    area = np.bincount(group, classes.area_m2, len(days.neighbours.short_Wm2))
    wanted = np.array([WATER_GROUP] if afloat else GROUND_GROUPS)
    weight = area[wanted]
    if not weight.sum() > 0.0:
        return day.ground_short_Wm2, day.ground_long_Wm2
    weight = weight / weight.sum()
    short, long = days.neighbours.short_Wm2[wanted], days.neighbours.long_Wm2[wanted]
    return np.einsum("g,gn->n", weight, short), np.einsum("g,gn->n", weight, long)


def _solved(
    palette: tuple[Surface, ...],
    entry: Int64[np.ndarray, "classes"],
    cos_tilt: Float64[np.ndarray, "classes"],
    rising: tuple[Float64[np.ndarray, "samples"], Float64[np.ndarray, "samples"]],
    day: Day,
    weather: Weather,
) -> Float64[np.ndarray, "classes"]:
    """Temperatures at sample 0 of classes under the open sky."""
    normal = np.column_stack([np.sqrt(1.0 - cos_tilt**2), np.zeros(len(entry)), cos_tilt])
    traits = ClassTraits.of(palette, entry, normal, weather)
    Y, inner = conduction_behind(palette, entry, day)
    sky, ground = 0.5 * (1.0 + cos_tilt)[:, None], 0.5 * (1.0 - cos_tilt)[:, None]
    short = sky * day.diffuse_Wm2 + ground * rising[0]
    long = sky * day.sky_Wm2 + ground * rising[1]
    beam = day.direct_Wm2 * mean_over_headings(cos_tilt[:, None], day.sun[None, :, 2])
    solution = solve_day(absorbed_by(traits, short, long, beam), inner, Y, traits.skins, day.air)
    free = np.minimum(solution.temperature_K[:, 0], traits.ceiling_K)
    return np.where(np.isfinite(traits.fixed_K), traits.fixed_K, free)
