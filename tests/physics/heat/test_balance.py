"""The periodic balance: a linear closed form, energy closure, convergence at any wind."""

from __future__ import annotations

import math
from dataclasses import replace

import numpy as np
import pytest

from scenegen.heat.balance import SAMPLES, Air, Skins, solve_day, surface_losses
from scenegen.heat.conduction import Layer, Stack, admittance, harmonics

NAMES = ("asphalt_aged", "brick_red", "metal_roof_painted_mid", "grass_watered", "soil_wet", "tree_crown")


def test_a_small_flux_follows_the_linear_closed_form():
    """Tiny harmonic flux on an isothermal radiating half space: amplitude and lag of q / (H + Y)."""
    quiet = Skins(
        np.array([0.5]), np.array([0.0]), np.array([1.0]), np.array([0.0]), np.array([0.0]), np.array([0.0])
    )
    air = Air(np.full(SAMPLES, 290.0), 1.0, 10.0)
    Y, _ = admittance(Stack((Layer(1.0, 2000.0, 900.0, math.inf),), math.inf), harmonics(SAMPLES))
    phase = 2 * np.pi * np.arange(SAMPLES) / SAMPLES
    steady = 0.5 * 5.670374419e-8 * 290.0**4
    T = solve_day(
        (steady + 0.1 * np.cos(phase))[None], np.zeros((1, SAMPLES)), Y[None], quiet, air
    ).temperature_K[0]
    answer = 0.1 / (4 * 0.5 * 5.670374419e-8 * 290.0**3 + Y[1])
    np.testing.assert_allclose(
        T - 290.0, abs(answer) * np.cos(phase + np.angle(answer)), atol=2e-5 * abs(answer) + 2e-6
    )


def test_energy_closes_over_the_day(handmade, july):
    """Nothing flows into endless ground on average, and the residual is small at every instant."""
    names = ("asphalt_aged", "soil_dry", "sand_wet", "grass_watered", "granite")
    p = handmade.roofs(names, july)
    solution = solve_day(p.absorbed, p.inner, p.admittance, p.skins, p.day.air)
    lost, _ = surface_losses(solution.temperature_K, p.skins, p.day.air)
    into_ground = (p.absorbed - lost).mean(axis=1)
    np.testing.assert_allclose(into_ground, 0.0, atol=0.02)
    assert solution.residual_Wm2 < 0.2
    assert solution.steps <= 14


@pytest.mark.parametrize("wind", [0.0, 0.3, 3.0, 20.0])
def test_it_converges_at_any_wind(handmade, wind, july):
    p = handmade.roofs(NAMES, replace(july, wind_mps=wind))
    solution = solve_day(p.absorbed, p.inner, p.admittance, p.skins, p.day.air)
    assert solution.residual_Wm2 < 0.5
    assert solution.steps < 40
