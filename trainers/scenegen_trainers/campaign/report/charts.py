"""Charts as SVG: rates with their intervals, one under the other, or along an axis that was swept."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

from scenegen_trainers.campaign.report.ink import END_COLOUR, END_WORDS, PILOT_COLOUR, interval, percent, text
from scenegen_trainers.campaign.statistics import Rate

WIDTH, HEIGHT = 560, 300
_LEFT, _RIGHT, _TOP, _BOTTOM = 52, 18, 34, 48


@dataclass(frozen=True)
class Mark:
    """One value of a swept axis.

    Attributes
    ----------
    words : str
        The value as it was written.
    number : float or None
        Its place along the axis; None spaces the marks evenly.
    """

    words: str
    number: float | None


def sweep_chart(axis: str, marks: Sequence[Mark], series: Mapping[str, Sequence[Rate]]) -> str:
    """Rates along an axis, a line and a band of intervals for each pilot.

    Parameters
    ----------
    axis : str
        Words under the axis.
    marks : sequence of Mark
    series : mapping of str to sequence of Rate
        Of each pilot, one rate for each mark.
    """
    order = _order(marks)
    places = _places([marks[k] for k in order])
    top = _nice_top(max((rate.high for rates in series.values() for rate in rates), default=1.0))
    body = [_grid(top), *(_tick(x, marks[k].words) for x, k in zip(places, order, strict=True))]
    for (name, rates), colour in zip(series.items(), PILOT_COLOUR, strict=False):
        body.append(_line(name, places, [rates[k] for k in order], top, colour))
    middle = (_LEFT + WIDTH - _RIGHT) / 2
    body.append(f'<text class="axis" x="{middle}" y="{HEIGHT - 8}">{text(axis)}</text>')
    body.append(_key(list(series)) if len(series) > 1 else "")
    return f'<svg viewBox="0 0 {WIDTH} {HEIGHT}" class="chart">{"".join(body)}</svg>'


STYLE = (
    ".chart text{fill:#8b94a3;font:11px system-ui,sans-serif}.chart text.axis{text-anchor:middle;fill:#c3cad6}"
    ".chart .grid{stroke:#262c37;stroke-width:1}.chart .x{text-anchor:middle}.chart .y{text-anchor:end}"
    ".chart .line{fill:none;stroke-width:2}.chart .band{opacity:.16}.chart .whisker{stroke-width:1.2;opacity:.75}"
)
"""Style sheet of all charts."""


def rate_bar(rate: Rate, colour: str) -> str:
    """A rate as a bar from 0 to 1 with its interval on it."""
    x, low, high = 300 * rate.share if rate.of else 0.0, 300 * rate.low, 300 * rate.high
    return (
        '<svg viewBox="0 0 300 14" class="bar" preserveAspectRatio="none">'
        '<rect width="300" height="14" fill="#222834"/>'
        f'<rect width="{x:.1f}" height="14" fill="{colour}" opacity=".85"/>'
        f'<rect x="{low:.1f}" y="5" width="{max(high - low, 0.5):.1f}" height="4" fill="#f3f6fb" opacity=".8"/></svg>'
    )


def share_bar(share: float, colour: str) -> str:
    """A share as a plain bar."""
    return (
        '<svg viewBox="0 0 300 14" class="bar" preserveAspectRatio="none">'
        f'<rect width="{300 * share:.1f}" height="14" fill="{colour}" opacity=".8"/></svg>'
    )


def ends_bar(ends: Mapping[str, Rate]) -> str:
    """How flights ended, as one stacked bar."""
    x, parts = 0.0, []
    for kind, rate in ends.items():
        width = 300 * rate.share if rate.of else 0.0
        title = f"{END_WORDS[kind]}: {rate.count} ({percent(rate)}, 95 % {interval(rate)})"
        parts.append(
            f'<rect x="{x:.2f}" width="{width:.2f}" height="14" fill="{END_COLOUR[kind]}"><title>{text(title)}'
            "</title></rect>"
        )
        x += width
    return f'<svg viewBox="0 0 300 14" class="bar" preserveAspectRatio="none">{"".join(parts)}</svg>'


def _order(marks: Sequence[Mark]) -> list[int]:
    """By number; as written where some are none."""
    if any(mark.number is None for mark in marks):
        return list(range(len(marks)))
    return sorted(range(len(marks)), key=lambda k: marks[k].number or 0.0)


def _places(marks: Sequence[Mark]) -> list[float]:
    span = WIDTH - _RIGHT - _LEFT
    numbers = [mark.number for mark in marks]
    known = [n for n in numbers if n is not None]
    inset = 22.0
    if len(known) < len(numbers) or len(numbers) < 2 or max(known) == min(known):
        step = span / len(numbers)
        return [_LEFT + (k + 0.5) * step for k in range(len(numbers))]
    low, high = min(known), max(known)
    return [_LEFT + inset + (span - 2 * inset) * (n - low) / (high - low) for n in known]


def _nice_top(share: float) -> float:
    return next(top for top in (0.05, 0.1, 0.2, 0.4, 0.6, 0.8, 1.0) if share <= top + 1e-9 or top == 1.0)


def _y(share: float, top: float) -> float:
    return _TOP + (HEIGHT - _TOP - _BOTTOM) * (1.0 - share / top)


def _grid(top: float) -> str:
    parts = []
    for k in range(5):
        share = top * k / 4
        y = _y(share, top)
        parts.append(f'<path class="grid" d="M{_LEFT} {y:.1f}H{WIDTH - _RIGHT}"/>')
        parts.append(f'<text class="y" x="{_LEFT - 8}" y="{y + 4:.1f}">{100 * share:g} %</text>')
    return "".join(parts)


def _tick(x: float, words: str) -> str:
    return f'<text class="x" x="{x:.1f}" y="{HEIGHT - _BOTTOM + 18}">{text(words)}</text>'


def _line(name: str, places: Sequence[float], rates: Sequence[Rate], top: float, colour: str) -> str:
    flown = [(x, rate) for x, rate in zip(places, rates, strict=True) if rate.of]
    if not flown:
        return ""
    upper = [f"{x:.1f} {_y(rate.high, top):.1f}" for x, rate in flown]
    lower = [f"{x:.1f} {_y(rate.low, top):.1f}" for x, rate in reversed(flown)]
    middle = [f"{x:.1f} {_y(rate.share, top):.1f}" for x, rate in flown]
    parts = [
        f'<path class="band" d="M{"L".join([*upper, *lower])}Z" fill="{colour}"/>',
        f'<path class="line" d="M{"L".join(middle)}" stroke="{colour}"/>',
    ]
    for x, rate in flown:
        title = f"{name}: {percent(rate)} ({rate.count} of {rate.of}; 95 % {interval(rate)})"
        y, low, high = (_y(share, top) for share in (rate.share, rate.low, rate.high))
        parts.append(f'<path class="whisker" stroke="{colour}" d="M{x:.1f} {low:.1f}V{high:.1f}"/>')
        parts.append(
            f'<circle cx="{x:.1f}" cy="{y:.1f}" r="4" fill="{colour}"><title>{text(title)}</title></circle>'
        )
    return "".join(parts)


def _key(names: Sequence[str]) -> str:
    parts, x = [], _LEFT + 10.0
    for name, colour in zip(names, PILOT_COLOUR, strict=False):
        parts.append(f'<rect x="{x:.0f}" y="6" width="10" height="10" fill="{colour}"/>')
        parts.append(f'<text x="{x + 15:.0f}" y="15">{text(name)}</text>')
        x += 30.0 + 6.5 * len(name)
    return "".join(parts)
