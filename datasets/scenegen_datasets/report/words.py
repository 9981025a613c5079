"""Pieces that all sections of a report share."""

from __future__ import annotations

from scenegen_datasets.audits.histogram import Histogram, Spread
from scenegen_datasets.audits.verdict import Verdict
from scenegen_datasets.pages.charts import Bars
from scenegen_datasets.pages.markup import Html, element, join
from scenegen_datasets.pages.sheet import SERIES

LEVELS = {"fine": ("good", "✓"), "note": ("note", "!"), "fault": ("bad", "✕"), "skipped": ("faint", "–")}
"""Class and sign of each level of a verdict."""

SHEET = """
.strip{display:grid;grid-template-columns:repeat(auto-fill,minmax(min(340px,100%),1fr));gap:12px;margin:26px 0 0}
.strip a{display:flex;gap:12px;background:var(--card);border:1px solid var(--line);border-radius:10px;padding:12px 14px;
text-decoration:none;color:var(--ink);font-size:14px;line-height:1.4}
.strip a:hover{border-color:var(--faint)}
.strip small{display:block;color:var(--faint);font-size:12.5px}
.sign{flex:none;width:22px;height:22px;border-radius:50%;background:currentColor;display:inline-grid;place-items:center}
.sign span{color:var(--ground);font-weight:700;font-size:12px;line-height:1}
.said{display:flex;gap:12px;margin:12px 0 4px}
.said p{margin:0}
.said p+p{margin-top:4px;color:var(--soft)}
"""


def sign(verdict: Verdict) -> Html:
    """A round sign of the level."""
    kind, mark = LEVELS[verdict.level]
    return element("span", element("span", mark), class_=f"sign {kind}")


def said(verdict: Verdict) -> Html:
    """The verdict as it opens a section."""
    words = [element("p", element("b", verdict.headline))]
    words += [element("p", verdict.words)] if verdict.words else []
    return element("div", sign(verdict), element("div", *words), class_="said")


def section(name: str, title: str, *content: object) -> Html:
    """A section that can be linked to."""
    return element("section", element("h2", title), *content, id=name)


def card(title: str, *content: object) -> Html:
    """A chart with its title."""
    return element("div", element("h3", title), *content, class_="card")


def cards(*content: object, least_px: int = 330) -> Html:
    """Cards side by side, as many as fit."""
    return element("div", *content, class_="cards", style=f"--least:{least_px}px")


def note(*content: object) -> Html:
    """Small print."""
    return element("p", *content, class_="small")


def bars(found: Histogram, name: str = "", colour: str = SERIES[0]) -> Bars:
    """A distribution for a chart."""
    return Bars(name, found.edges, found.counts, colour)


def figures(spread: Spread, digits: int = 3, unit: str = "") -> tuple[str, str, str, str]:
    """Median, 95 %, 99 % and number of values as cells."""
    values = (spread.median, spread.high, spread.top)
    shown = [("–" if value is None else f"{value:.{digits}g}{unit}") for value in values]
    return shown[0], shown[1], shown[2], f"{spread.count:,}"


def all_of(parts: list[Html]) -> Html:
    """Several pieces as one."""
    return join(parts)
