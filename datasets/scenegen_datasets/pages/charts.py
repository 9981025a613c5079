"""Charts as SVG: distributions, curves with bands, bars with a share."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

from scenegen_datasets.pages.axes import Frame, Scale, tick_words
from scenegen_datasets.pages.markup import Html, text
from scenegen_datasets.pages.sheet import SERIES

SMALL = Frame()
"""Of a chart in one of three columns."""

LARGE = Frame(width=540, height=280, left=54, right=16, bottom=42)
"""Of a chart in one of two columns."""


@dataclass(frozen=True)
class Bars:
    """A distribution to draw.

    Attributes
    ----------
    name : str
    edges, counts : sequence of float
        One more edge than counts.
    colour : str
    """

    name: str
    edges: Sequence[float]
    counts: Sequence[float]
    colour: str = SERIES[0]


def histogram(
    series: Sequence[Bars],
    words: str,
    *,
    log: bool = False,
    asked: tuple[float, float] | None = None,
    mark: tuple[float, str] | None = None,
    ticks: Sequence[tuple[float, str]] = (),
    up: str = "",
    frame: Frame = SMALL,
) -> Html:
    """Distributions over one axis, each scaled to its own total.

    Parameters
    ----------
    series : sequence of Bars
        One is drawn as bars, several as outlines.
    words : str
        Of the axis below, with its unit.
    log : bool
        Logarithmic axis.
    asked : (float, float), optional
        A range to shade.
    mark : (float, str), optional
        A place to mark, and its words.
    ticks : sequence of (float, str)
        Of the axis below; round values by default.
    up : str
        What the shares on the left are shares of.
    frame : Frame
    """
    frame = frame.under(up)
    low = min(s.edges[0] for s in series)
    high = max(s.edges[-1] for s in series)
    x = frame.across(low, high, log)
    shares = [[100.0 * count / (sum(s.counts) or 1.0) for count in s.counts] for s in series]
    y = frame.up(0.0, max(max(found) for found in shares) * (1.18 if mark else 1.04) or 1.0)
    parts = [frame.side(y, " %", 3), *([_asked(x, y, asked)] if asked else [])]
    for s, found in zip(series, shares, strict=True):
        parts.append(_outline(s, found, x, y) if len(series) > 1 else _bars(s, found, x, y))
    if mark:
        parts.append(_mark(x, y, *mark))
    foot = frame.marked_foot([(x(at), said) for at, said in ticks], words) if ticks else frame.foot(x, words)
    return Html(frame.svg(frame.upright(up), *parts, foot, words=_described(series, words)))


def _described(series: Sequence[Bars], words: str) -> str:
    """The chart in a sentence: what its axis is, and where each distribution has its middle."""
    middles = [f"{s.name} " * bool(s.name) + tick_words(_median(s)) for s in series if sum(s.counts)]
    return f"distribution of {words}; median about {', '.join(middles)}" if middles else words


def _median(bars: Bars) -> float:
    half, so_far = sum(bars.counts) / 2.0, 0.0
    for left, right, count in zip(bars.edges[:-1], bars.edges[1:], bars.counts, strict=True):
        so_far += count
        if so_far >= half:
            return float(f"{(left + right) / 2.0:.3g}")
    return bars.edges[-1]


def _asked(x: Scale, y: Scale, asked: tuple[float, float]) -> str:
    left, right = x(asked[0]), x(asked[1])
    width = max(right - left, 2.0)
    return (
        f'<rect x="{left:.1f}" y="{y.end}" width="{width:.1f}" height="{y.start - y.end}" fill="var(--span)">'
        f"<title>asked: {asked[0]:g} to {asked[1]:g}</title></rect>"
    )


def _bars(bars: Bars, shares: Sequence[float], x: Scale, y: Scale) -> str:
    parts = []
    for left, right, share in zip(bars.edges[:-1], bars.edges[1:], shares, strict=True):
        if share <= 0.0:
            continue
        a, b, top = x(left), x(right), y(share)
        title = f"{tick_words(left)} to {tick_words(right)}: {share:.1f} %"
        parts.append(
            f'<rect x="{a + 0.5:.1f}" y="{top:.1f}" width="{max(b - a - 1.0, 0.6):.1f}" '
            f'height="{y.start - top:.1f}" fill="{bars.colour}"><title>{text(title)}</title></rect>'
        )
    return "".join(parts)


def _outline(bars: Bars, shares: Sequence[float], x: Scale, y: Scale) -> str:
    places = [f"M{x(bars.edges[0]):.1f} {y.start:.1f}"]
    for left, right, share in zip(bars.edges[:-1], bars.edges[1:], shares, strict=True):
        places.append(f"L{x(left):.1f} {y(share):.1f}L{x(right):.1f} {y(share):.1f}")
    way = "".join(places) + f"L{x(bars.edges[-1]):.1f} {y.start:.1f}"
    return (
        f'<path class="band" d="{way}Z" fill="{bars.colour}"/>'
        f'<path class="line" d="{way}" stroke="{bars.colour}"><title>{text(bars.name)}</title></path>'
    )


def _mark(x: Scale, y: Scale, value: float, words: str) -> str:
    at = x(value)
    anchor = "end" if at > (x.start + x.end) / 2 else "start"
    shift = -5 if anchor == "end" else 5
    return (
        f'<path class="grid" style="stroke:var(--soft);stroke-dasharray:3 3" d="M{at:.1f} {y.start}V{y.end}"/>'
        f'<text x="{at + shift:.1f}" y="{y.end + 10:.1f}" style="text-anchor:{anchor};fill:var(--soft)">'
        f"{text(words)}</text>"
    )


@dataclass(frozen=True)
class Curve:
    """A line to draw, with a band where `low` and `high` are given."""

    name: str
    x: Sequence[float]
    y: Sequence[float]
    colour: str = SERIES[0]
    low: Sequence[float] = ()
    high: Sequence[float] = ()
    dots: bool = False


def curves(
    lines: Sequence[Curve],
    across: str,
    x_range: tuple[float, float],
    y_range: tuple[float, float],
    *,
    log_x: bool = False,
    log_y: bool = False,
    unit: str = "",
    level: float | None = None,
    up: str = "",
    frame: Frame = LARGE,
) -> Html:
    """Lines over two axes.

    Parameters
    ----------
    lines : sequence of Curve
    across : str
        Words of the axis below.
    x_range, y_range : (float, float)
    log_x, log_y : bool
    unit : str
        Behind the ticks on the left.
    level : float, optional
        A level line of its own.
    up : str
        Words of the axis on the left.
    frame : Frame
    """
    frame = frame.under(up)
    x, y = frame.across(*x_range, log_x), frame.up(*y_range, log_y)
    parts = [frame.upright(up), frame.side(y, unit), frame.foot(x, across)]
    if level is not None:
        parts.append(f'<path class="grid" style="stroke:var(--soft)" d="M{x.start} {y(level):.1f}H{x.end}"/>')
    parts += [_curve(line, x, y) for line in lines]
    names = ", ".join(line.name for line in lines if line.name)
    return Html(frame.svg(*parts, words=f"{up or names} over {across}" if up or names else across))


def _curve(line: Curve, x: Scale, y: Scale) -> str:
    parts = []
    if line.low:
        upper = [f"{x(a):.1f} {y(b):.1f}" for a, b in zip(line.x, line.high, strict=True)]
        lower = [f"{x(a):.1f} {y(b):.1f}" for a, b in zip(line.x, line.low, strict=True)]
        parts.append(
            f'<path class="band" d="M{"L".join([*upper, *reversed(lower)])}Z" fill="{line.colour}"/>'
        )
    if line.dots:
        parts += [
            f'<circle cx="{x(a):.1f}" cy="{y(b):.1f}" r="2.6" fill="{line.colour}" opacity=".65"/>'
            for a, b in zip(line.x, line.y, strict=True)
        ]
        return "".join(parts)
    middle = "L".join(f"{x(a):.1f} {y(b):.1f}" for a, b in zip(line.x, line.y, strict=True))
    title = f"<title>{text(line.name)}</title>"
    return "".join(parts) + f'<path class="line" d="M{middle}" stroke="{line.colour}">{title}</path>'


def share_bar(share: float, colour: str = SERIES[0], most: float = 1.0) -> Html:
    """A share as a bar on its track."""
    width = 300 * min(max(share / most, 0.0), 1.0)
    return Html(
        '<svg viewBox="0 0 300 14" class="bar" preserveAspectRatio="none" aria-hidden="true">'
        '<rect width="300" height="14" fill="var(--bar)"/>'
        f'<rect width="{width:.1f}" height="14" fill="{colour}" opacity=".88"/></svg>'
    )


def interval_bar(share: float, low: float, high: float, colour: str = SERIES[0]) -> Html:
    """A share from 0 to 1 as a bar on its track, its interval as a line across the bar's end."""
    left, width = 300 * low, max(300 * (high - low), 0.5)
    return Html(
        '<svg viewBox="0 0 300 14" class="bar" preserveAspectRatio="none" aria-hidden="true">'
        '<rect width="300" height="14" fill="var(--bar)"/>'
        f'<rect width="{300 * share:.1f}" height="14" fill="{colour}" opacity=".85"/>'
        f'<rect x="{left:.1f}" y="5.5" width="{width:.1f}" height="3" fill="var(--ink)" opacity=".75"/></svg>'
    )


def stacked_bar(parts: Sequence[tuple[float, str, str]]) -> Html:
    """Shares side by side: (share, colour, words under the pointer and for those who cannot see it)."""
    said = "; ".join(words for share, _, words in parts if share)
    x, drawn = 0.0, []
    for share, colour, words in parts:
        width = 300 * share
        drawn.append(
            f'<rect x="{x:.2f}" width="{width:.2f}" height="14" fill="{colour}"><title>{text(words)}</title></rect>'
        )
        x += width
    return Html(
        '<svg viewBox="0 0 300 14" class="bar" preserveAspectRatio="none" role="img" '
        f'aria-label="{text(said)}">{"".join(drawn)}</svg>'
    )


def key(entries: Sequence[tuple[str, str]]) -> Html:
    """What the colours mean: (colour, words)."""
    return Html(
        '<div class="key">'
        + "".join(
            f'<span><i style="background:{colour}"></i>{text(words)}</span>' for colour, words in entries
        )
        + "</div>"
    )
