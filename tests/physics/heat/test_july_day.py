"""15 July, 40 N, clear, 3 m/s: what everybody knows about warm and cold surfaces, on a tiny street."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from scenegen.climate.season import Season
from scenegen.climate.weather import Weather
from scenegen.heat.solve import HeatModel, solve, solve_uniform
from scenegen.radiometry.atmosphere import Atmosphere

SIDES = {
    "north": (0.0, 1.0, 0.0),
    "east": (1.0, 0.0, 0.0),
    "south": (0.0, -1.0, 0.0),
    "west": (-1.0, 0.0, 0.0),
}
ROOFS = ("bitumen_felt_roof", "epdm_black_roof", "metal_roof_painted_mid", "clay_roof_tile")
WALLS = ("brick_red", "concrete_wall", "stucco_render")
GROUND = ("asphalt_aged", "concrete_pavement", "grass_watered", "soil_dry")


def _street(handmade):
    names, patches = [], []
    for name in (*ROOFS, *GROUND, "tree_crown", "water_fresh_or_sea"):
        names.append(name)
        patches.append(handmade.patch(handmade.surface(name)))
    for name in WALLS:
        for side, normal in SIDES.items():
            names.append(f"{name} {side}")
            patches.append(
                handmade.patch(handmade.surface(name), normal, sky_view=0.45, neighbours=((0, 0.5),))
            )
    return names, handmade.world(patches)


def _at(handmade, weather, hour) -> dict[str, float]:
    names, (world, exposure) = _street(handmade)
    return dict(zip(names, solve(world, exposure, weather, hour).temperature_K.tolist(), strict=True))


def test_noon_roofs_are_hotter_than_walls(handmade, july):
    T = _at(handmade, july, 12.0)
    walls = [v for k, v in T.items() if k.split()[0] in WALLS]
    assert min(T[r] for r in ROOFS) > max(walls) + 5.0


def test_before_sunrise_roofs_are_colder_than_walls_and_ground(handmade, july):
    T = _at(handmade, july, 4.3)
    rest = [v for k, v in T.items() if k.split()[0] in WALLS] + [
        T["asphalt_aged"],
        T["concrete_pavement"],
        T["soil_dry"],
    ]
    assert max(T[r] for r in ROOFS) < min(rest)
    assert max(T[r] for r in ROOFS) < july.air_K(np.array(4.3)) - 2.0


def test_asphalt_is_warmer_than_grass_at_dusk(handmade, july):
    T = _at(handmade, july, 20.0)
    assert T["asphalt_aged"] > T["grass_watered"] + 6.0
    assert T["asphalt_aged"] > T["soil_dry"] > T["grass_watered"]


@pytest.mark.parametrize(("hour", "warmest"), [(8.0, "east"), (12.5, "south"), (17.0, "west")])
def test_the_sun_goes_round_the_house(handmade, july, hour, warmest):
    """In July the noon sun is high: the south wall leads only in the cooler seasons, so ask in October."""
    weather = july
    names, (world, exposure) = _street(handmade)
    if warmest == "south":
        patches = [handmade.patch(handmade.surface("stucco_render"), n, sky_view=0.5) for n in SIDES.values()]
        names = [f"stucco_render {side}" for side in SIDES]
        world, exposure = handmade.world(patches, season=Season(40.0, 10, 15))
    T = dict(zip(names, solve(world, exposure, weather, hour).temperature_K.tolist(), strict=True))
    assert max(SIDES, key=lambda side: T[f"stucco_render {side}"]) == warmest


def test_crowns_stay_near_air_and_water_near_the_daily_mean(handmade, july):
    for hour in (3.0, 14.0):
        T = _at(handmade, july, hour)
        assert abs(T["tree_crown"] - july.air_K(np.array(hour))) < 6.0
        assert T["water_fresh_or_sea"] == pytest.approx(july.air_mean_K - 0.2, abs=1e-3)


def test_snow_does_not_pass_the_melting_point(handmade, july):
    T = solve(*handmade.world([handmade.patch(handmade.surface("snow_medium"))]), july, 13.0).temperature_K
    assert T[0] == np.float32(273.15)


def test_a_day_repeats(handmade, july):
    _, (world, exposure) = _street(handmade)
    model = HeatModel.of(world, exposure)
    early, late = model.solve(july, 0.0).temperature_K, model.solve(july, 23.9999).temperature_K
    np.testing.assert_allclose(early, late, atol=0.02)


def test_polar_night_has_no_sun_and_is_plausible(handmade):
    cold = Weather(253.15, 1.5, 15.0, 248.15, 3.0, 0.0, 2.0)
    patches = [handmade.patch(handmade.surface(n)) for n in (*ROOFS, *GROUND)]
    world, exposure = handmade.world(patches, season=Season(80.0, 12, 21))
    state = solve(world, exposure, cold, 12.0)
    assert exposure.sun_hour.size == 0
    assert (state.temperature_K > 235.0).all()
    assert (state.temperature_K < 262.0).all()


def test_texture_is_strong_in_the_sun_weak_at_night_and_never_zero(handmade, july):
    names, (world, exposure) = _street(handmade)
    model = HeatModel.of(world, exposure)
    noon, night = (model.solve(july, hour).texture_K for hour in (13.0, 4.0))
    table = np.array([s.material.texture_K for s in world.palette])
    assert names
    assert (night >= 0.4 * table * 0.999).all()
    assert (noon > night).all()
    assert (noon <= 1.4 * table).all()
    asphalt = [s.material.name for s in world.palette].index("asphalt_aged")
    assert noon[asphalt] == pytest.approx(table[asphalt], rel=0.15)


def test_same_inputs_same_bytes(handmade, july):
    _, (world, exposure) = _street(handmade)
    first, second = (solve(world, exposure, july, 9.25) for _ in range(2))
    assert first.temperature_K.tobytes() == second.temperature_K.tobytes()
    assert first.texture_K.tobytes() == second.texture_K.tobytes()
    other = solve(world, exposure, replace(july, wind_mps=6.0), 9.25)
    assert other.temperature_K.tobytes() != first.temperature_K.tobytes()


def test_uniform_state_for_test_scenes(handmade):
    _, (world, _) = _street(handmade)
    air = Atmosphere(air_K=295.0, vapour_pressure_hPa=10.0, uniform_sky_K=295.0)
    state = solve_uniform(world, 295.0, air)
    assert state.atmosphere is air
    assert (state.temperature_K == np.float32(295.0)).all()
    assert (state.texture_K == 0.0).all()
    assert state.weather.vapour_pressure_hPa == pytest.approx(10.0, rel=1e-9)
