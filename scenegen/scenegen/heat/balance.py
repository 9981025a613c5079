"""The periodic surface heat balance, solved for many surfaces at once by Newton steps in Fourier space.

For each surface ``absorbed - eps sigma T^4 - h (T - T_air) - LE = Y * T - inner`` holds at every instant of a day
that repeats. Conduction is diagonal in harmonics, everything else in time; a step divides the residual by a constant
slope plus the admittance. Exact periodic steady state, no spin-up, stable for any layer stack, 4-12 steps.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from jaxtyping import Complex128, Float64

from scenegen.heat.convection import convection_coefficient
from scenegen.heat.latent import latent_flux
from scenegen.radiometry.planck import STEFAN_BOLTZMANN

SAMPLES = 144
"""Instants of the periodic day: every ten minutes."""
_STEPS = 60


@dataclass(frozen=True, eq=False)
class Skins:
    """The outer faces of many surfaces: how they radiate, lose heat to the air and evaporate. One entry each.

    Attributes
    ----------
    emissivity, cos_tilt, roughness_factor, convection_factor, wetness, surface_resistance_sm : float64 (surfaces,)
        See `scenegen.materials.material.Material`; `cos_tilt` is the vertical component of the normal.
    """

    emissivity: Float64[np.ndarray, "surfaces"]
    cos_tilt: Float64[np.ndarray, "surfaces"]
    roughness_factor: Float64[np.ndarray, "surfaces"]
    convection_factor: Float64[np.ndarray, "surfaces"]
    wetness: Float64[np.ndarray, "surfaces"]
    surface_resistance_sm: Float64[np.ndarray, "surfaces"]


@dataclass(frozen=True, eq=False)
class Air:
    """The air of a periodic day.

    Attributes
    ----------
    temperature_K : float64 (samples,)
    wind_mps, vapour_pressure_hPa : float
    """

    temperature_K: Float64[np.ndarray, "samples"]
    wind_mps: float
    vapour_pressure_hPa: float


@dataclass(frozen=True, eq=False)
class DaySolution:
    """Periodic temperatures and how they would answer to a little more absorbed flux.

    Attributes
    ----------
    temperature_K : float64 (surfaces, samples)
    slope_Wm2K : float64 (surfaces, samples)
        Derivative of all losses to sky and air by surface temperature, at that temperature.
    residual_Wm2 : float
        Largest imbalance left.
    steps : int
        Newton steps taken.
    """

    temperature_K: Float64[np.ndarray, "surfaces samples"]
    slope_Wm2K: Float64[np.ndarray, "surfaces samples"]
    residual_Wm2: float
    steps: int


def surface_losses(
    temperature_K: Float64[np.ndarray, "surfaces samples"], skins: Skins, air: Air
) -> tuple[Float64[np.ndarray, "surfaces samples"], Float64[np.ndarray, "surfaces samples"]]:
    """Flux lost by emission, convection and evaporation, and a safe slope for Newton [W/m^2, W m^-2 K^-1]."""
    eps = skins.emissivity[:, None]
    excess = temperature_K - air.temperature_K
    h = convection_coefficient(excess, skins.cos_tilt[:, None], air.wind_mps, skins.roughness_factor[:, None])
    h = h * skins.convection_factor[:, None]
    lost = eps * STEFAN_BOLTZMANN * temperature_K**4 + h * excess
    # A quarter more than h, because h itself grows with the excess as its cube root.
    slope = 4.0 * eps * STEFAN_BOLTZMANN * temperature_K**3 + 1.25 * h
    wet = np.flatnonzero(skins.wetness > 0.0)
    if wet.size:
        LE, dLE = latent_flux(
            temperature_K[wet],
            air.vapour_pressure_hPa,
            h[wet],
            skins.wetness[wet, None],
            skins.surface_resistance_sm[wet, None],
        )
        lost[wet] += LE
        slope[wet] += dLE
    return lost, slope


def solve_day(
    absorbed_Wm2: Float64[np.ndarray, "surfaces samples"],
    inner_Wm2: Float64[np.ndarray, "surfaces samples"],
    admittance: Complex128[np.ndarray, "surfaces harmonics"],
    skins: Skins,
    air: Air,
    start_K: Float64[np.ndarray, "surfaces samples"] | None = None,
    tolerance_K: float = 2e-3,
) -> DaySolution:
    """Periodic temperatures of many surfaces.

    Parameters
    ----------
    absorbed_Wm2 : float64 (surfaces, samples)
        Absorbed short-wave and long-wave radiation.
    inner_Wm2 : float64 (surfaces, samples)
        Heat that arrives from inside while the outer face is held at 0 K (transfer admittance times inner
        temperature).
    admittance : complex128 (surfaces, samples // 2 + 1)
        Outer admittance of each stack.
    skins : Skins
    air : Air
    start_K : float64 (surfaces, samples), optional
        First guess; air temperature otherwise.
    tolerance_K : float
        Largest change in the last step.
    """
    samples = absorbed_Wm2.shape[1]
    T = np.array(np.broadcast_to(air.temperature_K if start_K is None else start_K, absorbed_Wm2.shape))
    spectrum = np.fft.rfft(T)
    gained = absorbed_Wm2 + inner_Wm2
    for steps in range(1, _STEPS + 1):  # noqa: B007
        lost, slope = surface_losses(T, skins, air)
        stiffness = 0.5 * (slope.max(axis=1) + slope.mean(axis=1))[:, None]
        residual = np.fft.rfft(gained - lost) - admittance * spectrum
        spectrum += residual * _reciprocal(stiffness + admittance)
        T, before = np.fft.irfft(spectrum, n=samples), T
        if float(np.abs(T - before).max(initial=0.0)) < tolerance_K:
            break
    lost, _ = surface_losses(T, skins, air)
    left = gained - lost - np.fft.irfft(admittance * spectrum, n=samples)
    return DaySolution(T, loss_slope(T, skins, air), float(np.abs(left).max(initial=0.0)), steps)


def _reciprocal(z: Complex128[np.ndarray, "*shape"]) -> Complex128[np.ndarray, "*shape"]:
    """``1 / z`` without numpy's careful scaling, three times faster; our numbers are of ordinary size."""
    return np.asarray(np.conj(z) / (z.real**2 + z.imag**2))


def loss_slope(
    temperature_K: Float64[np.ndarray, "surfaces samples"], skins: Skins, air: Air
) -> Float64[np.ndarray, "surfaces samples"]:
    """Derivative of all losses by surface temperature [W m^-2 K^-1], by central difference over a tenth of a kelvin."""
    above, _ = surface_losses(temperature_K + 0.05, skins, air)
    below, _ = surface_losses(temperature_K - 0.05, skins, air)
    return np.asarray((above - below) / 0.1)
