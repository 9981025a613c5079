"""Long-wave exchange and reflected sun between neighbours."""

from __future__ import annotations

import numpy as np
import pytest

from scenegen.heat.balance import solve_day
from scenegen.heat.emitters import EMITTER_GROUPS, group, group_sites
from scenegen.heat.solve import solve
from scenegen.radiometry.planck import STEFAN_BOLTZMANN

EAST, WEST = (1.0, 0.0, 0.0), (-1.0, 0.0, 0.0)
STREET, LAWN, ROOF = 0, 2, 5


def test_a_wall_over_asphalt_is_warmer_than_one_over_grass(handmade, july):
    brick = handmade.surface("brick_red")
    patches = [
        handmade.patch(handmade.surface("asphalt_aged")),
        handmade.patch(handmade.surface("grass_watered")),
        handmade.patch(brick, EAST, sky_view=0.5, neighbours=((STREET, 0.5),)),
        handmade.patch(brick, EAST, sky_view=0.5, neighbours=((LAWN, 0.5),)),
    ]
    world, exposure = handmade.world(patches)
    assert [int(g) for g in group_sites(world)[0][:2]] == [STREET, LAWN]
    for hour, least in ((15.0, 1.0), (22.0, 0.3)):
        T = solve(world, exposure, july, hour).temperature_K
        assert T[0] > T[1]
        assert T[2] > T[3] + least


def test_a_hot_neighbour_of_prescribed_temperature(handmade, july):
    """The warming is the extra power over the wall's own loss coefficient."""
    wall = handmade.surface("stucco_render")
    hot = handmade.surface("bitumen_felt_roof", prescribed_K=360.0)
    patches = [
        handmade.patch(hot),
        handmade.patch(wall, WEST, sky_view=0.4, neighbours=((ROOF, 0.2),)),
        handmade.patch(wall, WEST, sky_view=0.4, neighbours=((ROOF, 0.0),)),
    ]
    world, exposure = handmade.world(patches)
    assert group(hot, 0) == ROOF
    T = solve(world, exposure, july, 2.0).temperature_K
    assert T[0] == np.float32(360.0)
    warming = float(T[1] - T[2])
    p = handmade.roofs(("stucco_render",), july, normal=WEST)
    plain = solve_day(p.absorbed, p.inner, p.admittance, p.skins, p.day.air)
    radiosity = 0.95 * STEFAN_BOLTZMANN * 360.0**4 + 0.05 * p.day.sky_Wm2
    extra_Wm2 = 0.93 * 0.2 * (radiosity - p.day.ground_long_Wm2)
    expected = np.interp(2.0, p.day.hour, extra_Wm2) / (plain.slope_Wm2K.mean() + p.admittance[0, 0].real)
    assert warming == pytest.approx(expected, rel=0.12)


def test_open_sky_is_colder_than_a_street_canyon_at_night(handmade, july):
    asphalt = handmade.surface("asphalt_aged")
    brick = handmade.surface("brick_red")
    walls = group(brick, 18)
    patches = [
        handmade.patch(asphalt),
        handmade.patch(asphalt, sky_view=0.4, neighbours=((walls, 0.6),), sees_sun=lambda h: h > 0.0),
        handmade.patch(brick, EAST),
    ]
    T = solve(*handmade.world(patches), july, 4.0).temperature_K
    assert T[1] > T[0] + 1.0


def test_reflected_sun_warms(handmade, july):
    """A wall in front of white membrane receives more light than one in front of black rubber of equal temperature."""
    wall = handmade.surface("brick_red")
    pale = handmade.surface("white_membrane_roof", prescribed_K=310.0)
    dark = handmade.surface("epdm_black_roof", prescribed_K=310.0)
    warm = {}
    for name, roof in (("pale", pale), ("dark", dark)):
        patches = [handmade.patch(roof), handmade.patch(wall, EAST, sky_view=0.5, neighbours=((ROOF, 0.5),))]
        warm[name] = solve(*handmade.world(patches), july, 13.0).temperature_K[1]
    assert warm["pale"] > warm["dark"] + 2.0


def test_every_group_is_in_range_and_used():
    from scenegen.heat.classes import ORIENTATIONS
    from scenegen.materials.material import Surface
    from scenegen.materials.table import materials

    used = {group(Surface(m, 0.9, 0.9), o) for m in materials().values() for o in range(ORIENTATIONS)}
    assert used == set(range(EMITTER_GROUPS))
