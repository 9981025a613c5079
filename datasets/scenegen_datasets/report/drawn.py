"""Sections: what was drawn against what was asked, and what the frames show."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

from scenegen.classes import CLASSES
from scenegen_datasets.audits.contents import Contents
from scenegen_datasets.audits.draws import Draw, Draws, Tally
from scenegen_datasets.pages.charts import histogram, key, share_bar
from scenegen_datasets.pages.markup import Html, element, text
from scenegen_datasets.pages.sheet import SERIES
from scenegen_datasets.pages.tables import Column, number, table
from scenegen_datasets.report.words import bars, card, cards, note, said

_SHOWN = {
    "depth_m": ("depth of surfaces", "m", True),
    "height_m": ("height above the ground seen", "m", False),
    "contrast_K": ("contrast of a frame, 1 to 99 %", "K", True),
    "surface_contrast_K": ("contrast of its surfaces, without sky", "K", True),
    "flow_px": ("true flow", "px", True),
    "sky_share": ("share of sky", "of the pixels", False),
}
_CLASSES_SHOWN = 16


def drawn(draws: Draws) -> Html:
    """Every quantity as a distribution over the range that was asked for, and the tallies."""
    shaded = key([("var(--span)", "the range the recipe asks for")])
    charts = [_draw(draw) for draw in draws.draws]
    counted = [card(tally.words, _tally(tally)) for tally in draws.tallies]
    rejected = note(
        f"{draws.rejected:,} paths were drawn and thrown away because they came too close to something or did not fit."
    )
    return Html(said(draws.verdict) + shaded + cards(*charts) + cards(*counted) + rejected)


def _draw(draw: Draw) -> Html:
    unit = f" [{draw.unit}]" if draw.unit else ""
    per = f"{draw.count:,} {draw.per}{'s' if draw.count != 1 else ''}"
    if draw.asked is None:
        asked = "left to the climate of place and season"
    elif not draw.explicit:
        asked = "left open"
    elif draw.asked[0] == draw.asked[1]:
        least = draw.name == "clearance_m"
        asked = f"asked: {'at least ' if least else ''}{draw.asked[0]:g}"
    else:
        asked = f"asked: {draw.asked[0]:g} to {draw.asked[1]:g}"
    outside = element("b", f" · {draw.outside} outside", class_="bad") if draw.outside else ""
    shade = draw.asked if draw.explicit and draw.asked and draw.asked[0] < draw.asked[1] else None
    chart = histogram([bars(draw.histogram)], f"{draw.words}{unit}", asked=shade)
    foot = element("p", f"{per}: {draw.low:.3g} to {draw.high:.3g}, median {draw.median:.3g}", class_="small")
    return card(draw.words, element("p", asked, outside, class_="small"), chart, foot)


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
        mark = (spread.median, f"median {spread.median:.3g}")
        chart = histogram(
            [bars(found.histograms[name])], f"{words} [{unit}]", log=log, asked=asked, mark=mark
        )
        charts.append(card(words, chart))
    return Html(said(found.verdict) + cards(*charts) + _classes(found))


def _classes(found: Contents) -> Html:
    if not found.classes:
        return Html("")
    colours = {kind.name: kind.colour for kind in CLASSES}
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
    columns = (Column("class", "name"), number("of pixels"), Column("", "wide"), number("of frames show it"))
    rest = rows[_CLASSES_SHOWN:]
    more = (
        element("details", element("summary", f"{len(rest)} rarer classes"), table(columns, rest))
        if rest
        else ""
    )
    return Html(
        element("h3", "Classes", style="margin-top:26px") + table(columns, rows[:_CLASSES_SHOWN]) + text(more)
    )


def _percent(share: float) -> str:
    return f"{100 * share:.1f} %" if share >= 0.001 else f"{100 * share:.3f} %"


def _swatch(rgb: tuple[int, int, int]) -> str:
    return f'<i class="swatch" style="background:rgb({rgb[0]},{rgb[1]},{rgb[2]})"></i>'
