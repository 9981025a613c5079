"""Audit and report of a real dataset through the command itself."""

import base64
import io
import json
import re
import shutil
from html.parser import HTMLParser
from pathlib import Path

import pytest
from PIL import Image

from scenegen_cli.main import main
from scenegen_datasets.audits.run import QUESTIONS
from scenegen_datasets.audits.steps import draw_places
from scenegen_datasets.report.page import REPORT, compose, write_report
from scenegen_datasets.source import open_source


class Page(HTMLParser):
    """Checks that what is opened is closed; gathers ids, links and pictures."""

    def __init__(self) -> None:
        super().__init__()
        self.open: list[str] = []
        self.ids: set[str] = set()
        self.links: set[str] = set()
        self.pictures: list[str] = []
        self.unsaid = 0

    def handle_starttag(self, tag: str, attrs: list[tuple[str, str | None]]) -> None:
        given = dict(attrs)
        assert not given.get("id") or given["id"] not in self.ids
        self.ids.add(given.get("id") or "")
        seen = tag in ("img", "svg") and given.get("aria-hidden") != "true"
        self.unsaid += seen and not (given.get("alt") or given.get("aria-label"))
        self.links.add(given.get("href") or "")
        if tag == "img":
            self.pictures.append(given.get("src") or "")
        elif tag not in ("meta", "input", "source"):
            self.open.append(tag)

    def handle_endtag(self, tag: str) -> None:
        assert self.open.pop() == tag


@pytest.fixture(scope="module")
def page(finished_dataset: Path) -> str:
    return compose(finished_dataset)[0]


def test_the_page_stands_alone_and_holds_every_section(page: str) -> None:
    found = Page()
    found.feed(page)
    assert not found.open
    assert {*QUESTIONS, "moments", "flights", "provenance", "cost"} <= found.ids
    assert {f"#{name}" for name in (*QUESTIONS, "moments", "flights", "provenance", "cost")} <= found.links
    assert found.unsaid == 0  # every picture and chart says in words what it shows
    assert len(found.pictures) > 10 and all(
        src.startswith("data:image/webp;base64,") for src in found.pictures
    )
    assert not re.search(r"(?:src|href)=[\"'](?!data:|#)", page)  # nothing is fetched from anywhere
    assert not re.search(r"@import|url\((?!#)|srcset=[\"'](?!data:)", page)
    assert len(page) < 10_000_000


def test_flights_move_and_stand_still_for_those_who_ask(page: str) -> None:
    films = re.findall(
        r'srcset="data:image/webp;base64,([^"]+)"><img src="data:image/webp;base64,([^"]+)"', page
    )
    assert films and page.count("(prefers-reduced-motion:reduce)") == len(films)
    for still, moving in films:
        counts = []
        for data in (still, moving):
            with Image.open(io.BytesIO(base64.b64decode(data))) as image:
                counts.append(getattr(image, "n_frames", 1))
        assert counts == [1, 4]


def test_the_keys_the_documentation_names_are_there(
    finished_dataset: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    main(["audit", str(finished_dataset), "--json"])
    found = json.loads(capsys.readouterr().out)
    assert set(found) == {"ok", "steps", "clips", *QUESTIONS}
    assert all(set(found[name]["verdict"]) == {"level", "headline", "words"} for name in QUESTIONS)
    text = (Path(__file__).parents[2] / "docs" / "report.md").read_text("utf-8")
    table = text.partition("## Good and bad values")[2].partition("## For machines")[0]
    paths = [line.split("|")[1] for line in table.splitlines() if line.startswith("| `")]
    named = [
        path
        for cell in paths
        for path in re.findall(r"`((?:draws|contents|leak|labels|edges|flow)\.[^`]+)`", cell)
    ]
    assert len(named) >= 10
    for path in named:
        here = found
        for part in path.split("."):
            here = here[part.removesuffix("[]")]
            here = here[0] if part.endswith("[]") else here
            if here is None:
                break  # too little here to judge, but the key is there


def test_the_same_dataset_gives_the_same_bytes(page: str, finished_dataset: Path) -> None:
    assert compose(finished_dataset)[0] == page


def test_a_dataset_of_ours_is_sound(finished_dataset: Path, capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["audit", str(finished_dataset), "--json"]) == 0
    found = json.loads(capsys.readouterr().out)
    assert found["ok"] and found["draws"]["verdict"]["level"] != "fault"
    assert found["labels"]["flow_px"]["top"] < 1e-3
    assert found["labels"]["depth_share"]["median"] < 1e-3
    assert found["draws"]["clips"] == 4


def test_the_command_writes_where_it_is_told(
    finished_dataset: Path, tmp_path: Path, page: str, capsys: pytest.CaptureFixture[str]
) -> None:
    out = tmp_path / "new" / "page.html"
    assert main(["report", str(finished_dataset), "--out", str(out)]) == 0
    assert out.read_text("utf-8") == page
    assert str(out) in capsys.readouterr().out


def test_a_report_inside_leaves_the_dataset_sound(finished_dataset: Path, tmp_path: Path) -> None:
    copy = Path(shutil.copytree(finished_dataset, tmp_path / "copy"))
    report = write_report(copy)
    assert report.path == copy / REPORT and report.path.stat().st_size == report.bytes
    assert main(["verify", str(copy), "--jobs", "1"]) == 0


def test_a_growing_dataset_without_a_log_has_a_report_too(finished_dataset: Path, tmp_path: Path) -> None:
    copy = Path(shutil.copytree(finished_dataset, tmp_path / "copy"))
    for name in ("dataset.json", "MANIFEST.sha256", "run.log.jsonl"):
        (copy / name).unlink()
    (copy / "receipts").rename(copy / "kept")
    (copy / "receipts").mkdir()
    assert main(["report", str(copy)]) == 2  # nothing in it yet
    (copy / "receipts").rmdir()
    (copy / "kept").rename(copy / "receipts")
    text, _ = compose(copy)
    assert "It is not complete." in text and "what it cost is not known" in text


def test_what_cannot_be_done_is_said_in_one_line(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["report", str(tmp_path / "none")]) == 2
    assert capsys.readouterr().err.count("\n") == 1
    assert main(["audit", str(tmp_path / "none")]) == 2


def test_the_sample_is_seeded_and_bounded(finished_dataset: Path) -> None:
    source = open_source(finished_dataset, allow_partial=False)
    places = draw_places(source, 6)
    assert len(places) == 6 and places == draw_places(source, 6)
    assert {place.clip for place in places} == {0, 1, 2, 3}
    every = draw_places(source)  # four clips of five frames hold sixteen steps
    assert len(every) == len(set(every)) == 16
