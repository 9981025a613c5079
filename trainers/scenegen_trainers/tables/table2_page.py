"""Table 2 as JSON, Markdown and HTML."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import asdict
from pathlib import Path
from typing import Any

from scenegen.foundation.atomic import write_atomic
from scenegen.foundation.canonical import pretty
from scenegen_datasets.pages.charts import interval_bar, key
from scenegen_datasets.pages.document import document
from scenegen_datasets.pages.markup import Html, element, join
from scenegen_datasets.pages.sheet import SERIES
from scenegen_datasets.pages.tables import Column, number
from scenegen_datasets.pages.tables import table as drawn
from scenegen_trainers.campaign.report.charts import ends_bar
from scenegen_trainers.campaign.report.ink import END_COLOUR, END_WORDS
from scenegen_trainers.campaign.statistics import CONFIDENCE, Rate
from scenegen_trainers.campaign.store import PAGE
from scenegen_trainers.campaign.summary import Line, rate_json
from scenegen_trainers.tables import table2_text as words
from scenegen_trainers.tables.names import BOUNDS
from scenegen_trainers.tables.table2 import FLIGHTS_DIR, Table2
from scenegen_trainers.tables.table2_paper import (
    METHODS,
    PRINTED_AVERAGE,
    PUBLISHED,
    Method,
    published_mean,
    published_words,
)

STEM = "table2"
PILOTS = (*METHODS, *BOUNDS)

_COLOUR = dict(zip(PILOTS, (SERIES[0], SERIES[1], SERIES[5], SERIES[5]), strict=True))
_APART = {"lower": "good", "higher": "bad", "open": "faint"}


def write_table2(table: Table2, out: Path) -> tuple[Path, ...]:
    """Write ``table2.json``, ``table2.md`` and ``table2.html``; returns their paths."""
    files = {
        f"{STEM}.json": pretty(as_json(table)),
        f"{STEM}.md": words.as_markdown(table).encode(),
        f"{STEM}.html": as_html(table).encode(),
    }
    for name, content in files.items():
        write_atomic(out / name, content)
    return tuple(out / name for name in files)


def as_json(table: Table2) -> dict[str, Any]:
    """Plain data, every digit."""
    job = table.job
    return {
        "profile": job.profile,
        "flights_per_map": job.flights,
        "confidence": CONFIDENCE,
        "planner": job.planner,
        "dataset": dict(job.dataset),
        "networks": [entrant.to_json() for entrant in job.entrants],
        "recipe": job.recipe.canonical(),
        "maps": {map: _compared(table, (map,)) | {"paper": _published(map)} for map in table.maps},
        "all_maps": _compared(table, table.maps) | {"paper_mean_percent": _means(table.maps)},
        "without_city": _compared(table, table.averaged)
        | {"paper_mean_percent": _means(table.averaged), "paper_prints_percent": dict(PRINTED_AVERAGE)},
        "others": {other.name: _held_against(table, other.name) for other in job.others},
        "lines": [line.to_json() for line in table.lines.values()],
        "failed": dict(table.failed),
        "warnings": words.warnings(table),
    }


def _compared(table: Table2, maps: Sequence[str]) -> dict[str, Any]:
    paired = table.paired(maps)
    return {
        "maps": list(maps),
        "collisions": {pilot: rate_json(table.rate(pilot, maps)) for pilot in PILOTS},
        "mean": {pilot: table.mean(pilot, maps) for pilot in PILOTS},
        "mcnemar": asdict(paired),
        "proposed_is": words.verdict(paired),
    }


def _held_against(table: Table2, name: str) -> list[dict[str, Any]]:
    """Another network against both methods: each map, then the means."""
    return [
        {
            "maps": list(maps),
            "collisions": rate_json(table.rate(name, maps)),
            "mean": table.mean(name, maps),
            "against": {
                method: {"mcnemar": asdict(paired), "other_is": words.verdict(paired)}
                for method in METHODS
                for paired in [table.paired(maps, method, name)]
            },
        }
        for _, maps in words.scopes(table)
    ]


def _published(map: str) -> dict[str, Any] | None:
    row = PUBLISHED.get(map)
    return None if row is None else asdict(row)


def _means(maps: Sequence[str]) -> dict[str, float | None]:
    return {method: published_mean(method, maps) for method in METHODS}


def as_html(table: Table2) -> str:
    """One file; the maps of all paths lie beside it, in the campaign's own page."""
    warned = (element("p", said, class_="bad") for said in words.warnings(table))
    heads = ("map", *METHODS, "proposed - conventional", *BOUNDS)
    ends = (
        "map",
        "pilot",
        Column("how flights ended", "wide"),
        number("way gained"),
        number("speed"),
        "hit most",
    )
    link = element(
        "a", "All flights, world by world, with paths and crash sites", href=f"{FLIGHTS_DIR}/{PAGE}"
    )
    return document(
        words.title(table),
        element("h1", words.title(table)),
        element("p", words.about(table), class_="lead"),
        *warned,
        element("h2", "Collision rates"),
        drawn(heads, _rows(table)),
        element("p", words.NOTE, class_="small"),
        element("p", words.AVERAGES, class_="small"),
        *_others(table),
        element("h2", "How flights ended"),
        key([(END_COLOUR[kind], word) for kind, word in END_WORDS.items()]),
        drawn(ends, [_end_row(map, pilot, line) for (map, pilot), line in table.lines.items()]),
        element("p", link),
    )


def _rows(table: Table2) -> list[list[object]]:
    """One row per map, then the means; the paper's figures below ours."""
    return [_row(table, name, maps) for name, maps in words.scopes(table)]


def _row(table: Table2, name: str, maps: Sequence[str]) -> list[object]:
    theirs = _means(maps)
    rates = [
        _rate(table.rate(pilot, maps), table.mean(pilot, maps), _COLOUR[pilot], theirs.get(pilot))
        for pilot in PILOTS
    ]
    return [element("b", name), *rates[:2], _apart(table, maps, *METHODS), *rates[2:]]


def _others(table: Table2) -> list[Html]:
    """Networks beyond the two methods; nothing where there are none."""
    if not table.job.others:
        return []
    rows: list[list[object]] = [
        [
            element("b", name),
            other.name,
            _rate(table.rate(other.name, maps), table.mean(other.name, maps), SERIES[2], None),
            *(_apart(table, maps, method, other.name) for method in METHODS),
        ]
        for name, maps in words.scopes(table)
        for other in table.job.others
    ]
    heads = ("map", "network", "collision rate", *(f"less {method}" for method in METHODS))
    return [
        element("h2", words.OTHERS_TITLE),
        drawn(heads, rows),
        element("p", words.OTHERS_NOTE, class_="small"),
    ]


def _apart(table: Table2, maps: Sequence[str], first: Method, second: str) -> Html:
    """Second less first, and whether flights tell them apart."""
    paired = table.paired(maps, first, second)
    return join(
        [
            element(
                "span",
                words.difference(table, maps, first, second),
                class_=_APART[words.verdict(paired)],
            ),
            element("div", f"p {words.p_words(paired)}", class_="small"),
        ]
    )


def _rate(rate: Rate, mean: float | None, colour: str, theirs: float | None) -> Html:
    """Share, counts, a bar with its interval, and the paper's share."""
    if not rate.of or mean is None:
        return Html("-")
    counts = f" {rate.count}/{rate.of}; {100 * rate.low:.1f} to {100 * rate.high:.1f}"
    paper = "" if theirs is None else element("div", f"paper {published_words(theirs)}", class_="small")
    figure = element("b", f"{100 * mean:.1f} %")
    return join(
        [
            figure,
            element("span", counts, class_="small"),
            interval_bar(mean, rate.low, rate.high, colour),
            paper,
        ]
    )


def _end_row(map: str, pilot: str, line: Line) -> list[object]:
    return [
        map,
        pilot,
        ends_bar(line.ends),
        words.spread_words(line.progress, 100.0, "%"),
        words.spread_words(line.speed_mps, 1.0, "m/s"),
        element("span", words.hit_words(line), class_="small"),
    ]
