from __future__ import annotations

import numpy as np
import pytest

from scenegen.foundation.rng import stream
from scenegen_render.exposure.directions import cosine_directions, split_directions, tangents, upright_frame
from scenegen_render.exposure.order import spatial_order


@pytest.mark.parametrize("count", [64, 128, 1024])
def test_directions_are_cosine_weighted(count: int) -> None:
    d = cosine_directions(count)
    np.testing.assert_allclose(np.linalg.norm(d, axis=1), 1.0, atol=1e-9)
    ring = d[:, 2] ** 2 * count
    assert np.all(ring >= np.arange(count) - 1e-6)  # one direction in each ring of equal weight
    assert np.all(ring <= np.arange(count) + 1 + 1e-6)
    assert abs(float(np.mean(d[:, 2] ** 2)) - 0.5) < 1e-3
    np.testing.assert_allclose(d[:, :2].mean(axis=0), 0.0, atol=0.6 / count**0.75)


def test_directions_do_not_clump() -> None:
    d = cosine_directions(256)[:, :2]
    apart = np.linalg.norm(d[:, None] - d[None], axis=2) + 9 * np.eye(256)
    assert apart.min() > 0.5 * np.sqrt(np.pi / 256)


def test_frames_are_right_handed_and_turn() -> None:
    n = stream(1).standard_normal((500, 3))
    n = np.concatenate([n / np.linalg.norm(n, axis=1, keepdims=True), np.eye(3), -np.eye(3)]).astype(
        np.float32
    )
    turn = stream(2).random(len(n), dtype=np.float32)
    first, second = tangents(n, turn)
    np.testing.assert_allclose(np.cross(first, second), n, atol=1e-6)
    np.testing.assert_allclose(np.einsum("sk,sk->s", first, n), 0.0, atol=1e-6)
    straight, _ = tangents(n, np.zeros_like(turn))
    cosine = np.einsum("sk,sk->s", first, straight)
    np.testing.assert_allclose(cosine, np.cos(2 * np.pi * turn.astype(np.float64)), atol=1e-5)


def test_spatial_order_is_a_permutation_that_keeps_neighbours_together() -> None:
    position = (stream(3).random((20_000, 3)) * [400, 400, 30] - [200, 200, 0]).astype(np.float32)
    order = spatial_order(position)
    np.testing.assert_array_equal(np.sort(order), np.arange(len(position)))
    hop = np.linalg.norm(np.diff(position[order], axis=0), axis=1)
    assert float(np.median(hop)) < 10.0
    assert float(np.median(np.linalg.norm(np.diff(position, axis=0), axis=1))) > 100.0


def test_equal_positions_keep_their_order() -> None:
    np.testing.assert_array_equal(spatial_order(np.ones((5, 3), np.float32)), np.arange(5))


def test_walls_split_their_hemisphere_at_the_horizon() -> None:
    d = split_directions(64)
    assert int((d[:, 2] == 0).sum()) == 32
    for half in (0.0, 1.0):
        ring = np.sort(d[d[:, 2] == half, 0]) ** 2 * 32
        np.testing.assert_allclose(ring, np.arange(32) + 0.5)
    assert float(d[:, 1].min()) >= 0.0
    assert float(d[:, 1].max()) < 1.0


def test_upright_frames_point_along_and_up() -> None:
    azimuth = stream(4).uniform(0, 2 * np.pi, 50)
    n = np.stack([np.cos(azimuth), np.sin(azimuth), np.zeros(50)], axis=1).astype(np.float32)
    level, up = upright_frame(n)
    np.testing.assert_allclose(up, np.broadcast_to([0.0, 0.0, 1.0], up.shape), atol=1e-6)
    np.testing.assert_allclose(np.cross(level, up), n, atol=1e-6)
