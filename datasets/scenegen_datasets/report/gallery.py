"""The pictures of a report: moments with all their layers, flights that move, and what the colours mean."""

from __future__ import annotations

import base64
import io
from collections.abc import Sequence

import numpy as np
from PIL import Image

from scenegen.classes import CLASSES
from scenegen_datasets.pages.charts import key
from scenegen_datasets.pages.markup import Html, element, join, picture
from scenegen_datasets.pictures import colour
from scenegen_datasets.pictures.ramp import Ramp, depth_ramp, thermal_ramp
from scenegen_datasets.pictures.shot import Shot
from scenegen_datasets.report.depth_bar import css, depth_bar, sky_key
from scenegen_datasets.report.media import (
    FLIGHT_BYTES,
    Film,
    Tile,
    common_range,
    flight_within,
    tiles,
)
from scenegen_datasets.report.selection import Selection

SHEET = """
.moments{display:grid;grid-template-columns:repeat(var(--across),minmax(0,1fr));gap:0 24px}
.moment{margin:22px 0 0}
.moment .head,.flight .head{font-size:13px;margin:0 0 6px;color:var(--faint);max-width:none}
.moment b,.flight b{color:var(--ink);font-weight:600;margin-right:10px}
.tiles{display:grid;grid-template-columns:repeat(var(--layers),minmax(0,1fr));gap:8px}
.tiles img{width:100%}
.tiles .small,.flight .small{display:block;margin-top:4px;font-size:12px}
.ramp{display:flex;align-items:center;gap:6px;margin:4px 8px 0 0;font-size:12px;color:var(--faint);white-space:nowrap;
font-variant-numeric:tabular-nums}
.ramp i{flex:1;min-width:12px;height:7px;border-radius:2px;box-shadow:inset 0 0 0 1px var(--line)}
.flight .under{display:grid;grid-template-columns:repeat(var(--layers),minmax(0,1fr));gap:2px 8px;margin-top:6px}
.flight img{width:100%}
.scales .wheel{display:flex;gap:10px;align-items:center}
.scales .wheel img{width:44px;height:44px;border-radius:50%}
@media(max-width:760px){.moments{grid-template-columns:minmax(0,1fr)}
.tiles{grid-template-columns:repeat(6,minmax(0,1fr))}.tiles>div{grid-column:span 3}
.tiles.five>div:nth-child(n+3){grid-column:span 2}}
@media print,(max-width:760px){.ramp{flex-wrap:wrap;justify-content:space-between;gap:3px 6px;margin-right:0}
.ramp i{order:-1;flex:0 0 100%}}
@media print,(max-width:520px){.flight .ramp,.flight .small,.tiles .ramp,.tiles .small{font-size:10.5px}}
@media print{.moment,.flight{break-inside:avoid}.moment{margin-top:14px}}
"""
"""Of moments and flights."""

_WHEEL_PX = 88
_FEW_LAYERS = 2  # as many leave room for two moments side by side


def moments(selection: Selection) -> Html:
    """One row of tiles for each chosen moment, below the legend."""
    span_m = common_range(selection.moments)
    layers = max(len(shot.columns) for shot in selection.moments)
    rows = element(
        "div",
        *(_moment(shot, span_m) for shot in selection.moments),
        class_="moments",
        style=f"--across:{2 if layers <= _FEW_LAYERS else 1}",
    )
    return join([_legend(selection.moments, span_m), rows])


def flights(selection: Selection) -> Html:
    """The chosen flights, moving."""
    share = FLIGHT_BYTES // max(len(selection.flights), 1)
    cards = []
    for shots in selection.flights:
        film, clip = flight_within(shots, share), shots[0].name.rpartition("-")[0]
        parts = _head(clip, shots[0]), _moving(film, clip), _under(film)
        cards.append(element("div", *parts, class_="card flight"))
    return element("div", *cards, class_="cards", style="--least:520px")


def _moving(film: Film, clip: str) -> Html:
    """The film; its first frame on paper, and for those who asked their system for less motion."""
    still = base64.b64encode(film.still).decode("ascii")
    words = f"flight {clip}: {', '.join(film.layers)} side by side"
    return Html(
        '<picture><source media="(prefers-reduced-motion:reduce),print" '
        f'srcset="data:image/webp;base64,{still}">'
        + picture(film.data, "webp", words, film.width, film.height, loading="lazy")
        + "</picture>"
    )


def _under(film: Film) -> Html:
    """What the colours of a film mean, layer by layer."""
    scales = film.scales
    said = {
        "thermal": _ramp(thermal_ramp(scales.tone)),
        "depth": _ramp(depth_ramp(scales.span_m)),
        "flow": element("span", f"flow, full colour {scales.full_px:g}\u00a0px", class_="small"),
    }
    cells = [element("div", said[layer]) for layer in film.layers]
    return element("div", *cells, class_="under", style=f"--layers:{len(cells)}")


def _ramp(ramp: Ramp) -> Html:
    """A bar of colours between its two ends."""
    bar = element("i", style=f"background:{ramp.css}")
    return element("div", ramp.low, bar, ramp.high, class_="ramp")


def _tile(tile: Tile, shot: Shot) -> Html:
    shown = picture(
        tile.data, "webp", f"{tile.layer} of {shot.name}", tile.width, tile.height, loading="lazy"
    )
    return element(
        "div", shown, _ramp(tile.ramp) if tile.ramp else element("span", tile.words, class_="small")
    )


def _moment(shot: Shot, span_m: tuple[float, float]) -> Html:
    cells = [_tile(tile, shot) for tile in tiles(shot, span_m)]
    kind = "tiles five" if len(cells) == 5 else "tiles"
    grid = element("div", *cells, class_=kind, style=f"--layers:{len(cells)}")
    return element("div", _head(shot.name, shot), grid, class_="moment")


def _head(name: str, shot: Shot) -> Html:
    facts = (fact.replace("-", "−").replace(" ", "\u00a0") for fact in shot.facts.split("   "))
    return element("p", element("b", name), "\u00a0· ".join(facts), class_="head")


def _legend(shots: Sequence[Shot], span_m: tuple[float, float]) -> Html:
    wheel = element(
        "div",
        _wheel(),
        element("span", "flow to the next frame: direction and length", class_="small"),
        class_="wheel",
    )
    parts = [
        depth_bar(*span_m),
        sky_key(),
        *([wheel] if any(s.flow is not None for s in shots) else []),
    ]
    seen = sorted({int(k) for shot in shots if shot.semantic is not None for k in np.unique(shot.semantic)})
    classes = [(css(CLASSES[k].colour), CLASSES[k].name.replace("_", " ")) for k in seen if k]
    how = element(
        "p",
        "Thermal is white hot, under the gain of a camera (plateau equalisation), frame by frame: the bar below each "
        "picture is its scale, in brightness temperature. Depth has one scale for all moments.",
        class_="small",
    )
    return join([how, element("div", *parts, class_="scales"), key(classes) if classes else ""])


def _wheel() -> Html:
    axis = (np.arange(_WHEEL_PX) + 0.5) / _WHEEL_PX * 2 - 1
    u, v = np.meshgrid(axis, axis)
    image = colour.flow(np.stack([u, v], axis=-1).astype(np.float32), 1.0)
    file = io.BytesIO()
    Image.fromarray(image).save(file, "WEBP", lossless=True)
    return picture(file.getvalue(), "webp", "colour wheel of flow", _WHEEL_PX, _WHEEL_PX)
