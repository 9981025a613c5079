"""The viewer, as a browser meets it."""

import os
import re
import shutil
import signal
import subprocess
import sys
import urllib.error
import urllib.request
from collections.abc import Iterator
from pathlib import Path

import cv2
import numpy as np
import pytest

from scenegen_datasets.loader import PairDataset
from scenegen_datasets.view.gallery import Gallery, Tone

CHROMIUM = shutil.which("chromium") or shutil.which("chromium-browser") or shutil.which("google-chrome")
QUIET = (
    *("--no-sandbox", "--disable-gpu", "--disable-quic", "--no-first-run", "--disable-background-networking"),
    *("--disable-component-update", "--disable-sync", "--enable-unsafe-swiftshader"),
)


@pytest.fixture(scope="module")
def address(finished_dataset: Path) -> Iterator[str]:
    """The page of a small dataset, served by the command itself."""
    command = [sys.executable, "-m", "scenegen_cli.main", "view", str(finished_dataset), "--no-open"]
    # A user's shell does not say that this is a test; told so, the library would not serve.
    shell = {name: value for name, value in os.environ.items() if name != "PYTEST_CURRENT_TEST"}
    with subprocess.Popen(command, stdout=subprocess.PIPE, text=True, env=shell) as server:
        assert server.stdout is not None
        where = server.stdout.readline().strip()
        _await(server, where)
        yield where
        server.send_signal(signal.SIGINT)
        assert server.wait(60) in (0, 130)


def _await(server: subprocess.Popen[str], where: str) -> None:
    """Until the page answers; a request that is refused is repeated."""
    while server.poll() is None:
        try:
            with urllib.request.urlopen(where, timeout=60):
                return
        except urllib.error.URLError:
            subprocess.run(["sleep", "0.1"], check=True)
    raise AssertionError(f"{where} does not answer: the command has ended")


def test_it_listens_on_the_loopback_address_and_answers_to_no_other_name(address: str) -> None:
    assert re.fullmatch(r"http://127\.0\.0\.1:\d+/", address)
    asked = urllib.request.Request(address, headers={"Host": "evil.example"})
    with pytest.raises(urllib.error.HTTPError, match="400"):
        urllib.request.urlopen(asked, timeout=60)


def test_a_picture_is_that_of_the_frame(address: str, finished_dataset: Path) -> None:
    with urllib.request.urlopen(
        address + Gallery.address(1, 2, "semantic", Tone())[1:], timeout=60
    ) as answer:
        data = np.frombuffer(answer.read(), np.uint8)
    picture = cv2.imdecode(data, cv2.IMREAD_COLOR)
    pair = PairDataset(finished_dataset, layers=("semantic",))[4 + 1]  # clip 1 of four pairs, frame 2
    classes = pair["semantic"]
    assert picture is not None and picture.shape[:2] == classes.shape
    for number in np.unique(classes):
        assert len(np.unique(picture[classes == number], axis=0)) == 1  # one colour a class


@pytest.mark.parametrize("wrong", ["clip=99", "frame=-1", "layer=secrets", "gain=loud"])
def test_a_picture_that_does_not_exist_is_refused(address: str, wrong: str) -> None:
    name = wrong.partition("=")[0]
    where = re.sub(rf"{name}=[^&]*", wrong, Gallery.address(0, 1, "depth", Tone()))
    with pytest.raises(urllib.error.HTTPError, match="404"):
        urllib.request.urlopen(address + where[1:], timeout=60)


@pytest.mark.skipif(CHROMIUM is None, reason="needs a Chromium: apt-get install chromium")
def test_numbers_under_the_cursor_are_the_datasets(address: str, finished_dataset: Path) -> None:
    from playwright.sync_api import sync_playwright

    pair = PairDataset(finished_dataset, layers=("thermal", "depth"))[0]
    with sync_playwright() as playwright:
        browser = playwright.chromium.launch(executable_path=CHROMIUM, args=list(QUIET))
        page = browser.new_page(viewport={"width": 1400, "height": 1200})
        page.goto(address)
        page.get_by_text("counts").or_(page.get_by_text("Move over a picture")).wait_for()
        picture = page.locator(".picture img").first
        picture.wait_for()
        page.wait_for_function("document.querySelector('.picture img').naturalWidth > 0")
        box = picture.bounding_box()
        assert box is not None
        page.mouse.move(box["x"] + 5, box["y"] + 5)
        page.mouse.move(box["x"] + box["width"] * (40.5 / 64), box["y"] + box["height"] * (50.5 / 64))
        page.get_by_text("(40, 50)").wait_for()
        shown = page.inner_text("body")
        assert f"{int(pair['thermal'][50, 40])} counts" in shown
        assert f"{float(pair['depth'][50, 40]):.3f} m" in shown or not np.isfinite(pair["depth"][50, 40])
        page.keyboard.press("ArrowRight")
        page.get_by_text(re.compile(r"^2 / 4")).wait_for()
        browser.close()


def test_no_dataset_is_one_line(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    from scenegen_cli.main import main

    assert main(["view", str(tmp_path / "nothing"), "--no-open"]) == 2
    assert "no dataset at" in capsys.readouterr().err
