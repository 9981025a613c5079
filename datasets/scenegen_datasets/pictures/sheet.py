"""The contact sheet: one row per clip, one column per layer, every scale written out."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from PIL import Image

from scenegen.classes import CLASSES
from scenegen_datasets.pictures import colour
from scenegen_datasets.pictures.canvas import FAINT, Canvas
from scenegen_datasets.pictures.scales import TILE_PX, Tone, depth_range, flow_range, tile, tile_size
from scenegen_datasets.pictures.shot import Shot

MARGIN_PX = 20
GAP_PX = 8
HEAD_PX = 96
CAPTION_PX = 26
BAR_PX = 20
LEGEND_LINE_PX = 20


def contact_sheet(shots: Sequence[Shot], title: str, subtitle: str) -> Image.Image:
    """Draw the sheet.

    Parameters
    ----------
    shots : sequence of Shot
        One per row, all of one size and with the same layers.
    title, subtitle : str
        First line of the sheet.
    """
    columns, span_m = shots[0].columns, depth_range(shots)
    width = 2 * MARGIN_PX + len(columns) * TILE_PX + (len(columns) - 1) * GAP_PX
    row_px = CAPTION_PX + tile_size(shots[0].depth.shape)[1] + BAR_PX
    legend = _legend_lines(shots, width)
    foot = HEAD_PX + len(shots) * row_px
    canvas = Canvas(width, foot + 10 + LEGEND_LINE_PX * len(legend) + MARGIN_PX)
    _head(canvas, title, subtitle, columns, span_m)
    for k, shot in enumerate(shots):
        _row(canvas, HEAD_PX + k * row_px, shot, span_m)
    for k, line in enumerate(legend):
        _legend(canvas, foot + 22 + k * LEGEND_LINE_PX, line)
    return canvas.image


def _x(column: int) -> int:
    return MARGIN_PX + column * (TILE_PX + GAP_PX)


def _head(
    canvas: Canvas, title: str, subtitle: str, columns: Sequence[str], span_m: tuple[float, float]
) -> None:
    end = canvas.text(MARGIN_PX, 36, title, 20)
    canvas.text(end + 14, 36, subtitle, 13, FAINT)
    for column, name in enumerate(columns):
        canvas.text(_x(column), 74, name, 14)
        if name == "thermal":
            canvas.text(_x(column) + 62, 74, "white hot", 11, FAINT)
        elif name == "depth":
            canvas.depth_bar(_x(column) + 52, 64, TILE_PX - 72, *span_m)
        elif name == "flow":
            canvas.flow_wheel(_x(column) + 42, 54, 30)


def _row(canvas: Canvas, y: int, shot: Shot, span_m: tuple[float, float]) -> None:
    end = canvas.text(MARGIN_PX, y + 18, shot.name, 13)
    canvas.text(end + 12, y + 18, shot.facts, 13, FAINT)
    tone, full_px = Tone.of(shot), flow_range(shot)
    top = y + CAPTION_PX
    bar = top + tile_size(shot.depth.shape)[1] + 5
    for column, name in enumerate(shot.columns):
        canvas.picture(_x(column), top, tile(shot, name, tone, span_m, full_px))
        if name == "flow":
            canvas.text(_x(column) + TILE_PX, bar + 9, f"rim of the wheel: {full_px:g} px", 11, FAINT, "rs")
    canvas.tone_bar(_x(0), bar, TILE_PX, tone)


def _legend_lines(shots: Sequence[Shot], width: int) -> list[list[int]]:
    """Classes that occur, broken into lines that fit."""
    layers = [np.unique(shot.semantic) for shot in shots if shot.semantic is not None]
    ruler = Canvas(1, 1)
    lines: list[list[int]] = [[]]
    x = 0.0
    for number in np.unique(np.concatenate(layers)).tolist() if layers else []:
        need = ruler.width_of(CLASSES[number].name, 11) + 32
        if lines[-1] and x + need > width - 2 * MARGIN_PX:
            lines.append([])
            x = 0.0
        lines[-1].append(number)
        x += need
    return lines


def _legend(canvas: Canvas, y: int, line: Sequence[int]) -> None:
    x = float(MARGIN_PX)
    for number in line:
        fill = CLASSES[number].colour if number else colour.SKY_COLOUR
        canvas.swatch(int(x), y - 9, 10, fill)
        x = canvas.text(x + 15, y, CLASSES[number].name.replace("_", " "), 11, FAINT) + 17
