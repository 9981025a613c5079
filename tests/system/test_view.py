"""The viewer, as a browser meets it."""

import re
import socket
import urllib.error
import urllib.request
from collections.abc import Iterator
from pathlib import Path

import cv2
import numpy as np
import pytest
from viewing import served

from scenegen_datasets.loader import PairDataset
from scenegen_datasets.view.gallery import Gallery, Tone


@pytest.fixture(scope="module")
def address(finished_dataset: Path) -> Iterator[str]:
    """The page of a small dataset, served by the command itself."""
    with served(finished_dataset) as where:
        yield where


def test_it_listens_on_the_loopback_address_and_answers_to_no_other_name(address: str) -> None:
    assert re.fullmatch(r"http://127\.0\.0\.1:\d+/", address)
    asked = urllib.request.Request(address, headers={"Host": "evil.example"})
    with pytest.raises(urllib.error.HTTPError, match="400"):
        urllib.request.urlopen(asked, timeout=300)


def test_a_picture_is_that_of_the_frame(address: str, finished_dataset: Path) -> None:
    with urllib.request.urlopen(
        address + Gallery.address(1, 2, "semantic", Tone())[1:], timeout=300
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
        urllib.request.urlopen(address + where[1:], timeout=300)


def test_no_dataset_is_one_line(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    from scenegen_cli.main import main

    assert main(["view", str(tmp_path / "nothing"), "--no-open"]) == 2
    assert "no dataset at" in capsys.readouterr().err


def test_a_port_that_is_taken_is_one_line(finished_dataset: Path, capsys: pytest.CaptureFixture[str]) -> None:
    from scenegen_cli.main import main

    with socket.socket() as taken:
        taken.bind(("127.0.0.1", 0))
        taken.listen()
        port = taken.getsockname()[1]
        assert main(["view", str(finished_dataset), "--no-open", "--port", str(port)]) == 2
    said = capsys.readouterr().err
    assert said.count("\n") == 1 and f"port {port}" in said and "--port" in said
