from __future__ import annotations

import numpy as np
import pytest
from pydantic import ValidationError

from scenegen_render.camera import Camera
from scenegen_render.knobs import RenderKnobs
from scenegen_render.trace.pixels import image_plane, subsample_pattern, tiled

COUNTS = [1, 3, 4, 5, 8, 9, 16, 64]


@pytest.mark.parametrize("count", COUNTS)
def test_the_first_sub_sample_is_the_pixel_centre_and_so_is_their_mean(count):
    pattern = subsample_pattern(count)
    assert pattern.shape == (count, 2)
    assert tuple(pattern[0]) == (0.5, 0.5)
    assert pattern.min() >= 0 and pattern.max() <= 1
    np.testing.assert_allclose(pattern.mean(axis=0), 0.5, atol=1e-12)


def test_more_sub_samples_cover_edges_better():
    """Share of the pixel behind random straight edges: the error falls, and four samples keep it below 10 % rms."""
    rng = np.random.default_rng(0)
    angle, offset = rng.uniform(0, 2 * np.pi, 2000), rng.uniform(-0.6, 0.6, 2000)
    normal = np.stack([np.cos(angle), np.sin(angle)])

    def covered(points: np.ndarray) -> np.ndarray:
        return ((points - 0.5) @ normal < offset).mean(axis=0)

    grid = (np.mgrid[0:64, 0:64].reshape(2, -1).T + 0.5) / 64
    error = [float(np.sqrt(((covered(subsample_pattern(n)) - covered(grid)) ** 2).mean())) for n in COUNTS]
    assert error == sorted(error, reverse=True)
    assert error[COUNTS.index(4)] < 0.105 and error[COUNTS.index(64)] < 0.015


def test_two_sub_samples_are_refused_with_the_reason():
    with pytest.raises(ValidationError, match="choose 1, 3 or more"):
        RenderKnobs(sub_samples=2)
    with pytest.raises(ValidationError):
        RenderKnobs(sub_samples=257)


def test_directions_follow_the_pinhole_convention():
    camera = Camera.from_fov(4, 2, 90.0)
    plane = image_plane(camera, np.array([[0.5, 0.5]])).reshape(2, 4, 2)
    np.testing.assert_allclose(plane[0, 0], (-0.75, -0.25))  # upper left: x and y point right and down
    np.testing.assert_allclose(plane[1, 3], (0.75, 0.25))


def test_lanes_visit_every_pixel_once_tile_by_tile():
    camera = Camera.from_fov(10, 6, 90.0)
    order = tiled(camera)
    assert sorted(order) == list(range(60))
    row, column = np.divmod(order[:16], 10)
    assert row.max() == 3 and column.max() == 3
    plane = image_plane(camera, np.array([[0.5, 0.5]]))
    np.testing.assert_allclose(plane[:, 0], (order % 10 + 0.5 - 5.0) / 5.0, rtol=1e-6)
