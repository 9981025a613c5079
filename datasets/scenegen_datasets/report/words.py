"""Pieces that all sections of a report share."""

from __future__ import annotations

import math
import re

from scenegen_datasets.audits.histogram import Histogram, Spread
from scenegen_datasets.audits.verdict import Verdict
from scenegen_datasets.pages.axes import SUPERSCRIPT
from scenegen_datasets.pages.charts import Bars
from scenegen_datasets.pages.markup import Html, element
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
.ragged{align-items:start}
@media print{.strip{grid-template-columns:repeat(3,1fr);gap:8px;margin-top:14px}
.strip a{padding:8px 10px;font-size:11px}.strip small{font-size:10px}}
"""

_UNITS = "%|px|mK|K|km|m|m/s|bit|s|TB|GB|MB|kB|MiB|h|°C"
_BEFORE_UNIT = re.compile(rf"(?<=\d) (?=(?:{_UNITS})(?![\w/]))")


def sign(verdict: Verdict) -> Html:
    """A round sign of the level."""
    kind, mark = LEVELS[verdict.level]
    return element("span", element("span", mark), class_=f"sign {kind}")


def said(verdict: Verdict) -> Html:
    """The verdict as it opens a section."""
    words = [element("p", element("b", verdict.headline))]
    words += [element("p", tied(verdict.words))] if verdict.words else []
    return element("div", sign(verdict), element("div", *words), class_="said")


def tied(words: str) -> str:
    """The same words; no line breaks between a number and its unit."""
    return _BEFORE_UNIT.sub("\u00a0", words)


def section(name: str, title: str, *content: object) -> Html:
    """A section that can be linked to."""
    return element("section", element("h2", title), *content, id=name)


def card(title: str, *content: object) -> Html:
    """A chart with its title."""
    return element("div", element("h3", title), *content, class_="card")


def cards(*content: object, least_px: int = 330, ragged: bool = False) -> Html:
    """Cards side by side, as many as fit; `ragged` leaves each as high as what it holds."""
    kind = "cards ragged" if ragged else "cards"
    return element("div", *content, class_=kind, style=f"--least:{least_px}px")


def note(*content: object) -> Html:
    """Small print."""
    words = (part if isinstance(part, Html) else tied(str(part)) for part in content)
    return element("p", *words, class_="small")


def bars(found: Histogram, name: str = "", colour: str = SERIES[0]) -> Bars:
    """A distribution for a chart."""
    return Bars(name, found.edges, found.counts, colour)


def figures(spread: Spread, digits: int = 3, unit: str = "") -> tuple[str, str, str, str]:
    """Median, 95 %, 99 % and number of values as cells."""
    shown = [figure(value, digits) for value in (spread.median, spread.high, spread.top)]
    median, high, top = (words + unit.replace(" ", "\u00a0") if words != "–" else words for words in shown)
    return median, high, top, f"{spread.count:,}"


def decimals(span: float) -> int:
    """How many decimals tell values apart that spread over `span`: about three digits of it."""
    return max(0, 2 - math.floor(math.log10(span))) if span >= 1e-3 else 3


def plain(value: float, places: int) -> str:
    """A number with so many decimals, a true minus, and no minus before zero."""
    words = f"{value:,.{places}f}"
    return words.lstrip("-") if not words.strip("-0.,") else words.replace("-", "−")


def figure(value: float | None, digits: int = 3) -> str:
    """A number as people write it: 1,240 and 4.6 × 10⁻⁶."""
    if value is None:
        return "–"
    if abs(value) >= 1000.0:
        return f"{value:,.0f}"
    if value == 0.0 or abs(value) >= 1e-3:
        return f"{value:.{digits}g}"
    mantissa, exponent = f"{value:.{digits - 1}e}".split("e")
    return f"{mantissa} × 10{str(int(exponent)).translate(SUPERSCRIPT)}"
