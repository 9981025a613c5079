"""The viewer as somebody uses it: every control, keys, numbers at the rim, a narrow screen, a damaged clip."""

import re
import shutil
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from viewing import CHROMIUM, PATIENCE_MS, await_pictures, looked_at, served

from scenegen_datasets.index import job_of
from scenegen_datasets.source import open_source
from scenegen_datasets.view.library import Library

pytestmark = pytest.mark.skipif(CHROMIUM is None, reason="needs a Chromium: apt-get install chromium")

DAMAGED = 2


@pytest.fixture(scope="module")
def dataset(finished_dataset: Path, tmp_path_factory: pytest.TempPathFactory) -> Path:
    """Four clips, one of them with a byte turned over in the picture of its second frame."""
    copy = Path(shutil.copytree(finished_dataset, tmp_path_factory.mktemp("viewed") / "tiny"))
    source = open_source(copy, allow_partial=False)
    row = source.rows[source.starts[DAMAGED] + 1]
    shard = copy / job_of(row).shard
    data = bytearray(shard.read_bytes())
    data[int(row["thermal_offset"]) + int(row["thermal_size"]) // 2] ^= 1
    shard.write_bytes(data)
    return copy


@pytest.fixture(scope="module")
def page(dataset: Path) -> Iterator[Any]:
    with served(dataset) as address, looked_at(address) as page:
        yield page


def at(page: Any, words: str) -> None:
    """Wait until frame and clip length read so."""
    page.get_by_text(re.compile(rf"^{words} ")).wait_for()


def choose(page: Any, label: str, option: str) -> None:
    pick(page, page.get_by_label(label, exact=True), option)


def pick(page: Any, selector: Any, option: str) -> None:
    """Choose from a list, and wait until it has folded: for a moment after, two lists are in the page."""
    selector.click()
    page.get_by_role("option", name=option).first.click()
    page.wait_for_function("!document.querySelector('.q-menu')")


def move_to(page: Any, column: int, row: int, size: int = 64) -> dict[str, str]:
    """Put the cursor on a pixel of the first picture; what is then read."""
    box = page.locator(".picture img").first.bounding_box()
    x, y = box["x"] + box["width"] * (column + 0.5) / size, box["y"] + box["height"] * (row + 0.5) / size
    page.mouse.move(x + (2 if column < size / 2 else -2), y)
    page.mouse.move(x, y)
    page.get_by_text(f"({column}, {row})", exact=True).wait_for()
    words = page.locator(".numbers").inner_text().split("\n")
    return dict(zip(words[::2], words[1::2], strict=True))


@pytest.mark.parametrize("place", [(0, 0), (63, 0), (0, 63), (63, 63), (40, 50)])
def test_numbers_under_the_cursor_are_the_datasets(page: Any, dataset: Path, place: tuple[int, int]) -> None:
    still = Library(dataset).still(0, 1)
    column, row = place
    read, layers, pixel = move_to(page, column, row), still.layers, (row, column)
    assert read["thermal"] == f"{int(still.counts[pixel])} counts"
    assert read["brightness"] == f"{float(still.brightness_K[pixel]):.2f} K"
    assert read["measured"] == f"{float(still.measured[pixel]):.3f} W m⁻² sr⁻¹"
    assert read["noise-free"] == f"{float(layers['radiance'][pixel]):.3f} W m⁻² sr⁻¹"
    depth = float(layers["depth"][pixel])
    assert read["depth"] == (f"{depth:.3f} m" if np.isfinite(depth) else "sky")


def test_keys_and_slider_go_one_frame_at_a_time(page: Any) -> None:
    page.keyboard.press("ArrowRight")
    at(page, "2 / 4")
    page.keyboard.press("ArrowLeft")
    at(page, "1 / 4")
    page.keyboard.press("ArrowLeft")
    at(page, "0 / 4")
    slider = page.locator(".q-slider").bounding_box()
    page.mouse.click(slider["x"] + slider["width"] / 2, slider["y"] + slider["height"] / 2)
    at(page, "2 / 4")
    page.keyboard.press("ArrowRight")  # the slider has the focus and moves by itself
    at(page, "3 / 4")
    page.evaluate("new Promise((then) => setTimeout(then, 300))")  # by its own clock the slider tells twice
    page.keyboard.press("n")
    page.get_by_label("clip", exact=True).and_(page.locator("input[value*='clip 1']")).wait_for()
    at(page, "1 / 4")
    page.keyboard.press("p")
    page.get_by_label("clip", exact=True).and_(page.locator("input[value*='clip 0']")).wait_for()


def test_space_plays_and_stops(page: Any) -> None:
    page.locator("body").click(position={"x": 4, "y": 4})
    page.keyboard.press("Space")
    page.get_by_text("pause", exact=True).wait_for()
    at(page, "3 / 4")
    page.keyboard.press("Space")
    page.get_by_text("play_arrow", exact=True).wait_for()
    assert page.evaluate("scrollY") == 0


def test_gain_palette_and_layer_change_the_picture_and_its_words(page: Any) -> None:
    caption = page.locator(".caption").first
    choose(page, "thermal gain", "linear, one range for the whole clip")
    caption.get_by_text("one range for the whole clip").wait_for()
    choose(page, "palette", "inferno")
    page.wait_for_function("document.querySelector('.picture img').src.includes('palette=inferno')")
    assert "gain=clip" in page.locator(".picture img").first.get_attribute("src")
    choose(page, "colour of the points", "semantic")
    pick(page, page.locator(".pictures .q-select").first, "temperature")
    caption.get_by_text("kinetic").wait_for()
    page.locator(".picture[role=img][aria-label^='temperature of frame']").wait_for()


def test_a_damaged_clip_is_named_and_the_next_is_shown(page: Any) -> None:
    choose(page, "clip", f"clip {DAMAGED}")
    fault = page.locator(".fault")
    fault.wait_for()
    assert "00000" in fault.inner_text() and page.locator(".numbers").inner_text() == ""
    page.keyboard.press("Escape")
    choose(page, "clip", "clip 3")
    fault.wait_for(state="hidden")
    await_pictures(page)


def test_a_narrow_screen_shows_everything(page: Any) -> None:
    phone = page.context.browser.new_page(viewport={"width": 390, "height": 844})
    phone.set_default_timeout(PATIENCE_MS)
    phone.goto(page.url)
    await_pictures(phone)
    assert phone.evaluate("document.documentElement.scrollWidth") <= 390
    boxes = [picture.bounding_box() for picture in phone.locator(".picture img").all()]
    assert len(boxes) == 4 and all(box["width"] > 150 for box in boxes)
    drawn = phone.locator(".space canvas").first
    drawn.wait_for()
    space = drawn.bounding_box()
    assert space["width"] > 300 and space["y"] > boxes[-1]["y"]
    phone.close()
