"""The page of results says what the table's own file says."""

from __future__ import annotations

import json
from pathlib import Path
from statistics import fmean, stdev
from typing import Any

import pytest

from scenegen_trainers.tables.order import judge
from scenegen_trainers.tables.paper import RELATIONS, ROWS

RESULTS = Path(__file__).parents[3] / "docs" / "results"


@pytest.fixture(scope="module")
def page() -> str:
    return (RESULTS / "table1.md").read_text(encoding="utf-8")


@pytest.fixture(scope="module")
def table() -> Any:
    return json.loads((RESULTS / "table1.json").read_text(encoding="utf-8"))


@pytest.mark.parametrize("kind", ["pooled", "painted", "pooled_aligned"])
def test_means_and_spreads_are_those_of_the_runs(page: str, table: dict[str, Any], kind: str) -> None:
    assert [row["key"] for row in table["rows"]] == [row.key for row in ROWS]
    for row in table["rows"]:
        cells = []
        for score, digits in (("rmse_m", 2), ("rel", 3), ("delta1", 3)):
            values = [run[kind][score] for run in row["runs"]]
            cells.append(f"{fmean(values):.{digits}f} ± {stdev(values):.{digits}f}")
        assert f"| {row['method']} | {row['w_l1']:g} | {' | '.join(cells)} |" in page


def test_verdicts_are_those_of_the_runs(page: str, table: dict[str, Any]) -> None:
    runs = {row["key"]: row["runs"] for row in table["rows"]}
    for relation in RELATIONS:
        cells = []
        for score in ("rmse_m", "rel", "delta1", "delta2", "delta3"):
            found = judge(relation, score, {k: [r["pooled"][score] for r in v] for k, v in runs.items()})
            cells.append(f"{found.verdict} ({found.margin:+.3f})")
        assert f"| {relation.claim} | {' | '.join(cells)} |" in page


def test_every_variant_of_the_ablation_says_its_means_spreads_and_seeds() -> None:
    page = (RESULTS / "ablation.md").read_text(encoding="utf-8")
    variants = json.loads((RESULTS / "ablation.json").read_text(encoding="utf-8"))
    most = max(map(len, variants.values()))
    lines = [line.split(" | ") for line in page.splitlines() if line.startswith("| ")]
    said = {line[0].removeprefix("| "): line[1:6] for line in lines}
    for name, runs in variants.items():
        cells = []
        for kind, score, digits in (
            ("pooled", "rmse_m", 2),
            ("pooled", "rel", 3),
            ("pooled", "delta1", 3),
            ("pooled_aligned", "delta1", 3),
            ("painted", "rmse_m", 2),
        ):
            values = [run[kind][score] for run in runs.values()]
            spread = f" ± {stdev(values):.{digits}f}" if len(values) > 1 else ""
            cells.append(f"{fmean(values):.{digits}f}{spread}")
        assert said[name if len(runs) == most else f"{name} ({len(runs)})"] == cells


def test_flights_of_table_2_are_those_that_were_counted() -> None:
    page = (RESULTS / "table2.md").read_text(encoding="utf-8")
    table = json.loads((RESULTS / "table2.json").read_text(encoding="utf-8"))
    rows = dict(table["maps"])
    rows |= {"mean of all 4": table["all_maps"], "without city": table["without_city"]}
    for name, row in rows.items():
        line = next(line for line in page.splitlines() if line.startswith(f"| {name} | "))
        for rate in row["collisions"].values():
            counts = f"({rate['count']}/{rate['of']}; {100 * rate['low']:.1f}-{100 * rate['high']:.1f})"
            assert counts in line
        paired = row["mcnemar"]
        assert f"{paired['p']:.2g} ({paired['first_only']} : {paired['second_only']})" in line
    for line in table["lines"]:
        ends = " | ".join(
            str(line["ends"][kind]["count"]) for kind in ("goal", "collision", "timeout", "pilot")
        )
        assert f"| {line['map']} | {line['pilot']} | {line['flights']} | {ends} | " in page


def test_flights_of_the_other_network_are_those_that_were_counted() -> None:
    page = (RESULTS / "table2.md").read_text(encoding="utf-8")
    table = json.loads((RESULTS / "table2.json").read_text(encoding="utf-8"))
    for row in table["others"]["litemono"]:
        rate, cells = row["collisions"], []
        for method in ("conventional", "proposed"):
            found = row["against"][method]
            paired, margin = found["mcnemar"], row["mean"] - mean_of(table, row["maps"], method)
            said = f"{paired['p']:.2g} ({paired['first_only']} : {paired['second_only']})"
            cells.append(f"{100 * margin:+.1f} ({found['other_is']}), {said}")
        counts = f"({rate['count']}/{rate['of']}; {100 * rate['low']:.1f}-{100 * rate['high']:.1f})"
        assert f"| litemono | {100 * row['mean']:.1f} % {counts} | {' | '.join(cells)} |" in page


def mean_of(table: dict[str, Any], maps: list[str], method: str) -> float:
    return fmean(table["maps"][name]["collisions"][method]["share"] for name in maps)
