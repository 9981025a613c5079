"""Input, estimate, truth and error side by side, on scales that are written out."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from jaxtyping import Float32, UInt8
from PIL import Image

from scenegen_datasets.pictures import colour
from scenegen_datasets.pictures.canvas import FAINT, Canvas
from scenegen_trainers.evaluation.answers import Answer

MARGIN_PX, GAP_PX, HEAD_PX, CAPTION_PX, FOOT_PX = 16, 6, 58, 20, 60
NEAR_M = 2.0
"""Where the colour scale begins [m]; it ends at the cap."""

WORST_RATIO = 2.0
"""Estimate over truth, or truth over estimate, at which the colour of an error is full."""

TOO_NEAR, RIGHT, TOO_FAR = (61, 134, 230), (24, 28, 35), (240, 84, 60)
"""Colours of errors: to take something for farther than it is makes a drone crash."""

COLUMNS = ("input", "estimate", "truth", "error")


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
    canvas = Canvas(2 * MARGIN_PX + len(COLUMNS) * (tile_w + GAP_PX) - GAP_PX, height)
    canvas.text(MARGIN_PX, 26, title, 16)
    for k, name in enumerate(COLUMNS):
        canvas.text(MARGIN_PX + k * (tile_w + GAP_PX), 48, name, 12, FAINT)
    for k, (caption, answer) in enumerate(rows):
        y = HEAD_PX + k * (tile_h + CAPTION_PX)
        for column, picture in enumerate(tiles(answer, cap_m)):
            canvas.picture(MARGIN_PX + column * (tile_w + GAP_PX), y, enlarged(picture, zoom))
        canvas.text(MARGIN_PX, y + tile_h + 14, caption, 11, FAINT)
    canvas.depth_bar(MARGIN_PX, height - 52, canvas.image.width - 2 * MARGIN_PX, NEAR_M, cap_m)
    _error_key(canvas, MARGIN_PX, height - 10)
    return canvas.image


def tiles(answer: Answer, cap_m: float) -> tuple[colour.Picture, ...]:
    """The four pictures of an answer, in the order of `COLUMNS`, pixel by pixel."""
    grey = np.repeat(answer.image[0][..., None], 3, axis=-1)
    depths = (_painted(depth_m, cap_m) for depth_m in (answer.estimate_m, answer.truth_m))
    return grey, *depths, error(answer.estimate_m, answer.truth_m, cap_m)


def enlarged(picture: colour.Picture, zoom: int) -> UInt8[np.ndarray, "more_rows more_columns 3"]:
    """Every pixel as a square of `zoom` x `zoom`."""
    return np.ascontiguousarray(np.repeat(np.repeat(picture, zoom, axis=0), zoom, axis=1))


def error(
    estimate_m: Float32[np.ndarray, "rows columns"],
    truth_m: Float32[np.ndarray, "rows columns"],
    cap_m: float,
) -> colour.Picture:
    """Estimate over truth as colour, both cut at the cap: dark where right, blue too near, red too far.

    The scale is logarithmic and full at a factor of `WORST_RATIO`. A pixel without an answer is painted white.
    """
    known = np.isfinite(estimate_m)
    estimate = np.clip(np.where(known, estimate_m, cap_m), 1e-3, cap_m)
    share = np.log(estimate / np.minimum(truth_m, cap_m)) / np.log(WORST_RATIO)
    full = np.where((share > 0.0)[..., None], np.array(TOO_FAR), np.array(TOO_NEAR))
    weight = np.clip(np.abs(share), 0.0, 1.0)[..., None]
    mixed = np.rint((1.0 - weight) * np.array(RIGHT) + weight * full)
    return np.where(known[..., None], mixed, 255.0).astype(np.uint8)


def _error_key(canvas: Canvas, x: float, y: int) -> None:
    words = (
        (TOO_NEAR, f"{WORST_RATIO:g} times too near"),
        (RIGHT, "right"),
        (TOO_FAR, f"{WORST_RATIO:g} times too far"),
    )
    for fill, said in words:
        canvas.swatch(int(x), y - 9, 9, (134, 143, 156))
        canvas.swatch(int(x) + 1, y - 8, 7, fill)
        x = canvas.text(x + 15, y, said, 11, FAINT) + 18


def _painted(depth_m: Float32[np.ndarray, "rows columns"], cap_m: float) -> colour.Picture:
    """Estimates stop just short of their cap; the last percent counts as sky."""
    shown = np.where(np.isfinite(depth_m) & (depth_m < 0.99 * cap_m), depth_m, np.inf).astype(np.float32)
    return colour.depth(np.maximum(shown, np.float32(NEAR_M)), NEAR_M, cap_m)
