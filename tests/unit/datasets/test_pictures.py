"""Pictures say what the layers say, and the same layers give the same bytes."""

import io
from typing import Any

import numpy as np
import pytest
from PIL import Image

from scenegen.classes import CLASSES, Semantic
from scenegen_datasets.pictures import colour
from scenegen_datasets.pictures.animation import animate
from scenegen_datasets.pictures.scales import Tone
from scenegen_datasets.pictures.sheet import contact_sheet
from scenegen_datasets.pictures.shot import Shot


def shot(rows: int = 48, columns: int = 64, **layers: Any) -> Shot:
    rng = np.random.default_rng(rows * columns)
    depth = np.geomspace(2.0, 300.0, rows * columns).reshape(rows, columns).astype(np.float32)
    depth[:4] = np.inf
    semantic = np.where(np.isinf(depth), 0, rng.integers(1, 20, (rows, columns))).astype(np.uint8)
    counts = rng.integers(4000, 6000, (rows, columns)).astype(np.uint16)
    found: dict[str, Any] = {
        "semantic": semantic,
        "instance": semantic.astype(np.uint32) * 7,
        "flow": rng.normal(0, 3, (rows, columns, 2)).astype(np.float32),
    }
    thermal_K = (233.0 + counts / 86.0).astype(np.float32)
    return Shot("city-00000-000-0001", "05:12", counts, thermal_K, depth, **(found | layers))


def test_depth_is_bright_near_dark_far_and_the_sky_apart() -> None:
    picture = colour.depth(np.array([[1.0, 10.0, 100.0, np.inf]], np.float32), 1.0, 100.0)
    brightness = picture.astype(int).sum(axis=2)[0]
    assert brightness[0] > brightness[1] > brightness[2]
    assert tuple(picture[0, 3]) == colour.SKY_COLOUR
    assert colour.SKY_COLOUR not in {tuple(row) for row in colour.colormap().tolist()}


@pytest.mark.parametrize(
    ("values", "ends"),
    [([3.1, 180.0], (2.0, 200.0)), ([np.inf, np.inf], (1.0, 100.0)), ([5.0, 5.0], (5.0, 10.0))],
)
def test_depth_ends_are_round(values: list[float], ends: tuple[float, float]) -> None:
    assert colour.depth_range([np.array([values], np.float32)]) == ends


def test_flow_follows_the_middlebury_wheel() -> None:
    uv = np.array([[[0, 0], [1, 0], [0, 1], [-1, 0], [0, -1]]], np.float32)
    still, right, down, left, up = colour.flow(uv, 1.0)[0].astype(int).tolist()
    assert still == [255, 255, 255]
    assert right[0] == 255  # red
    assert right[1] < 10
    assert down[0] > 200  # yellow
    assert down[1] > 200
    assert down[2] < 60
    assert left[1] > 200  # cyan
    assert left[2] > 200
    assert left[0] < 60
    assert up[2] > 200  # violet
    assert up[1] < 60


def test_classes_have_the_colours_of_the_class_list() -> None:
    ids = np.arange(len(CLASSES), dtype=np.uint8)[None]
    picture = colour.semantic(ids)[0]
    assert [tuple(c) for c in picture[1:].tolist()] == [row.colour for row in CLASSES[1:]]
    assert tuple(picture[Semantic.SKY]) == colour.SKY_COLOUR


def test_the_scale_bar_shows_the_greys_of_the_picture() -> None:
    one = shot()
    tone = Tone.of(one)
    picture = tone.picture(one.counts)[..., 0]
    order = np.argsort(one.counts.ravel(), kind="stable")
    assert (np.diff(picture.ravel()[order].astype(int)) >= 0).all()  # warmer is never darker
    ramp = tone.ramp(200)
    at = np.linspace(tone.low_count, tone.high_count, 200)
    inside = (one.counts >= tone.low_count) & (one.counts <= tone.high_count)
    expected = np.interp(one.counts[inside], at, ramp.astype(float))
    assert np.abs(expected - picture[inside]).max() < 4


def test_a_sheet_has_a_column_for_each_layer_there_is() -> None:
    whole = contact_sheet([shot(), shot()], "name", "words")
    bare = contact_sheet([shot(semantic=None, instance=None, flow=None)], "name", "words")
    assert whole.width == 2 * 20 + 5 * 256 + 4 * 8
    assert bare.width == 2 * 20 + 2 * 256 + 8


@pytest.mark.parametrize("size", [(16, 16), (512, 640), (20, 300)])
def test_any_picture_size_fits_a_tile(size: tuple[int, int]) -> None:
    assert contact_sheet([shot(*size)], "name", "words").width == 1352


def test_the_same_shots_give_the_same_bytes() -> None:
    def drawn() -> tuple[bytes, bytes]:
        file = io.BytesIO()
        contact_sheet([shot()], "name", "words").save(file, "PNG")
        return file.getvalue(), animate([shot(), shot(), shot()])

    assert drawn() == drawn()


def test_the_animation_has_every_frame_and_loops() -> None:
    shots = [shot(flow=np.full((48, 64, 2), k, np.float32)) for k in range(4)]
    film = Image.open(io.BytesIO(animate(shots)))
    assert (film.format, film.n_frames, film.info["loop"]) == ("WEBP", 4, 0)  # type: ignore[attr-defined]
