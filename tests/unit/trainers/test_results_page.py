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
