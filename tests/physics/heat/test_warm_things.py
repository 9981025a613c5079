"""Engines, exhausts, tyres and bodies: steady states against a root of the balance that the solver never sees."""

from __future__ import annotations

import numpy as np
import pytest
from scipy.optimize import brentq

from scenegen.heat.balance import SAMPLES, Air, Skins, solve_day
from scenegen.heat.conduction import admittance, harmonics
from scenegen.heat.construction import construction
from scenegen.heat.convection import convection_coefficient
from scenegen.heat.solve import solve
from scenegen.materials.material import Surface
from scenegen.materials.table import material
from scenegen.radiometry.planck import STEFAN_BOLTZMANN

AIRS_K = (263.15, 283.15, 303.15)
WIND_MPS = 2.5


def skins(surface: Surface) -> Skins:
    m = surface.material
    rows = (
        surface.emissivity,
        0.0,
        m.roughness_factor,
        m.convection_factor,
        m.wetness,
        m.stomatal_resistance_sm,
    )
    return Skins(*(np.array([v], np.float64) for v in rows))


def solved_K(surface: Surface, air_K: float, wind_mps: float = WIND_MPS) -> float:
    """Upright, without sun, surrounded by black walls at air temperature, all day long."""
    built = construction(surface)
    Y, transfer = admittance(built.stack, harmonics(SAMPLES))
    behind = built.inner_K if np.isfinite(built.inner_K) else air_K
    inner = np.full((1, SAMPLES), transfer[0].real * behind + built.arriving_Wm2)
    absorbed = np.full((1, SAMPLES), surface.emissivity * STEFAN_BOLTZMANN * air_K**4)
    air = Air(np.full(SAMPLES, air_K), wind_mps, 8.0)
    day = solve_day(absorbed, inner, Y[None], skins(surface), air, tolerance_K=1e-7)
    assert np.ptp(day.temperature_K) < 1e-5
    return float(day.temperature_K[0, 0])


def analytic_K(
    surface: Surface, air_K: float, h_in: float, inside_K: float, source_Wm2: float = 0.0
) -> float:
    """Root of ``(T_in - T) / (1 / h_in + L / k) + q = eps sigma (T^4 - T_air^4) + h (T - T_air)``."""
    m = surface.material
    U = 1.0 / (1.0 / h_in + m.thickness_m / m.conductivity_WmK) if h_in else 0.0

    def gain(T: float) -> float:
        excess, level, rough = (np.array([v]) for v in (T - air_K, 0.0, m.roughness_factor))
        h = m.convection_factor * float(convection_coefficient(excess, level, WIND_MPS, rough)[0])
        radiated = surface.emissivity * STEFAN_BOLTZMANN * (T**4 - air_K**4)
        return U * (inside_K - T) + source_Wm2 - radiated - h * (T - air_K)

    return float(brentq(gain, 200.0, 500.0, xtol=1e-9))


@pytest.mark.parametrize("air_K", AIRS_K)
@pytest.mark.parametrize("name", ["car_paint_black", "car_paint_silver", "steel_oxidised", "gelcoat_white"])
def test_a_panel_over_an_engine_bay_is_in_balance(name, air_K):
    row = material(name)
    bonnet = Surface(row, row.emissivity, row.solar_absorptance, interior_K=345.0)
    T = solved_K(bonnet, air_K)
    assert pytest.approx(analytic_K(bonnet, air_K, 10.0, 345.0), abs=1e-4) == T
    assert air_K + 10.0 < T < 330.0  # warm, and cooler than boiling coolant


def test_a_running_bonnet_is_tens_of_kelvin_above_the_air_and_a_parked_one_is_not():
    row = material("car_paint_black")
    parked = Surface(row, row.emissivity, row.solar_absorptance)
    driven = Surface(row, row.emissivity, row.solar_absorptance, interior_K=345.0)
    assert solved_K(parked, 283.15) == pytest.approx(283.15, abs=1e-3)
    assert 18.0 < solved_K(driven, 283.15) - 283.15 < 40.0


@pytest.mark.parametrize("air_K", AIRS_K)
@pytest.mark.parametrize("released", [200.0, 320.0])
def test_a_rolling_tyre_is_10_to_25_K_above_the_air(air_K, released):
    row = material("tyre_rubber")
    tyre = Surface(row, row.emissivity, row.solar_absorptance, released_Wm2=released)
    T = solved_K(tyre, air_K)
    assert pytest.approx(analytic_K(tyre, air_K, 0.0, 0.0, released), abs=1e-4) == T
    assert 9.0 < T - air_K < 25.0


def test_heat_released_behind_a_layer_divides_by_the_resistances():
    row = material("gelcoat_white")
    hull = Surface(row, row.emissivity, row.solar_absorptance, interior_K=290.0, released_Wm2=100.0)
    built = construction(hull)
    R = row.thickness_m / row.conductivity_WmK
    assert built.arriving_Wm2 == pytest.approx(100.0 / (1.0 + 10.0 * R))
    assert construction(Surface(material("soil_dry"), 0.96, 0.8, released_Wm2=50.0)).arriving_Wm2 == 0.0


@pytest.mark.parametrize(
    ("air_C", "low_C", "high_C"), [(0.0, 8.0, 25.0), (20.0, 24.0, 33.0), (35.0, 34.0, 37.0)]
)
def test_bare_skin_stays_in_the_physiological_range(air_C, low_C, high_C):
    row = material("human_skin")
    T = solved_K(Surface(row, row.emissivity, row.solar_absorptance), air_C + 273.15, 1.0)
    assert low_C < T - 273.15 < high_C
    assert row.max_temperature_K < 310.15  # sweat


@pytest.mark.parametrize("air_K", [273.15, 293.15])
@pytest.mark.parametrize("name", ["human_skin", "clothing", "clothing_winter", "hair"])
def test_bodies_are_in_balance_with_their_core(name, air_K):
    row = material(name)
    surface = Surface(row, row.emissivity, row.solar_absorptance)
    assert solved_K(surface, air_K) == pytest.approx(analytic_K(surface, air_K, 12.0, 310.15), abs=1e-4)


def test_thicker_clothes_are_colder_outside():
    def outside_K(name: str) -> float:
        row = material(name)
        return solved_K(Surface(row, row.emissivity, row.solar_absorptance), 268.15)

    skin, cloth, coat = (outside_K(n) for n in ("human_skin", "clothing", "clothing_winter"))
    assert skin > cloth + 2.0 > coat + 4.0 > 268.15 + 5.0


def test_warmth_reaches_the_sites_of_a_world(handmade, july):
    """A wall of rolling tyres against resting ones, by the losses' own slope."""
    west, night = (0.0, -1.0, 0.0), 3.0
    rest, roll = handmade.surface("tyre_rubber"), handmade.surface("tyre_rubber", released_Wm2=250.0)
    patches = [handmade.patch(s, west) for s in (rest, roll)]
    T = solve(*handmade.world(patches), july, night).temperature_K
    p = handmade.roofs(("tyre_rubber",), july, normal=west)
    slope = float(solve_day(p.absorbed, p.inner, p.admittance, p.skins, p.day.air).slope_Wm2K.mean())
    assert float(T[1] - T[0]) == pytest.approx(250.0 / slope, rel=0.15)
