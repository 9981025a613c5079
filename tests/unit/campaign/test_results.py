"""From batches to figures, tables and the page."""

import csv
import io
import re
from html.parser import HTMLParser
from pathlib import Path
from xml.etree import ElementTree

import numpy as np
import pyarrow.parquet
import pytest

import flown
from scenegen.foundation import canonical
from scenegen_trainers.campaign.report.charts import Mark, sweep_chart
from scenegen_trainers.campaign.report.page import page, write_page
from scenegen_trainers.campaign.report.plan_svg import plan_svg
from scenegen_trainers.campaign.report.plan_view import SIDE_PX, Frame, relief
from scenegen_trainers.campaign.results import flight_rows, gather, labels, write
from scenegen_trainers.campaign.statistics import wilson
from scenegen_trainers.campaign.store import CampaignStore
from scenegen_trainers.campaign.sweep import parse_sweep
from scenegen_trainers.pilots.spec import PilotSpec

CRASHES = {"oracle": (3,), "blind": (1, 2, 3, 7, 8)}


@pytest.fixture
def filled(tmp_path: Path) -> Path:
    flown.fill(flown.campaign(tmp_path / "c"), CRASHES)
    return tmp_path / "c"


def test_figures_are_those_of_the_flights(filled: Path) -> None:
    results = gather(flown.campaign(filled))
    oracle, blind = results.lines
    assert (oracle.pilot, oracle.flights, oracle.batches) == ("oracle", 10, 3)
    assert oracle.collision == wilson(1, 10)
    assert blind.collision == wilson(5, 10)
    assert blind.ends["goal"].count == 5
    assert blind.hit == {"tree": 5}
    assert (oracle.obstructed, oracle.decisions) == (5, 600)
    assert blind.progress.mean == pytest.approx(0.7)
    assert oracle.closest_m.median == 1.25
    (duel,) = results.duels
    paired = duel.paired
    assert (paired.both, paired.first_only, paired.second_only, paired.neither) == (1, 0, 4, 5)
    assert paired.p == pytest.approx(0.125)


def network(path: str, planner: str = "waypoint", sha256: str = "a") -> PilotSpec:
    return PilotSpec("file", path, planner, sha256)


def test_pilots_are_called_as_briefly_as_tells_them_apart(tmp_path: Path) -> None:
    for words, expected in (
        ((network("/a/x.pt"), network("/a/y.pt")), ("x", "y")),
        ((network("/a/x.pt"), network("/a/x.pt", "straight")), ("x (waypoint)", "x (straight)")),
        ((network("/a/model.pt"), network("/b/model.pt")), ("a/model (waypoint)", "b/model (waypoint)")),
        ((network("/a/c/m.pt"), network("/b/c/m.pt")), ("1: m (waypoint)", "2: m (waypoint)")),
    ):
        assert labels(flown.campaign(tmp_path, pilots=words)) == expected


def test_the_first_two_of_several_pilots_are_compared(tmp_path: Path) -> None:
    pilots = (flown.ORACLE, flown.BLIND, network("/a/m.pt"))
    asked = flown.campaign(tmp_path / "c", pilots=pilots)
    flown.fill(asked, {**CRASHES, "m": (0,)})
    results = gather(asked)
    assert [line.collision.count for line in results.lines] == [1, 5, 1]
    (duel,) = results.duels
    assert (duel.first, duel.second) == ("oracle", "blind")
    assert page(asked, results).count("<td>m</td>") >= 1


def test_fewer_flights_are_a_campaign_of_their_own(filled: Path) -> None:
    oracle, blind = gather(flown.campaign(filled, flights=3)).lines
    assert (oracle.flights, oracle.collision.count, blind.collision.count) == (3, 0, 2)


def test_a_missing_batch_is_missing_not_imagined(filled: Path) -> None:
    next(filled.rglob("blind*/00001.json")).unlink()
    results = gather(flown.campaign(filled))
    assert [line.flights for line in results.lines] == [10, 6]
    paired = results.duels[0].paired
    assert (paired.both, paired.second_only, paired.neither) == (1, 3, 2)  # six missions flown by both


def test_tables_hold_one_row_per_flight(filled: Path) -> None:
    campaign = flown.campaign(filled)
    results = gather(campaign)
    files = write(campaign, results)
    assert [file.name for file in files] == ["results.json", "flights.csv", "flights.parquet"]
    rows = list(csv.DictReader(io.StringIO((filled / "flights.csv").read_text())))
    assert len(rows) == 20
    assert {row["flight"] for row in rows if row["pilot"] == "blind" and row["outcome"] == "collision"} == {
        str(k) for k in CRASHES["blind"]
    }
    table = pyarrow.parquet.read_table(filled / "flights.parquet").to_pylist()
    assert table == list(flight_rows(results))
    plain = canonical.read(filled / "results.json")
    assert plain["lines"][1]["ends"]["collision"]["count"] == 5
    assert plain["comparisons"][0]["paired"]["second_only"] == 4
    assert write(campaign, gather(campaign)) == files  # and the same bytes


class _Tags(HTMLParser):
    """Checks that what is opened is closed."""

    def __init__(self) -> None:
        super().__init__()
        self.open: list[str] = []
        self.words = ""

    def handle_starttag(self, tag: str, attrs: object) -> None:
        if tag not in ("meta", "br", "input"):
            self.open.append(tag)

    def handle_endtag(self, tag: str) -> None:
        assert self.open.pop() == tag

    def handle_data(self, data: str) -> None:
        self.words += data


def test_the_page_stands_alone_and_says_what_came_of_it(filled: Path) -> None:
    campaign = flown.campaign(filled)
    store = CampaignStore(filled)
    store.commit_plan("city", 2, b"RIFF", {"centre_m": (0.0, 0.0), "height_m": 9e3, "focal_px": 1.6e4})
    html = write_page(campaign, gather(campaign)).read_text("utf-8")
    tags = _Tags()
    tags.feed(html)
    assert not tags.open
    assert "50.0 %" in tags.words
    assert "5 collided" in tags.words
    assert html.count('<svg viewBox="0 0 900 900"') == 2
    assert re.findall(r"<h3>(city 2 · \w+)", html) == ["city 2 · oracle", "city 2 · blind"]
    assert html.count("data:image/webp;base64,UklGRg==") == 1
    assert not re.search(r"(?:src|href)=[\"'](?!data:|#)", html)  # nothing is fetched from anywhere


def test_what_a_pilot_says_cannot_break_the_page(tmp_path: Path) -> None:
    campaign = flown.campaign(tmp_path / "c", flights=1, pilots=(flown.ORACLE,))
    store = flown.fill(campaign, {})
    (batch,) = campaign.plans["city"]
    evil = flown.flight(0, "pilot", reason="<script>alert('x')</script>")
    kept = flown.record(batch)
    store.commit("base", flown.ORACLE.slug, batch, type(kept)(kept.world, 1.0, {}, {}, (evil,)))
    assert "<script>alert" not in page(campaign, gather(campaign))


def test_a_sweep_is_drawn_with_its_intervals(tmp_path: Path) -> None:
    sweep = parse_sweep(["speed=12,3,6", "weather=fog,clear"])
    campaign = flown.campaign(tmp_path / "c", sweep=sweep)
    flown.fill(campaign, CRASHES)
    html = page(campaign, gather(campaign))
    charts = re.findall(r'<svg viewBox="0 0 560 300".*?</svg>', html)
    assert len(charts) == 2
    speed = ElementTree.fromstring(charts[0])
    assert [e.text for e in speed.iter("text") if e.get("class") == "x"] == ["3", "6", "12"]
    assert len([e for e in speed.iter("path") if e.get("class") == "band"]) == 2


def test_a_chart_puts_rates_where_they_belong() -> None:
    rates = [wilson(0, 50), wilson(25, 50), wilson(50, 50)]
    svg = sweep_chart("x", [Mark("0", 0.0), Mark("1", 1.0), Mark("4", 4.0)], {"a": rates})
    dots = [
        (float(e.get("cx", 0)), float(e.get("cy", 0))) for e in ElementTree.fromstring(svg).iter("circle")
    ]
    (x0, y0), (x1, y1), (x2, y2) = dots
    assert (x1 - x0) * 3 == pytest.approx(x2 - x1, rel=0.01)
    assert y0 - y1 == pytest.approx(y1 - y2, abs=0.1)


def test_places_fall_on_the_map_where_they_are() -> None:
    frame = Frame((100.0, -50.0), 8000.0, 16000.0)
    pixels = frame.to_pixels(np.array([[100.0, -50.0, 3.0], [110.0, -50.0, 0.0], [100.0, -40.0, 0.0]]))
    assert pixels[0] == pytest.approx((SIDE_PX / 2, SIDE_PX / 2))
    assert pixels[1] == pytest.approx((SIDE_PX / 2 + 20.0, SIDE_PX / 2))
    assert pixels[2] == pytest.approx((SIDE_PX / 2, SIDE_PX / 2 - 20.0))  # north is up
    assert frame.metres_per_px() == 0.5


def test_a_plan_marks_crashes_and_nothing_else_with_crosses() -> None:
    flights = [flown.flight(0), flown.flight(1, "collision", "wire"), flown.flight(2, "timeout")]
    svg = plan_svg("m", Frame((0.0, 0.0), 8000.0, 16000.0), flights)
    tree = ElementTree.fromstring(svg)
    assert len([e for e in tree.iter("path") if e.get("class") == "cross"]) == 1
    titles = [e.text or "" for e in tree.iter("title")]
    assert any("flight 1: collided with wire after 12.5 s" in title for title in titles)


def test_a_relief_is_bright_towards_the_light_and_dark_in_the_shadow() -> None:
    height = np.zeros((80, 80), np.float32)
    height[30:50, 30:50] = 20.0
    picture = relief(height, np.full((80, 80), 5, np.uint8), 1.0).astype(float).mean(axis=2)
    assert picture[54, 54] < 0.8 * picture[24, 24]  # south-east of the block lies its shadow
