"""What the viewer says and draws of one frame, against hand-made values."""

import numpy as np
import pytest

from scenegen.classes import CLASSES
from scenegen_datasets.view.library import Still
from scenegen_datasets.view.panels import Ranges, drawable, panel
from scenegen_datasets.view.points import back_projected, edges, frustum, linear
from scenegen_datasets.view.readout import readout

ROWS, COLUMNS = 12, 16
K = np.array([[20.0, 0.0, 8.0], [0.0, 20.0, 6.0], [0.0, 0.0, 1.0]])


def still() -> Still:
    """A plane 5 m ahead of a camera that looks north, its upper three rows sky."""
    shape = (ROWS, COLUMNS)
    depth = np.full(shape, 5.0, np.float32)
    depth[:3] = np.inf
    counts = np.arange(ROWS * COLUMNS, dtype=np.uint16).reshape(shape) + 4000
    pose = np.eye(4)
    pose[:3, :3] = np.array(
        [[1.0, 0, 0], [0, 0, 1.0], [0, -1.0, 0]]
    )  # columns: right is east, down is down, ahead north
    pose[:3, 3] = (100.0, 200.0, 30.0)
    layers = {
        "thermal": counts,
        "depth": depth,
        "temperature": np.where(np.isfinite(depth), 290.5, 0.0).astype(np.float32),
        "semantic": np.where(np.isfinite(depth), 10, 0).astype(np.uint8),
        "instance": np.where(np.isfinite(depth), 77, 0).astype(np.uint32),
        "material": np.where(np.isfinite(depth), 3, 0).astype(np.uint16),
        "flow": np.stack([np.full(shape, 1.5), np.full(shape, -0.25)], axis=-1).astype(np.float32),
    }
    kelvin = (250.0 + counts * 0.01).astype(np.float32)
    return Still("city-00000-000-0001", layers, kelvin, kelvin * 0.1, pose, K, 0.1)


def test_numbers_are_those_of_the_pixel() -> None:
    found = readout(still(), 4, 7, {3: "brick"})
    count = 4000 + 7 * COLUMNS + 4
    assert found["thermal"] == f"{count} counts"
    assert found["brightness"] == f"{250.0 + count * 0.01:.2f} K"
    assert found["depth"] == "5.000 m"
    assert found["kinetic"] == "290.50 K"
    assert found["class"] == next(c.name for c in CLASSES if int(c.id) == 10)
    assert (found["object"], found["material"], found["flow"]) == ("77", "brick", "(+1.50, -0.25) px")


def test_sky_is_called_sky() -> None:
    found = readout(still(), 0, 0, {})
    assert [found[name] for name in ("depth", "kinetic", "class", "material")] == ["sky"] * 4


@pytest.mark.parametrize("place", [(-1, 0), (COLUMNS, 0), (0, ROWS)])
def test_outside_the_picture_is_an_error(place: tuple[int, int]) -> None:
    with pytest.raises(IndexError):
        readout(still(), *place, {})


def test_points_lie_where_the_plane_is() -> None:
    picture = np.zeros((ROWS, COLUMNS, 3), np.uint8)
    points, colours = back_projected(still(), picture, 10.0)
    assert len(points) == len(colours) == (ROWS - 3) * COLUMNS
    np.testing.assert_allclose(points[:, 1], 205.0)  # 5 m north of the camera
    # The first point is pixel (0, 3): its centre is (0.5, 3.5).
    np.testing.assert_allclose(points[0], [100 + 5 * (0.5 - 8) / 20, 205.0, 30 - 5 * (3.5 - 6) / 20])


def test_few_points_are_an_even_grid_and_far_ones_are_left_out() -> None:
    picture = np.zeros((ROWS, COLUMNS, 3), np.uint8)
    assert len(back_projected(still(), picture, 10.0, most=50)[0]) <= 50
    assert len(back_projected(still(), picture, 4.9)[0]) == 0


def test_the_frustum_starts_at_the_camera() -> None:
    corners = frustum(still(), 2.0)
    np.testing.assert_allclose(corners[0], [100, 200, 30])
    np.testing.assert_allclose(corners[1:, 1], 202.0)
    np.testing.assert_allclose(corners[1, [0, 2]], [100 - 0.8, 30 + 0.6])  # upper left


def test_the_roof_of_the_frustum_is_above_the_pictures_upper_edge() -> None:
    lines = edges(frustum(still(), 2.0))
    assert len(lines) == 10
    ends = np.array([b for _, b in lines[:4]])
    ridge = lines[-1][0]
    np.testing.assert_allclose(ridge, [100, 202, 30 + 0.6 + 0.25 * 1.2])
    assert ridge[2] > ends[:, 2].max()


def test_points_are_shaded_in_linear_light() -> None:
    shares = linear(np.array([[0, 128, 255], [10, 188, 55]], np.uint8))
    np.testing.assert_allclose(
        shares[0], [0.0, 0.21586, 1.0], atol=1e-5
    )  # 128 of 255 is a fifth of the light
    np.testing.assert_allclose(shares[1], [0.003035, 0.50289, 0.03820], atol=1e-5)


def test_bars_run_as_the_pictures_do() -> None:
    shown = still()
    ranges = Ranges.of([shown])
    thermal = panel(shown, "thermal", ranges, "linear", "white hot").ramp
    assert thermal is not None and thermal.colours[0][0] < 5 and thermal.colours[-1][0] > 250
    assert thermal.css.startswith("linear-gradient(90deg,rgb(") and thermal.low.endswith("K")
    depth = panel(shown, "depth", ranges, "linear", "white hot").ramp
    assert depth is not None and sum(depth.colours[0]) > sum(depth.colours[-1])  # near is bright
    classes = panel(shown, "semantic", ranges, "linear", "white hot")
    name = next(c.name for c in CLASSES if int(c.id) == 10).replace("_", " ")
    assert [words for _, words in classes.key] == [name, "sky"]  # the commoner first


def test_every_layer_has_a_picture_and_a_caption() -> None:
    shown = still()
    ranges = Ranges.of([shown])
    for name in drawable(tuple(shown.layers)):
        drawn = panel(shown, name, ranges, "plateau", "white hot")
        assert drawn.picture.shape == (ROWS, COLUMNS, 3) and drawn.picture.dtype == np.uint8
        assert drawn.caption


def test_black_hot_is_white_hot_inverted_and_gains_keep_the_order() -> None:
    shown = still()
    ranges = Ranges.of([shown])
    for gain in ("plateau", "linear", "clip"):
        white = panel(shown, "thermal", ranges, gain, "white hot").picture.astype(int)
        black = panel(shown, "thermal", ranges, gain, "black hot").picture.astype(int)
        assert np.all(white + black == 255)
        assert np.all(np.diff(white[..., 0].ravel()) >= 0)  # counts rise from pixel to pixel
