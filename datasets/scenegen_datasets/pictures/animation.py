"""A flight as an animated WebP: thermal, depth and flow side by side. Plays in any browser."""

from __future__ import annotations

import io
from collections.abc import Sequence
from dataclasses import dataclass

from PIL import Image

from scenegen_datasets.pictures.canvas import FAINT, Canvas
from scenegen_datasets.pictures.scales import TILE_PX, Tone, depth_range, flow_range, tile, tile_size
from scenegen_datasets.pictures.shot import Shot

FRAME_MS = 90
STRIP_PX = 26
GAP_PX = 6


@dataclass(frozen=True, eq=False)
class Scales:
    """What the colours of a flight mean, the same in all its frames, so that nothing flickers.

    Attributes
    ----------
    tone : Tone
    span_m : (float, float)
        Depths at both ends of the colours [m].
    full_px : float
        Flow at full colour [px].
    """

    tone: Tone
    span_m: tuple[float, float]
    full_px: float

    @classmethod
    def of(cls, shots: Sequence[Shot]) -> Scales:
        """Of consecutive frames: tone and flow by the one in the middle."""
        middle = shots[len(shots) // 2]
        return cls(Tone.of(middle), depth_range(shots), flow_range(middle))


def animate(shots: Sequence[Shot], *, words: bool = True) -> bytes:
    """Encode consecutive frames of one clip.

    Parameters
    ----------
    shots : sequence of Shot
    words : bool
        Write above each layer what its colours mean.

    Returns
    -------
    bytes
        An animated WebP that loops for ever.
    """
    scales = Scales.of(shots)
    frames = [flight_frame(shot, scales, words=words) for shot in shots]
    file = io.BytesIO()
    frames[0].save(
        file, "WEBP", save_all=True, append_images=frames[1:], duration=FRAME_MS, loop=0, quality=82, method=4
    )
    return file.getvalue()


def shown_layers(shot: Shot) -> tuple[str, ...]:
    """Layers of an animated flight, from left to right."""
    return tuple(name for name in shot.columns if name in ("thermal", "depth", "flow"))


def flight_frame(shot: Shot, scales: Scales, *, words: bool = True) -> Image.Image:
    """One frame of a flight: its layers side by side."""
    tone, (near_m, far_m) = scales.tone, scales.span_m
    said = {
        "thermal": f"thermal  {tone.low_K:.0f}-{tone.high_K:.0f} K",
        "depth": f"depth  {near_m:g}-{far_m:g} m",
        "flow": f"flow  up to {scales.full_px:g} px",
    }
    columns, top = shown_layers(shot), STRIP_PX if words else 0
    width = len(columns) * TILE_PX + (len(columns) - 1) * GAP_PX
    canvas = Canvas(width, tile_size(shot.depth.shape)[1] + top)
    for k, name in enumerate(columns):
        x = k * (TILE_PX + GAP_PX)
        canvas.picture(x, top, tile(shot, name, tone, scales.span_m, scales.full_px))
        if words:
            canvas.text(x + 4, 18, said[name], 12, FAINT)
    return canvas.image
