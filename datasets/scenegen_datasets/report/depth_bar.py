"""The colours of distances over a logarithmic axis, for every page that shows depth."""

from __future__ import annotations

from scenegen_datasets.pages.axes import Frame, tick_words
from scenegen_datasets.pages.charts import key
from scenegen_datasets.pages.markup import Html, element, text
from scenegen_datasets.pictures import colour
from scenegen_datasets.pictures.ramp import depth_ticks

SHEET = """
.scales{display:flex;flex-wrap:wrap;gap:10px 34px;align-items:center;margin:14px 0 4px}
.scales>.depth{flex:0 1 360px;min-width:min(260px,100%)}
.scales>.key{margin:0}
"""
"""Of the row the bar stands in."""

_FRAME = Frame(width=360, height=32, left=1, right=1, top=2, bottom=21)
_BANDS = 16


def depth_bar(low_m: float, high_m: float) -> Html:
    """Near is bright, far is dark; both ends and the powers of ten between them are written out."""
    scale = _FRAME.across(low_m, high_m, log=True)
    ramp = colour.colormap()[::-1]
    stops = "".join(
        f'<stop offset="{k / _BANDS:.4f}" stop-color="{css(ramp[round(255 * k / _BANDS)].tolist())}"/>'
        for k in range(_BANDS + 1)
    )
    marks = [(scale(at), f"{tick_words(at)}\u00a0m") for at in depth_ticks(low_m, high_m)]
    anchors = ("start", *("middle",) * (len(marks) - 2), "end")
    ticks = "".join(
        f'<text style="text-anchor:{anchor}" x="{x:.1f}" y="26">{text(words)}</text>'
        for (x, words), anchor in zip(marks, anchors, strict=True)
    )
    drawn = (
        f'<svg viewBox="0 0 {_FRAME.width} {_FRAME.height}" role="img" '
        f'aria-label="colours of depth, {text(marks[0][1])} to {text(marks[-1][1])}">'
        f'<defs><linearGradient id="depth">{stops}</linearGradient></defs>'
        f'<rect x="{_FRAME.left}" y="{_FRAME.top}" width="{scale.end - scale.start:.0f}" height="9" rx="2" '
        f'fill="url(#depth)"/>{ticks}</svg>'
    )
    return element("div", Html(drawn), class_="depth")


def sky_key(words: str = "sky") -> Html:
    """The colour of what has no depth."""
    return key([(css(colour.SKY_COLOUR), words)])


def css(rgb: tuple[int, ...] | list[int]) -> str:
    """A colour as style sheets write it."""
    return f"rgb({rgb[0]},{rgb[1]},{rgb[2]})"
