"""Input, estimate and truth side by side, on one scale that is written out."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from PIL import Image

from scenegen_datasets.pictures import colour
from scenegen_datasets.pictures.canvas import FAINT, Canvas
from scenegen_trainers.evaluation.answers import Answer

MARGIN_PX, GAP_PX, HEAD_PX, CAPTION_PX, FOOT_PX = 16, 6, 58, 20, 40
NEAR_M = 2.0
"""Where the colour scale begins [m]; it ends at the cap."""

_COLUMNS = ("input", "estimate", "truth")


def answer_sheet(title: str, rows: Sequence[tuple[str, Answer]], cap_m: float) -> Image.Image:
    """Draw answers, one a row.

    Parameters
    ----------
    title : str
    rows : sequence of (str, Answer)
        Caption and what is shown; at least one.
    cap_m : float
        Depth [m] from which on everything is shown as sky.
    """
    high, wide = rows[0][1].truth_m.shape
    zoom = max(1, round(192 / wide))
    tile_w, tile_h = zoom * wide, zoom * high
    height = HEAD_PX + len(rows) * (tile_h + CAPTION_PX) + FOOT_PX
    canvas = Canvas(2 * MARGIN_PX + 3 * tile_w + 2 * GAP_PX, height)
    canvas.text(MARGIN_PX, 26, title, 16)
    for k, name in enumerate(_COLUMNS):
        canvas.text(MARGIN_PX + k * (tile_w + GAP_PX), 48, name, 12, FAINT)
    for k, (caption, answer) in enumerate(rows):
        y = HEAD_PX + k * (tile_h + CAPTION_PX)
        for column, picture in enumerate(_tiles(answer, cap_m)):
            large = np.repeat(np.repeat(picture, zoom, axis=0), zoom, axis=1)
            canvas.picture(MARGIN_PX + column * (tile_w + GAP_PX), y, np.ascontiguousarray(large))
        canvas.text(MARGIN_PX, y + tile_h + 14, caption, 11, FAINT)
    canvas.depth_bar(MARGIN_PX, height - 32, canvas.image.width - 2 * MARGIN_PX, NEAR_M, cap_m)
    return canvas.image


def _tiles(answer: Answer, cap_m: float) -> tuple[colour.Picture, colour.Picture, colour.Picture]:
    grey = np.repeat(answer.image[0][..., None], 3, axis=-1)
    return grey, _painted(answer.estimate_m, cap_m), _painted(answer.truth_m, cap_m)


def _painted(depth_m: np.ndarray, cap_m: float) -> colour.Picture:
    """Estimates stop just short of their cap; the last percent counts as sky."""
    shown = np.where(np.isfinite(depth_m) & (depth_m < 0.99 * cap_m), depth_m, np.inf).astype(np.float32)
    return colour.depth(np.maximum(shown, np.float32(NEAR_M)), NEAR_M, cap_m)
