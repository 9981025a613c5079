"""Layered conduction against closed forms."""

from __future__ import annotations

import math

import numpy as np
import pytest

from scenegen.heat.conduction import Layer, Stack, admittance, harmonics

OMEGA = harmonics(144)
CONCRETE = Layer(1.95, 2240.0, 900.0, 0.2)


def test_heated_slab_reference():
    Y, passed = admittance(Stack((CONCRETE,), 1.0 / 0.13), OMEGA)
    assert Y[1] == pytest.approx(10.998451 + 13.262683j, abs=1e-6)
    assert Y[0] == pytest.approx(1.0 / (0.13 + 0.2 / 1.95), rel=1e-12)
    assert passed[0] == pytest.approx(Y[0], rel=1e-12)  # in a steady state what enters leaves


def test_thin_adiabatic_steel_is_a_capacity():
    Y, passed = admittance(Stack((Layer(45.3, 7824.0, 500.0, 0.0008),), 0.0), OMEGA)
    assert abs(Y[1]) == pytest.approx(0.2276, abs=5e-5)
    assert Y[0] == 0.0
    np.testing.assert_array_equal(passed, 0.0)


@pytest.mark.parametrize(("h", "amplitude", "lag_h"), [(15.0, 12.26173, 1.28727), (0.0, 26.22116, 3.0)])
def test_endless_ground_amplitude_and_lag(h, amplitude, lag_h):
    Y, _ = admittance(Stack((Layer(1.0, 2000.0, 900.0, math.inf),), math.inf), OMEGA)
    answer = 300.0 / (h + Y[1])
    assert abs(answer) == pytest.approx(amplitude, abs=1e-5)
    assert -np.angle(answer) / OMEGA[1] / 3600.0 == pytest.approx(lag_h, abs=1e-5)
    assert Y[0] == 0.0


def test_a_deep_layer_is_endless_and_never_overflows():
    deep, _ = admittance(Stack((Layer(0.4, 1500.0, 900.0, 500.0),), 7.7), OMEGA)
    endless, _ = admittance(Stack((Layer(0.4, 1500.0, 900.0, math.inf),), math.inf), OMEGA)
    assert np.isfinite(deep).all()
    np.testing.assert_allclose(deep[1:], endless[1:], rtol=1e-12)


def test_splitting_a_layer_changes_nothing():
    half = Layer(1.95, 2240.0, 900.0, 0.1)
    whole, two = (admittance(Stack(layers, 5.0), OMEGA) for layers in ((CONCRETE,), (half, half)))
    np.testing.assert_allclose(two[0], whole[0], rtol=1e-12)
    np.testing.assert_allclose(two[1], whole[1], rtol=1e-10, atol=1e-14)


def test_reciprocity_of_the_transfer():
    """The flux that crosses is the same whichever side is warmed."""
    brick, foam = Layer(0.89, 1920.0, 790.0, 0.1), Layer(0.04, 43.0, 1210.0, 0.08)
    air = 1e9  # a perfect contact stands in for a prescribed outer temperature
    _, forward = admittance(Stack((brick, foam), air), OMEGA[:20])
    _, backward = admittance(Stack((foam, brick), air), OMEGA[:20])
    np.testing.assert_allclose(forward, backward, rtol=1e-6)
