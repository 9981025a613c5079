"""Table 2: the paper's own arithmetic, figures by hand, mistakes in one line, and the whole table from a dataset."""

from __future__ import annotations

import json
from pathlib import Path
from typing import Any

import pytest
import torch

import flown
from scenegen_cli.main import main
from scenegen_trainers.campaign.results import gather
from scenegen_trainers.models.checkpoint import write_checkpoint
from scenegen_trainers.models.network import DepthNetwork
from scenegen_trainers.tables.entrants import Entrant, entrant, others
from scenegen_trainers.tables.table2 import Table2, Table2Job, tabled
from scenegen_trainers.tables.table2_page import as_html, as_json
from scenegen_trainers.tables.table2_paper import METHODS, PRINTED_AVERAGE, PUBLISHED, published_mean
from scenegen_trainers.tables.table2_recipe import flight_recipe
from scenegen_trainers.tables.table2_text import as_markdown

CAMERA = {"width_px": 32, "height_px": 32, "hfov_deg": 90.0}
UNET = {"width": 2, "downs": 3}
LITE = {"architecture": "litemono", "knobs": {"width": 0.25}}


def test_the_papers_average_leaves_city_out() -> None:
    for method, corrected in (("conventional", 28.895), ("proposed", 22.3275)):
        rest = [name for name in PUBLISHED if name != "city"]
        assert published_mean(method, rest) == pytest.approx(PRINTED_AVERAGE[method], abs=0.005)
        assert published_mean(method, PUBLISHED) == pytest.approx(corrected, abs=1e-9)
    assert published_mean("proposed", ["city", "quarry"]) is None


def test_the_papers_rates_are_those_of_their_counts() -> None:
    for row in PUBLISHED.values():
        for method in METHODS:
            assert round(100 * row.rate(method).share, 2) == row.percent[method]
    city = PUBLISHED["city"]
    exact = [
        n
        for n in range(1, 401)
        if all(any(round(100 * k / n, 2) == city.percent[m] for k in range(n + 1)) for m in METHODS)
    ]
    assert exact == [83, 166, 249, 332]


def checkpoint(path: Path, model: str, **changes: Any) -> Path:
    """An untrained network as `scenegen train` would leave it."""
    flow, w_l1 = {"pix2pix": ("none", 100.0), "pix2pix-flow": ("farneback", 300.0)}[model]
    config: dict[str, Any] = {
        "architecture": changes.get("architecture", "pix2pix"),
        "knobs": changes.get("knobs", UNET),
        "inputs": {"flow": changes.get("flow", flow)},
        "target": {},
    }
    torch.manual_seed(len(model))
    network = DepthNetwork(**config).model
    recipe = {"pix2pix": {"w_l1": w_l1}, "training": {"steps": 5}, "inputs": config["inputs"]}
    record = {"model": model, "recipe": recipe, "dataset": {"name": "toy", "content_id": "abc"}}
    path.parent.mkdir(parents=True, exist_ok=True)
    write_checkpoint(path, network, config, changes.get("camera", CAMERA), record)
    return path


def entrants(root: Path) -> tuple[Entrant, Entrant]:
    conventional = entrant("conventional", checkpoint(root / "a" / "model.pt", "pix2pix"))
    return conventional, entrant("proposed", checkpoint(root / "b" / "model.pt", "pix2pix-flow"))


def made_up(root: Path, crashes: dict[str, dict[str, tuple[int, ...]]], also: tuple[str, ...] = ()) -> Table2:
    """A table of flights nobody flew: per map and pilot, which of ten crash."""
    recipe = flight_recipe(
        [flown.Source("", {"map": list(crashes), "campaign": {"flights_per_batch": 4}})], CAMERA, None
    )
    dataset = {"name": "toy", "version": "1.0.0"}
    job = Table2Job(
        root / "t", recipe, *entrants(root), 10, "waypoint", 1, "ci", dataset, others=others(also)
    )
    campaign = job.campaign
    campaign.root.mkdir(parents=True)
    store = flown.CampaignStore(campaign.root)
    store.open(campaign.recipe)
    for point, pilot, batch in campaign.everything():
        hit = crashes[batch.map].get(campaign.names[pilot], ())
        store.commit(point, campaign.pilots[pilot].slug, batch, flown.record(batch, hit))
    return tabled(job, gather(campaign), {})


EVERY = tuple(range(10))


@pytest.fixture
def table(tmp_path: Path) -> Table2:
    return made_up(
        tmp_path,
        {
            "city": {"conventional": EVERY[:8], "proposed": EVERY[7:], "blind": EVERY},
            "coastline": {"conventional": EVERY[:6], "proposed": (), "blind": EVERY[:5]},
            "field": {"conventional": (1,), "proposed": (1, 2), "oracle": (9,)},
        },
    )


def test_figures_by_hand(table: Table2) -> None:
    """City 8 and 3 of 10, coast 6 and 0, field 1 and 2: means 0.5 and 1/6, without City 0.35 and 0.1."""
    plain = as_json(table)
    assert [plain["maps"][m]["collisions"]["conventional"]["count"] for m in table.maps] == [8, 6, 1]
    assert plain["all_maps"]["mean"] == pytest.approx(
        {"conventional": 0.5, "proposed": 1 / 6, "oracle": 1 / 30, "blind": 0.5}
    )
    assert plain["without_city"]["mean"]["conventional"] == pytest.approx(0.35)
    assert plain["without_city"]["maps"] == ["coastline", "field"]
    city = plain["maps"]["city"]["mcnemar"]
    assert (city["both"], city["first_only"], city["second_only"], city["neither"]) == (1, 7, 2, 0)
    assert city["p"] == pytest.approx(2 * (1 + 9 + 36) / 2**9)
    assert plain["maps"]["coastline"]["mcnemar"]["p"] == pytest.approx(2 / 2**6)
    assert [plain["maps"][m]["proposed_is"] for m in table.maps] == ["open", "lower", "open"]
    whole = plain["all_maps"]["mcnemar"]
    assert (whole["first_only"], whole["second_only"]) == (13, 3)
    assert whole["p"] == pytest.approx(2 * (1 + 16 + 120 + 560) / 2**16)
    assert plain["all_maps"]["paper_mean_percent"]["conventional"] == pytest.approx((57.83 + 51.25 + 5.5) / 3)


def test_pages_say_the_same(table: Table2) -> None:
    markdown, page = as_markdown(table), as_html(table)
    assert (
        "| coastline | 60.0 % (6/10; 31.3-83.2) | 0.0 % (0/10; 0.0-27.8) | -60.0 (lower) | 0.031 (6 : 0) |"
        in markdown
    )
    assert "| mean of all 3 | 50.0 % (15/30;" in markdown
    assert "| without city | 35.0 % (7/20;" in markdown
    assert "28.90 and 22.33" in markdown and "w_L1 = 300" in markdown
    assert page.count("<svg") == 4 * 3 + 4 * 5  # how flights ended, and rates of three maps and two means
    assert "paper 57.83 %" in page and 'href="flights/index.html"' in page
    assert not any("another dataset" in said for said in as_json(table)["warnings"])


def test_other_networks_are_held_against_both_methods(tmp_path: Path) -> None:
    """Coast: 6 and 0 of 10 against 2; city: 8 and 3 against 1, which the proposed one hit as well."""
    lite = checkpoint(tmp_path / "lite.pt", "pix2pix", **LITE)
    table = made_up(
        tmp_path,
        {
            "city": {"conventional": EVERY[:8], "proposed": EVERY[7:], "lite": (9,)},
            "coastline": {"conventional": EVERY[:6], "lite": (5, 6)},
        },
        (f"lite={lite}",),
    )
    plain = as_json(table)
    assert [network["method"] for network in plain["networks"]] == ["conventional", "proposed", "lite"]
    city, coast, whole = plain["others"]["lite"]  # of two maps one is left without City, which is no mean
    assert [row["collisions"]["count"] for row in (city, coast, whole)] == [1, 2, 3]
    assert whole["mean"] == pytest.approx(0.15)
    counts = ("both", "first_only", "second_only", "neither")
    against = whole["against"]
    assert [against["conventional"]["mcnemar"][key] for key in counts] == [1, 13, 2, 4]
    assert [against["proposed"]["mcnemar"][key] for key in counts] == [1, 2, 2, 15]
    assert against["conventional"]["mcnemar"]["p"] == pytest.approx(2 * (1 + 15 + 105) / 2**15)
    assert (against["conventional"]["other_is"], against["proposed"]["other_is"]) == ("lower", "open")

    markdown, page = as_markdown(table), as_html(table)
    assert "lite: litemono, 5 steps." in markdown
    row = "| mean of all 2 | lite | 15.0 % (3/20; 5.2-36.0) | -55.0 (lower), 0.0074 (13 : 2) | +0.0 (open), 1 (2 : 2) |"
    assert row in markdown
    assert "-55.0 (lower)" in page and "p 0.0074 (13 : 2)" in page
    assert "on the same missions</h2>" in page
    assert any(line.pilot == "lite" for line in table.lines.values())


def test_a_table_of_two_methods_says_nothing_of_others(table: Table2) -> None:
    assert as_json(table)["others"] == {}
    assert "Other networks" not in as_markdown(table) + as_html(table)


def test_names_of_other_networks(tmp_path: Path) -> None:
    lite = checkpoint(tmp_path / "rate=3" / "lite.pt", "pix2pix", **LITE)
    (unnamed,) = others([str(lite)])
    assert (unnamed.name, unnamed.path, unnamed.flow) == ("litemono", lite, "none")
    assert [other.name for other in others([f"a={lite}", str(lite)])] == ["a", "litemono"]


def test_a_network_that_may_have_seen_the_worlds_is_said_so(tmp_path: Path) -> None:
    table = made_up(tmp_path, {"field": {}})
    object.__setattr__(table.job, "dataset", {"name": "x", "version": "1.0.0", "content_id": "another"})
    assert "may have seen them" in as_markdown(table)
    assert "mean of all" not in as_markdown(table)


def test_mistakes_are_one_line(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    good = checkpoint(tmp_path / "a.pt", "pix2pix"), checkpoint(tmp_path / "b.pt", "pix2pix-flow")
    both = ["--conventional", str(good[0]), "--proposed", str(good[1])]
    wide = checkpoint(tmp_path / "wide.pt", "pix2pix-flow", camera={**CAMERA, "width_px": 48})
    lite = checkpoint(tmp_path / "lite.pt", "pix2pix", **LITE)
    wide_lite = checkpoint(tmp_path / "wide_lite.pt", "pix2pix", **LITE, camera={**CAMERA, "width_px": 48})
    true = checkpoint(tmp_path / "true.pt", "pix2pix-flow", flow="truth")
    text = tmp_path / "text.pt"
    text.write_text("no network")
    for arguments, said in (
        ([], "--data to train them on"),
        (both[:2], "--proposed is missing"),
        (
            ["--conventional", str(good[1]), *both[2:]],
            "holds pix2pix with farneback flow; the conventional method",
        ),
        ([*both[:2], "--proposed", str(good[0])], "holds pix2pix with no flow; the proposed method"),
        (["--conventional", str(lite), *both[2:]], "holds litemono with no flow"),
        ([*both[:2], "--proposed", str(true)], "holds pix2pix with truth flow"),
        ([*both[:2], "--proposed", str(wide)], "trained on frames of 48x32 pixels, 90 deg"),
        ([*both, "--size", "64x64"], "add --size 32x32"),
        ([*both, "--also", str(true)], "truth flow, which no drone has"),
        ([*both, "--also", str(wide_lite)], "48x32"),
        ([*both, "--also", str(good[0])], "is the conventional network itself"),
        ([*both, "--also", str(lite), f"a={lite}"], "is the litemono network itself"),
        ([*both, "--also", str(lite), str(wide_lite)], "the name 'litemono' is taken; say --also NAME="),
        ([*both, "--also", f"blind={lite}"], "the name 'blind' is taken"),
        ([*both, "--also", f"a b={lite}"], "'a b' is no name"),
        ([*both, "--also", f"a={tmp_path / 'none.pt'}"], "no such file"),
        ([*both[:2], "--proposed", str(text)], "no torch file of weights"),
        ([*both[:2], "--proposed", str(tmp_path / "none.pt")], "no such file"),
        ([*both, "--map", "cty"], "unknown map 'cty'; perhaps you meant 'city'"),
        ([*both, "--data", str(tmp_path)], "no dataset"),
        ([*both, "--planner", "waypont"], "perhaps you meant 'waypoint'"),
        ([*both, "--profile", "smal"], "perhaps you meant 'small'"),
        ([*both, "--training.steps", "3"], "both networks are given"),
        ([*both, "--flights", "-1"], "must not be negative"),
    ):
        assert main(["table2", "--out", str(tmp_path / "out"), *arguments]) == 2
        (line,) = capsys.readouterr().err.strip().splitlines()
        assert said in line, arguments
        assert not (tmp_path / "out").exists()


SMALL = [
    *("--map", "city", "--flights", "2", "--size", "32x32", "--city.extent-m", "400"),
    *("--mission.distance-m", "45", "--loop.decision-s", "0.4"),
    *("--exposure.directions", "32", "--exposure.sun-step-min", "120"),
]
TINY = [
    *("--training.steps", "2", "--training.judge", "2", "--training.judge-pairs", "2"),
    *("--pix2pix.width", "2", "--pix2pix.judge-width", "2", "--pix2pix.downs", "3"),
]


@pytest.mark.slow
def test_the_whole_table_from_a_dataset_and_again_from_its_networks(
    toy: Path, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    out, data = tmp_path / "table", ["--data", str(toy)]
    assert main(["table2", *data, "--out", str(out), *SMALL]) == 2
    assert "its frames have 32x32 pixels, 97.6" in capsys.readouterr().err
    data += ["--camera.hfov-deg", "97.62815"]  # what the intrinsics of its made-up frames come to
    assert main(["table2", *data, "--out", str(out), "--jobs", "1", *SMALL, *TINY]) == 0
    assert "| city | " in capsys.readouterr().out
    table = json.loads((out / "table2.json").read_text())
    assert [n["w_l1"] for n in table["networks"]] == [100.0, 300.0]
    assert table["warnings"] == [] and table["failed"] == {}
    assert all(rate["of"] == 2 for rate in table["maps"]["city"]["collisions"].values())
    assert (out / "flights" / "index.html").is_file()

    # Two checkpoints instead of a dataset to learn from are the same table, and nothing is flown twice.
    names = ("table2.json", "table2.md", "table2.html", "flights/results.json", "flights/index.html")
    before = {name: (out / name).read_bytes() for name in names}
    flights = {path: path.stat().st_mtime_ns for path in out.glob("flights/flights/base/city/*/*.json")}
    assert len(flights) == 4
    runs = [str(out / "runs" / f"{row}-seed0" / "model.pt") for row in ("conventional-100", "proposed-300")]
    given = ["--conventional", runs[0], "--proposed", runs[1]]
    assert main(["table2", *data, *given, "--out", str(out), *SMALL]) == 0
    assert {name: (out / name).read_bytes() for name in names} == before
    assert {path: path.stat().st_mtime_ns for path in flights} == flights
