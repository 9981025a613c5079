"""A flight as an animated WebP: thermal, depth and flow side by side. Plays in any browser."""

from __future__ import annotations

import io
from collections.abc import Sequence

from PIL import Image

from scenegen_datasets.pictures.canvas import FAINT, Canvas
from scenegen_datasets.pictures.scales import TILE_PX, Tone, depth_range, flow_range, tile, tile_size
from scenegen_datasets.pictures.shot import Shot

FRAME_MS = 90
STRIP_PX = 26
GAP_PX = 6


def animate(shots: Sequence[Shot]) -> bytes:
    """Encode consecutive frames of one clip; one scale for all frames, so that nothing flickers.

    Returns
    -------
    bytes
        An animated WebP that loops for ever.
    """
    middle = shots[len(shots) // 2]
    scales = Tone.of(middle), depth_range(shots), flow_range(middle)
    frames = [_frame(shot, *scales) for shot in shots]
    file = io.BytesIO()
    frames[0].save(
        file, "WEBP", save_all=True, append_images=frames[1:], duration=FRAME_MS, loop=0, quality=82, method=4
    )
    return file.getvalue()


def _frame(shot: Shot, tone: Tone, span_m: tuple[float, float], full_px: float) -> Image.Image:
    words = {
        "thermal": f"thermal  {tone.low_K:.0f}-{tone.high_K:.0f} K",
        "depth": f"depth  {span_m[0]:g}-{span_m[1]:g} m",
        "flow": f"flow  up to {full_px:g} px",
    }
    columns = [name for name in shot.columns if name in words]
    width = len(columns) * TILE_PX + (len(columns) - 1) * GAP_PX
    canvas = Canvas(width, tile_size(shot.depth.shape)[1] + STRIP_PX)
    for k, name in enumerate(columns):
        canvas.picture(k * (TILE_PX + GAP_PX), STRIP_PX, tile(shot, name, tone, span_m, full_px))
        canvas.text(k * (TILE_PX + GAP_PX) + 4, 18, words[name], 12, FAINT)
    return canvas.image
