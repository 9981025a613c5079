"""Drawing in one style: dark ground, small light text, bars with their ends written out."""

from __future__ import annotations

import math
from functools import cache

import cv2
import numpy as np
from PIL import Image, ImageDraw, ImageFont

from scenegen_datasets.pictures import colour
from scenegen_datasets.pictures.ramp import depth_ticks
from scenegen_datasets.pictures.scales import Tone

GROUND = (16, 19, 24)
INK = (226, 230, 236)
FAINT = (134, 143, 156)


@cache
def font(size_px: int) -> ImageFont.FreeTypeFont | ImageFont.ImageFont:
    """Pillow's own font, so that no font file is needed."""
    return ImageFont.load_default(size_px)


class Canvas:
    """A picture to draw on.

    Parameters
    ----------
    width_px, height_px : int
    """

    def __init__(self, width_px: int, height_px: int) -> None:
        self.image = Image.new("RGB", (width_px, height_px), GROUND)
        self._draw = ImageDraw.Draw(self.image)

    def text(
        self,
        x: float,
        y: float,
        words: str,
        size_px: int = 13,
        ink: tuple[int, int, int] = INK,
        anchor: str = "ls",
    ) -> float:
        """Write at a baseline; returns where the text ends."""
        self._draw.text((x, y), words, fill=ink, font=font(size_px), anchor=anchor)
        return x + self.width_of(words, size_px)

    def width_of(self, words: str, size_px: int = 13) -> float:
        """Width [px] of a text."""
        return float(self._draw.textlength(words, font=font(size_px)))

    def picture(self, x: int, y: int, picture: colour.Picture) -> None:
        """Paste a picture at its upper left corner."""
        self.image.paste(Image.fromarray(picture), (x, y))

    def swatch(self, x: int, y: int, size_px: int, fill: tuple[int, int, int]) -> None:
        """A filled square."""
        self._draw.rectangle((x, y, x + size_px - 1, y + size_px - 1), fill=fill)

    def tone_bar(self, x: int, y: int, width_px: int, tone: Tone) -> None:
        """Bar of the greys a picture uses between its two temperatures, on one line with baseline `y` + 9."""
        left, right = f"{tone.low_K:.1f} K", f"{tone.high_K:.1f} K"
        start = math.ceil(self.text(x, y + 9, left, 11, FAINT)) + 6
        end = x + width_px - math.ceil(self.width_of(right, 11)) - 6
        self.text(end + 6, y + 9, right, 11, FAINT)
        ramp = tone.ramp(max(end - start, 2))
        self.picture(
            start, y + 1, np.ascontiguousarray(np.broadcast_to(ramp[None, :, None], (8, len(ramp), 3)))
        )

    def depth_bar(self, x: int, y: int, width_px: int, low_m: float, high_m: float) -> None:
        """Colour bar of distances with logarithmic ticks below and a swatch for the sky."""
        sky = math.ceil(self.width_of("sky", 11)) + 25
        length = width_px - sky
        ramp = np.repeat(colour.colormap()[::-1][None], 8, axis=0)
        self.picture(x, y + 1, np.asarray(cv2.resize(ramp, (length, 8), interpolation=cv2.INTER_LINEAR)))
        ticks = depth_ticks(low_m, high_m)
        for tick, anchor in zip(ticks, ("ls", *("ms",) * (len(ticks) - 2), "rs"), strict=True):
            place = x + length * math.log(tick / low_m) / math.log(high_m / low_m)
            self.text(place, y + 21, f"{tick:g} m", 11, FAINT, anchor)
        self.swatch(x + width_px - sky + 12, y + 1, 8, colour.SKY_COLOUR)
        self.text(x + width_px, y + 9, "sky", 11, FAINT, "rs")

    def flow_wheel(self, x: int, y: int, size_px: int) -> None:
        """Colour wheel of directions."""
        axis = (np.arange(size_px) + 0.5) / size_px * 2 - 1
        u, v = np.meshgrid(axis, axis)
        wheel = colour.flow(np.stack([u, v], axis=-1).astype(np.float32), 1.0)
        inside = np.clip((1.0 - np.hypot(u, v)) * size_px / 2 + 0.5, 0.0, 1.0)[..., None]
        mixed = inside * wheel + (1.0 - inside) * np.array(GROUND)
        self.picture(x, y, np.asarray(np.rint(mixed), np.uint8))
