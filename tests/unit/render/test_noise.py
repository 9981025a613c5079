from __future__ import annotations

import numpy as np
import pytest

from scenegen_render import backend
from scenegen_render.trace import noise


def _sample(points: np.ndarray, seed: int) -> np.ndarray:
    mi, dr = backend.modules()
    p = mi.Vector3f(*(mi.Float(np.ascontiguousarray(c, np.float32)) for c in points.T))
    return np.asarray(noise.value_noise(p, dr.opaque(mi.UInt, seed))) * noise.UNIT


@pytest.fixture(scope="module")
def places() -> np.ndarray:
    return np.random.default_rng(4).uniform(-300, 300, (200_000, 3))


def test_noise_has_zero_mean_and_unit_deviation(places):
    values = _sample(places, 12345)
    assert abs(values.mean()) < 0.02
    assert abs(values.std() - 1.0) < 0.02


def test_seeds_and_distant_cells_are_independent(places):
    a, b = _sample(places, 1), _sample(places, 2)
    assert abs(np.corrcoef(a, b)[0, 1]) < 0.02
    for step in ([3.0, 0, 0], [0, 3.0, 0], [0, 0, 3.0], [4.0, 4.0, 4.0], [16.0, 0, 0]):
        assert abs(np.corrcoef(a, _sample(places + step, 1))[0, 1]) < 0.02


def test_noise_is_smooth_across_cell_borders():
    x = np.linspace(-3, 3, 6001)
    line = _sample(np.stack([x, 0.3 + 0 * x, 0.7 + 0 * x], axis=-1), 9)
    assert np.abs(np.diff(line)).max() < 0.02
    assert line.std() > 0.2


def test_tilting_is_a_rotation():
    mi, _ = backend.modules()
    turned = np.asarray(noise.tilted(mi.Vector3f([1.0, 0, 0], [0, 1.0, 0], [0, 0, 1.0])))
    np.testing.assert_allclose(turned @ turned.T, np.eye(3), atol=1e-6)
    assert np.abs(turned).min() > 0.05  # parallel to no axis
