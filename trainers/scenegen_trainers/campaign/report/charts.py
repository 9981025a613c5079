"""Charts as SVG: rates with their intervals, one under the other, or along an axis that was swept."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

from scenegen_datasets.pages.axes import Frame, Scale
from scenegen_datasets.pages.charts import interval_bar, stacked_bar
from scenegen_datasets.pages.markup import Html, text
from scenegen_trainers.campaign.report.ink import END_COLOUR, END_WORDS, PILOT_COLOUR, interval, percent
from scenegen_trainers.campaign.statistics import Rate

_FRAME = Frame(width=560, height=300, left=52, right=18, top=12, bottom=48)
_INSET = 22.0


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


def sweep_chart(axis: str, marks: Sequence[Mark], series: Mapping[str, Sequence[Rate]]) -> Html:
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
    up = _FRAME.up(0.0, 100.0 * top)
    named = [(x, marks[k].words) for x, k in zip(places, order, strict=True)]
    lines = [
        _line(name, places, [rates[k] for k in order], up, colour)
        for (name, rates), colour in zip(series.items(), PILOT_COLOUR, strict=False)
    ]
    return Html(_FRAME.svg(_FRAME.side(up, " %"), _FRAME.marked_foot(named, axis), *lines, words=axis))


def rate_bar(rate: Rate, colour: str) -> Html:
    """A rate as a bar from 0 to 1 with its interval on it."""
    return interval_bar(rate.share if rate.of else 0.0, rate.low, rate.high, colour)


def ends_bar(ends: Mapping[str, Rate]) -> Html:
    """How flights ended, as one stacked bar."""
    return stacked_bar(
        [
            (
                rate.share if rate.of else 0.0,
                END_COLOUR[kind],
                f"{END_WORDS[kind]}: {rate.count} ({percent(rate)}, 95 % {interval(rate)})",
            )
            for kind, rate in ends.items()
        ]
    )


def _order(marks: Sequence[Mark]) -> list[int]:
    """By number; as written where some are none."""
    if any(mark.number is None for mark in marks):
        return list(range(len(marks)))
    return sorted(range(len(marks)), key=lambda k: marks[k].number or 0.0)


def _places(marks: Sequence[Mark]) -> list[float]:
    left, right = _FRAME.left, _FRAME.width - _FRAME.right
    known = [mark.number for mark in marks if mark.number is not None]
    if len(known) < len(marks) or len(marks) < 2 or max(known) == min(known):
        step = (right - left) / len(marks)
        return [left + (k + 0.5) * step for k in range(len(marks))]
    across = Scale(min(known), max(known), left + _INSET, right - _INSET)
    return [across(number) for number in known]


def _nice_top(share: float) -> float:
    return next(top for top in (0.05, 0.1, 0.2, 0.4, 0.6, 0.8, 1.0) if share <= top + 1e-9 or top == 1.0)


def _line(name: str, places: Sequence[float], rates: Sequence[Rate], up: Scale, colour: str) -> str:
    flown = [(x, rate) for x, rate in zip(places, rates, strict=True) if rate.of]
    if not flown:
        return ""
    upper = [f"{x:.1f} {up(100 * rate.high):.1f}" for x, rate in flown]
    lower = [f"{x:.1f} {up(100 * rate.low):.1f}" for x, rate in reversed(flown)]
    middle = [f"{x:.1f} {up(100 * rate.share):.1f}" for x, rate in flown]
    parts = [
        f'<path class="band" d="M{"L".join([*upper, *lower])}Z" fill="{colour}"/>',
        f'<path class="line" d="M{"L".join(middle)}" stroke="{colour}"/>',
    ]
    for x, rate in flown:
        title = f"{name}: {percent(rate)} ({rate.count} of {rate.of}; 95 % {interval(rate)})"
        y, low, high = (up(100 * share) for share in (rate.share, rate.low, rate.high))
        parts.append(f'<path class="whisker" stroke="{colour}" d="M{x:.1f} {low:.1f}V{high:.1f}"/>')
        parts.append(
            f'<circle cx="{x:.1f}" cy="{y:.1f}" r="4" fill="{colour}"><title>{text(title)}</title></circle>'
        )
    return "".join(parts)
