"""Table 1 as JSON, Markdown and HTML. Nothing in them differs between two runs of the same table."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import asdict
from math import isfinite
from pathlib import Path
from statistics import fmean, stdev
from typing import Any

from scenegen.foundation.atomic import write_atomic
from scenegen.foundation.canonical import pretty
from scenegen_datasets.pages.document import document
from scenegen_datasets.pages.markup import Html, element, text
from scenegen_datasets.pages.tables import Column
from scenegen_datasets.pages.tables import table as drawn
from scenegen_trainers.evaluation.scores import DIGITS, HEADS, NAMES, markdown, rounded
from scenegen_trainers.tables.order import Found
from scenegen_trainers.tables.paper import ROWS, Row
from scenegen_trainers.tables.table1 import Table1

STEM = "table1"

NOTE = (
    "The paper's figures stand beside ours for their order, not for their size: it judged AirSim's pictures, its RMSE "
    "has no stated unit, and its sizes, splits and training times are unknown. Ours are in metres over pixels with a "
    "true depth of 0.5 m to the cap, sky left out, pooled over all pixels as Eq. (5) to (7) are written; ± is one "
    "standard deviation over seeds."
)

VERDICTS = (
    "held: better by more than seeds explain (paired t, 95 %), in the pair of rows it is worst off with where a claim "
    "names several; not held: worse by more than that; open: neither. In brackets: by how much it is better."
)


def write_table1(table: Table1, out: Path) -> tuple[Path, ...]:
    """Write ``table1.json``, ``table1.md`` and ``table1.html``; returns their paths."""
    files = {
        f"{STEM}.json": pretty(as_json(table)),
        f"{STEM}.md": as_markdown(table).encode(),
        f"{STEM}.html": as_html(table).encode(),
    }
    for name, content in files.items():
        write_atomic(out / name, content)
    return tuple(out / name for name in files)


def as_json(table: Table1) -> dict[str, Any]:
    """Plain data, every digit, every seed."""
    return {
        "dataset": dict(table.dataset),
        "split": table.split,
        "profile": table.profile,
        "steps": table.steps,
        "seeds": list(table.seeds),
        "rows": [
            {
                "key": row.key,
                "method": row.method,
                "w_l1": row.w_l1,
                "published": dict(row.figures),
                "runs": [dict(run) for run in table.runs[row.key]],
                "mean": {name: table.mean_and_spread(row.key, name)[0] for name in NAMES},
                "spread": {name: table.mean_and_spread(row.key, name)[1] for name in NAMES},
            }
            for row in ROWS
        ],
        "baselines": {name: dict(scores) for name, scores in table.baselines.items()},
        "relations": [_finite(asdict(found)) for found in table.relations()],
        "against_trivial": {
            kind: [_finite(asdict(found)) for found in table.against_trivial(kind)] for _, kind in _SECTIONS
        },
    }


def _finite(values: dict[str, Any]) -> dict[str, Any]:
    return {k: None if isinstance(v, float) and not isfinite(v) else v for k, v in values.items()}


def _title(table: Table1) -> str:
    return f"Table 1 on {table.dataset['name']} {table.dataset['version']}, split {table.split}"


def _about(table: Table1) -> str:
    seeds = ", ".join(map(str, table.seeds))
    return f"Profile {table.profile}: {table.steps:,} steps for each of {len(ROWS)} rows and seeds {seeds}."


Cells = Sequence[str]


def _score_rows(table: Table1, kind: str) -> list[Cells]:
    rows: list[Cells] = []
    for row in ROWS:
        ours = [_cell(table, row, name, digits, kind) for name, digits in zip(NAMES, DIGITS, strict=True)]
        paper = [f"{value:.3f}" for value in row.published]
        rows.append([row.method, f"{row.w_l1:g}", *ours, *paper])
    for name, scores in table.baselines.items():
        rows.append([f"{name}, no image", "", *rounded(scores[kind]), *[""] * len(NAMES)])
    return rows


def _cell(table: Table1, row: Row, name: str, digits: int, kind: str) -> str:
    return _spread(table.values(row.key, name, kind), digits)


def _spread(values: Sequence[float], digits: int) -> str:
    return f"{fmean(values):.{digits}f}" + (f" ± {stdev(values):.{digits}f}" if len(values) > 1 else "")


def _range_table(table: Table1) -> tuple[Cells, list[Cells]]:
    """RMSE and Rel by true distance: head and rows. Ranges without a pixel are left out."""
    judged = [(f"{r.method}, w_L1 = {r.w_l1:g}", table.runs[r.key]) for r in ROWS]
    judged += [(f"{name}, no image", [scores]) for name, scores in table.baselines.items()]
    some = [k for k, part in enumerate(judged[0][1][0]["by_range"]) if part["scores"]]
    bounds = [judged[0][1][0]["by_range"][k] for k in some]
    names = [f"{b['from_m']:g} to {b['below_m']:g} m" for b in bounds]
    head = ["", *(f"{score}, {name}" for name in names for score in HEADS[:2])]
    rows: list[Cells] = []
    for label, runs in judged:
        cells = [
            _spread([float(run["by_range"][k]["scores"][score]) for run in runs], digits)
            for k in some
            for score, digits in zip(NAMES[:2], DIGITS[:2], strict=True)
        ]
        rows.append([label, *cells])
    return head, rows


def _relation_rows(found: Sequence[Found]) -> list[Cells]:
    """One row per claim, one verdict per score."""
    claims = list(dict.fromkeys(f.claim for f in found))
    return [[claim, *(_verdict(f) for f in found if f.claim == claim)] for claim in claims]


def _verdict(found: Found) -> str:
    return f"{found.verdict} ({found.margin:+.3f})"


_MANY = 8
"""Columns that still fit in letters of full size."""

_SCORE_HEAD = ("method", "w_L1", *HEADS, *(f"paper's {head.removesuffix(' [m]')}" for head in HEADS))
_SECTIONS = (
    ("", "pooled"),
    ("Sky and everything beyond judged as if it stood at the cap, as in a depth picture", "painted"),
    ("Each estimate scaled to its truth's median first", "pooled_aligned"),
)


def _judgements(table: Table1) -> list[tuple[str, list[Found]]]:
    """What is asked of the runs, and what they say."""
    sections = [("The paper's relations", table.relations())]
    if table.baselines:
        sections += [
            ("Better than the mean depth of each image row", table.against_trivial()),
            ("The same, each estimate scaled to its truth's median", table.against_trivial("pooled_aligned")),
            ("The same, sky judged as cap by both", table.against_trivial("painted")),
        ]
    return sections


def as_markdown(table: Table1) -> str:
    """A page."""
    parts = [f"# {_title(table)}", _about(table), NOTE]
    for heading, kind in _SECTIONS:
        parts += [f"## {heading}"] if heading else []
        parts.append(markdown(_SCORE_HEAD, _score_rows(table, kind)))
    parts += ["## By true distance", markdown(*_range_table(table))]
    for heading, found in _judgements(table):
        parts += [f"## {heading}", markdown(("claim", *HEADS), _relation_rows(found))]
    parts.append(VERDICTS)
    return "\n\n".join(parts) + "\n"


def as_html(table: Table1) -> str:
    """One self-contained file."""
    parts = [
        element("h1", _title(table)),
        element("p", _about(table), class_="lead"),
        element("p", NOTE),
    ]
    for heading, kind in _SECTIONS:
        parts += [element("h2", heading)] if heading else []
        parts.append(_html(_SCORE_HEAD, _score_rows(table, kind)))
    parts += [element("h2", "By true distance"), _html(*_range_table(table))]
    for heading, found in _judgements(table):
        parts += [element("h2", heading), _html(("claim", *HEADS), _relation_rows(found))]
    parts.append(element("p", VERDICTS, class_="small"))
    return document(_title(table), *parts)


def _html(head: Cells, rows: Sequence[Cells]) -> Html:
    columns = [Column(name, "name" if k == 0 else "number") for k, name in enumerate(head)]
    cells = [[_coloured(c, n) for c, n in zip(row, head, strict=True)] for row in rows]
    return drawn(columns, cells, dense=len(head) > _MANY)


def _coloured(cell: str, column: str) -> Html:
    """The paper's figures stand back; verdicts show what they say."""
    if column.startswith("paper's"):
        return element("span", cell, class_="faint")
    kind = {"held": "good", "not held": "bad", "open": "faint"}.get(cell.partition(" (")[0])
    return text(cell) if kind is None else element("span", cell, class_=kind)
