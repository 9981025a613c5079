"""Table 2 as JSON, Markdown and HTML."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import asdict
from pathlib import Path
from typing import Any

from scenegen.foundation.atomic import write_atomic
from scenegen.foundation.canonical import pretty
from scenegen_trainers.campaign.report import style
from scenegen_trainers.campaign.report.charts import ends_bar, rate_bar
from scenegen_trainers.campaign.report.ink import END_COLOUR, END_WORDS, PILOT_COLOUR, text
from scenegen_trainers.campaign.statistics import CONFIDENCE, Rate
from scenegen_trainers.campaign.store import PAGE
from scenegen_trainers.campaign.summary import rate_json
from scenegen_trainers.tables import table2_text as words
from scenegen_trainers.tables.table2 import BOUNDS, FLIGHTS_DIR, Table2
from scenegen_trainers.tables.table2_paper import METHODS, PRINTED_AVERAGE, PUBLISHED, published_mean

STEM = "table2"
PILOTS = (*METHODS, *BOUNDS)
_GREY = "#8b94a3"


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
        "networks": [entrant.to_json() for entrant in (job.conventional, job.proposed)],
        "recipe": job.recipe.canonical(),
        "maps": {map: _compared(table, (map,)) | {"paper": _published(map)} for map in table.maps},
        "all_maps": _compared(table, table.maps) | {"paper_mean_percent": _means(table.maps)},
        "without_city": _compared(table, table.averaged)
        | {"paper_mean_percent": _means(table.averaged), "paper_prints_percent": dict(PRINTED_AVERAGE)},
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


def _published(map: str) -> dict[str, Any] | None:
    row = PUBLISHED.get(map)
    return None if row is None else asdict(row)


def _means(maps: Sequence[str]) -> dict[str, float | None]:
    return {method: published_mean(method, maps) for method in METHODS}


def as_html(table: Table2) -> str:
    """One file; the maps of all paths lie beside it, in the campaign's own page."""
    parts = [
        f"<h1>{text(words.title(table))}</h1><p class=lead>{text(words.about(table))}</p>",
        *(f"<p class=warning>{text(said)}</p>" for said in words.warnings(table)),
        f"<h2>Collision rate</h2><table>{_head()}{''.join(_rows(table))}</table>",
        f"<p class=small>{text(words.NOTE)}</p><p class=small>{text(words.AVERAGES)}</p>",
        f"<h2>How flights ended</h2>{_key()}<table>{''.join(_ends(table))}</table>",
        f'<p><a href="{FLIGHTS_DIR}/{PAGE}">All flights, world by world, with paths and crash sites</a></p>',
    ]
    return (
        "<!doctype html><html lang=en><head><meta charset=utf-8>"
        '<meta name=viewport content="width=device-width,initial-scale=1">'
        f"<title>{text(words.title(table))}</title><style>{style.SHEET}{_SHEET}</style></head><body><main>"
        f"{''.join(parts)}</main></body></html>\n"
    )


_SHEET = (
    "p.small{white-space:normal;max-width:80ch}p.lead{max-width:100ch}p.warning{color:#ff9d9d}"
    "td .paper{color:#8b94a3;font-size:12px;white-space:nowrap}tr.mean td{background:#161b24}"
    ".lower{color:#4fc3a1}.higher{color:#ff5c5c}.open{color:#8b94a3}"
)


def _head() -> str:
    heads = ("map", "conventional", "proposed", "proposed - conventional", "oracle", "blind")
    return f"<tr>{''.join(f'<th>{head}</th>' for head in heads)}</tr>"


def _rows(table: Table2) -> Iterator[str]:
    for map in table.maps:
        row = PUBLISHED.get(map)
        theirs = ["" if row is None else f"paper {row.percent[method]:.2f} %" for method in METHODS]
        yield _row(table, map, (map,), theirs, "")
    if len(table.maps) > 1:
        theirs = [_paper_mean(method, table.maps) for method in METHODS]
        yield _row(table, f"mean of all {len(table.maps)}", table.maps, theirs, "mean")
    if 1 < len(table.averaged) < len(table.maps):
        theirs = [_paper_mean(method, table.averaged) for method in METHODS]
        yield _row(table, "without city, as the paper averages", table.averaged, theirs, "mean")


def _paper_mean(method: Any, maps: Sequence[str]) -> str:
    mean = published_mean(method, maps)
    return "" if mean is None else f"paper {mean:.2f} %"


def _row(table: Table2, name: str, maps: Sequence[str], theirs: Sequence[str], kind: str) -> str:
    methods = "".join(
        _rate(table.rate(method, maps), table.mean(method, maps), PILOT_COLOUR[k], theirs[k])
        for k, method in enumerate(METHODS)
    )
    bounds = "".join(_rate(table.rate(pilot, maps), table.mean(pilot, maps), _GREY, "") for pilot in BOUNDS)
    paired = table.paired(maps)
    apart = (
        f"<td class={words.verdict(paired)}>{text(words.difference(table, maps))}<br><span class=small>p "
        f"{text(words.p_words(paired))}</span></td>"
    )
    return f"<tr class='{kind}'><td>{text(name)}</td>{methods}{apart}{bounds}</tr>"


def _rate(rate: Rate, mean: float | None, colour: str, theirs: str) -> str:
    if not rate.of or mean is None:
        return "<td>-</td>"
    return (
        f"<td><b>{100 * mean:.1f} %</b> <span class=small>{rate.count}/{rate.of}; "
        f"{100 * rate.low:.1f} to {100 * rate.high:.1f}</span>{rate_bar(rate, colour)}"
        f"<span class=paper>{text(theirs)}</span></td>"
    )


def _key() -> str:
    entries = "".join(
        f'<span><i style="background:{END_COLOUR[kind]}"></i>{text(word)}</span>'
        for kind, word in END_WORDS.items()
    )
    return f"<div class=key>{entries}</div>"


def _ends(table: Table2) -> Iterator[str]:
    yield (
        "<tr><th>map</th><th>pilot</th><th>ends</th><th class=number>way gained</th><th class=number>speed</th>"
        "<th>hit most</th></tr>"
    )
    for (map, pilot), line in table.lines.items():
        yield (
            f"<tr><td>{text(map)}</td><td>{text(pilot)}</td><td class=wide>{ends_bar(line.ends)}</td>"
            f"<td class=number>{words.spread_words(line.progress, 100.0, '%')}</td>"
            f"<td class=number>{words.spread_words(line.speed_mps, 1.0, 'm/s')}</td>"
            f"<td class=small>{text(words.hit_words(line))}</td></tr>"
        )
