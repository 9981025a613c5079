"""Sections: what was drawn against what was asked, and what the frames show."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

from scenegen.classes import CLASSES
from scenegen.foundation.words import counted
from scenegen_datasets.audits.contents import Contents
from scenegen_datasets.audits.draws import Draw, Draws, Tally
from scenegen_datasets.pages.charts import histogram, key, share_bar
from scenegen_datasets.pages.markup import Html, element, folded, text
from scenegen_datasets.pages.sheet import SERIES
from scenegen_datasets.pages.tables import Column, number, table
from scenegen_datasets.pictures.colour import SKY_COLOUR
from scenegen_datasets.report.words import bars, card, cards, decimals, figure, note, plain, said

_SHOWN = {
    "depth_m": ("depth of surfaces", "m", True),
    "height_m": ("height above the ground seen", "m", False),
    "contrast_K": ("contrast of a frame, 1 to 99 %", "K", True),
    "surface_contrast_K": ("contrast of its surfaces, without sky", "K", True),
    "flow_px": ("true flow", "px", True),
    "sky_share": ("share of sky in a frame", "", False),
}
_SPACED = {"m": "\u00a0m", "K": "\u00a0K", "px": "\u00a0px"}
_OF_PIXELS = ("depth_m", "flow_px")
_CLASSES_SHOWN = 12

_MONTHS_END = (0, 31, 59, 90, 120, 151, 181, 212, 243, 273, 304, 334, 365)
_TICKS = {
    "hour": tuple((float(hour), str(hour)) for hour in range(0, 25, 6)),
    "day_of_year": tuple(
        ((a + b) / 2.0, month)
        for a, b, month in zip(_MONTHS_END, _MONTHS_END[1:], "JFMAMJJASOND", strict=False)
    ),
    "latitude_deg": tuple(
        (float(x), f"{abs(x)}°{'N' if x > 0 else 'S' if x else ''}") for x in range(-90, 91, 30)
    ),
}
"""Where round numbers are not what people think in."""

_UNITS = {"deg": "°", "d": ""}
_ASKED = ("var(--span)", "the range the recipe asks for")
_SLOWER = "bends, orbits, approaches and landings are flown more slowly than the cruise speed asked for"


def drawn(draws: Draws) -> Html:
    """Every quantity as a distribution over the range that was asked for, and the tallies."""
    shaded = key([(SERIES[0], "share of the draws"), _ASKED])
    charts = [_draw(draw) for draw in draws.draws]
    tallies = [card(tally.words, _tally(tally)) for tally in draws.tallies]
    aside = (
        f"{counted(draws.rejected, 'more path')} drawn and put aside: too close to something, or of no fit."
    )
    rejected = note(aside) if draws.rejected else ""
    return Html(said(draws.verdict) + shaded + cards(*charts) + cards(*tallies, ragged=True) + text(rejected))


def _draw(draw: Draw) -> Html:
    unit = _UNITS.get(draw.unit, draw.unit)
    behind = unit if unit in ("", "°") else f"\u00a0{unit}"
    per = counted(draw.count, draw.per)
    if draw.asked is None:
        asked = "left to the climate of place and season"
    elif not draw.explicit:
        asked = "left open"
    elif draw.asked[0] == draw.asked[1]:
        least = draw.name == "clearance_m"
        asked = f"asked: {'at least ' if least else ''}{draw.asked[0]:g}{behind}"
    else:
        asked = f"asked: {draw.asked[0]:g} to {draw.asked[1]:g}{behind}".replace("-", "−")
    outside = element("b", f" · {draw.outside} outside", class_="bad") if draw.outside else ""
    shade = draw.asked if draw.explicit and draw.asked and draw.asked[0] < draw.asked[1] else None
    chart = histogram(
        [bars(draw.histogram)],
        f"{draw.words} [{unit}]" if unit else draw.words,
        asked=shade,
        ticks=_ticks(draw),
        up=f"% of the {draw.per}s",
    )
    places = decimals(draw.high - draw.low)
    low, median, high = (plain(value, places) for value in (draw.low, draw.median, draw.high))
    words = (
        f"{per}: {low} to {high}{behind}, median {median}{behind}"
        if low != high
        else f"{per}{', all of them' if draw.count > 1 else ':'} {figure(draw.low).replace('-', '−')}{behind}"
    )
    if draw.chance is not None:
        words += f"; even: p\u00a0=\u00a0{draw.chance:.2f}"
    if draw.name == "speed_mps" and draw.asked is not None and draw.low < draw.asked[0]:
        words += f"; {_SLOWER}"
    return card(
        draw.words, element("p", asked, outside, class_="small"), chart, element("p", words, class_="small")
    )


def _ticks(draw: Draw) -> tuple[tuple[float, str], ...]:
    """Ticks of its own, if three of them fit; else round numbers."""
    low, high = draw.histogram.edges[0], draw.histogram.edges[-1]
    inside = tuple((at, words) for at, words in _TICKS.get(draw.name, ()) if low <= at <= high)
    return inside if len(inside) > 2 else ()


def _tally(tally: Tally) -> Html:
    total = sum(tally.counts.values()) or 1
    most = max([*(count / total for count in tally.counts.values()), *tally.asked.values()])
    rows = [
        (
            name.replace("_", " "),
            f"{count:,}",
            f"{100 * count / total:.0f} %",
            f"{100 * tally.asked[name]:.0f} %" if name in tally.asked else "–",
            share_bar(count / total, SERIES[0], most),
        )
        for name, count in tally.counts.items()
    ]
    return table(
        (Column("", "name"), number("made"), number("share"), number("asked"), Column("", "wide")), rows
    )


def contents(found: Contents, recipe: Mapping[str, Any]) -> Html:
    """Classes, depths, heights, contrast."""
    height = recipe.get("flight", {}).get("height_m")
    charts = []
    for name, (words, unit, log) in _SHOWN.items():
        if name not in found.histograms:
            continue
        spread = getattr(found, name)
        asked = tuple(height) if name == "height_m" and isinstance(height, list | tuple) else None
        mark = (spread.median, f"median {spread.median:.3g}{_SPACED.get(unit, '')}")
        chart = histogram(
            [bars(found.histograms[name])],
            f"{words} [{unit}]" if unit in _SPACED else words,
            log=log,
            asked=asked,
            mark=mark,
            up="% of the pixels" if name in _OF_PIXELS else "% of the frames",
        )
        charts.append(card(words, *([key([_ASKED])] if asked else []), chart))
    return Html(said(found.verdict) + cards(*charts) + _classes(found))


def _classes(found: Contents) -> Html:
    if not found.classes:
        return Html("")
    colours = {kind.name: kind.colour if kind.id else SKY_COLOUR for kind in CLASSES}
    most = found.classes[0].pixels
    rows = [
        (
            Html(_swatch(colours[c.name]) + text(c.name.replace("_", " "))),
            _percent(c.pixels),
            share_bar(c.pixels, SERIES[0], most),
            f"{100 * c.frames:.0f} %",
        )
        for c in found.classes
    ]
    columns = (Column("class", "name"), number("of pixels"), Column("", "wide"), number("in frames"))
    half = (min(len(rows), _CLASSES_SHOWN) + 1) // 2
    parts = [
        card(words, table(columns, part))
        for words, part in (
            ("Commonest classes", rows[:half]),
            ("The next", rows[half:_CLASSES_SHOWN]),
        )
        if part
    ]
    rest = rows[_CLASSES_SHOWN:]
    more = folded(f"{len(rest)} rarer classes", table(columns, rest)) if rest else ""
    return Html(cards(*parts, least_px=420) + text(more))


def _percent(share: float) -> str:
    return f"{100 * share:.1f} %" if share >= 0.001 else f"{100 * share:.3f} %"


def _swatch(rgb: tuple[int, int, int]) -> str:
    return f'<i class="swatch" style="background:rgb({rgb[0]},{rgb[1]},{rgb[2]})"></i>'
