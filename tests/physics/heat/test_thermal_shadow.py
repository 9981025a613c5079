"""Sites of a class against a balance solved for each of them: shadows leave the trace they should."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from scenegen.heat.balance import solve_day
from scenegen.heat.shadow import memory
from scenegen.heat.solve import solve

SOUTH = (0.0, -1.0, 0.0)


def _exactly(handmade, name, normal, weather, hour, blocked):
    """The full non-linear balance of one site whose sun is blocked between two hours."""
    p = handmade.roofs((name,), weather, normal=normal)
    beam = p.day.direct_Wm2 * np.maximum(p.day.sun @ np.array(normal), 0.0)
    step = 24.0 / p.day.hour.size
    first, last = np.maximum(blocked[0], p.day.hour - step / 2), np.minimum(blocked[1], p.day.hour + step / 2)
    hidden = np.clip((last - first) / step, 0.0, 1.0)
    m = handmade.surface(name).material
    absorbed = p.absorbed - m.solar_absorptance * m.direct_factor * beam * hidden
    T = solve_day(absorbed, p.inner, p.admittance, p.skins, p.day.air).temperature_K[0]
    return np.interp(hour, p.day.hour, T)


@pytest.mark.parametrize(
    "name", ["asphalt_aged", "bitumen_felt_roof", "grass_watered", "soil_dry", "tree_crown"]
)
@pytest.mark.parametrize("hour", [5.0, 11.0, 13.5, 14.5, 16.0, 20.0])
def test_shadowed_sites_match_their_own_balance(handmade, july, name, hour):
    windows = [(0.0, 0.0), (0.0, 24.0), (12.0, 14.0), (6.0, 13.0), (14.0, 24.0), (9.0, 10.0)]
    surface = handmade.surface(name)

    def sun(blocked):
        return lambda h: ~((h > blocked[0]) & (h < blocked[1]))

    patches = [handmade.patch(surface, sees_sun=sun(b)) for b in windows]
    state = solve(*handmade.world(patches, sun_times=144), july, hour)
    expected = [_exactly(handmade, name, (0.0, 0.0, 1.0), july, hour, b) for b in windows]
    # Half a sun step (three minutes) of doubt about when a shadow begins, besides the expansion itself.
    np.testing.assert_allclose(state.temperature_K, expected, atol=0.6)


def test_a_shadow_that_moved_on_leaves_its_trace(handmade, july):
    """Asphalt in shadow from 12 to 14 h is 8.3 K colder half an hour later, still 2 K at 18 h and 1 K at 23 h."""
    asphalt = handmade.surface("asphalt_aged")
    parked = handmade.patch(asphalt, sees_sun=lambda h: ~((h > 12.0) & (h < 14.0)))
    free = handmade.patch(asphalt)
    world, exposure = handmade.world([parked, free], sun_times=144)
    trace = {
        hour: np.diff(solve(world, exposure, july, hour).temperature_K)[0]
        for hour in (11.5, 14.5, 18.0, 23.0)
    }
    for hour, expected in (
        (11.5, 0.54),
        (14.5, 8.27),
        (18.0, 2.08),
        (23.0, 1.09),
    ):  # the exact balance, 2304 samples
        assert trace[hour] == pytest.approx(expected, rel=0.05, abs=0.08)


def test_memory_is_the_answer_to_a_pulse(handmade, july):
    """Perturbing the absorbed flux at one instant changes the temperature now by the weight of that instant."""
    p = handmade.roofs(("asphalt_aged", "metal_roof_painted_mid"), july)
    base = solve_day(p.absorbed, p.inner, p.admittance, p.skins, p.day.air)
    weight = memory(base.slope_Wm2K, p.admittance)
    for instant in (0, 143, 130, 72):
        pulse = np.zeros(144)
        pulse[instant] = 20.0
        above = solve_day(p.absorbed + pulse, p.inner, p.admittance, p.skins, p.day.air, base.temperature_K)
        below = solve_day(p.absorbed - pulse, p.inner, p.admittance, p.skins, p.day.air, base.temperature_K)
        answer = (above.temperature_K[:, 0] - below.temperature_K[:, 0]) / 40.0
        np.testing.assert_allclose(weight[:, instant], answer, atol=3e-3 * np.abs(weight).max() + 4e-5)


def test_the_past_counts_and_the_future_does_not(handmade, july):
    p = handmade.roofs(("asphalt_aged",), july)
    base = solve_day(p.absorbed, p.inner, p.admittance, p.skins, p.day.air)
    weight = memory(base.slope_Wm2K, p.admittance)[0]
    mean = weight[1:].reshape(-1, 11).mean(axis=1)  # sharp steps ring at the highest harmonic; means do not
    assert (mean > -0.005 * weight.max()).all()
    assert mean[-1] > 10.0 * abs(mean[0])  # the last two hours against the next two (that is, yesterday's)
    assert (np.diff(mean[-6:]) > 0.0).all()


@pytest.mark.parametrize("wind", [0.5, 8.0])
def test_walls_in_wind_and_calm(handmade, july, wind):
    weather = replace(july, wind_mps=wind)
    brick = handmade.surface("brick_red")
    patches = [handmade.patch(brick, SOUTH), handmade.patch(brick, SOUTH, sees_sun=lambda h: h < 12.0)]
    state = solve(*handmade.world(patches, sun_times=144), weather, 13.0)
    sunny, half = state.temperature_K
    assert sunny > half + 1.0
