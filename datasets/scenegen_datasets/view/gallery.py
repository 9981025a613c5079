"""Every picture the page can show: a pure function of clip, frame, layer and tone, so that a browser may keep it."""

from __future__ import annotations

from dataclasses import dataclass
from functools import lru_cache
from typing import Any, get_args
from urllib.parse import urlencode

import cv2

from scenegen.foundation.errors import InputError, nearest
from scenegen_datasets.view.library import Library
from scenegen_datasets.view.panels import PALETTES, Gain, Palette, Panel, Ranges, drawable, panel

ROUTE = "/picture"


@dataclass(frozen=True)
class Tone:
    """How the thermal picture is drawn: gain control and palette."""

    gain: Gain = "plateau"
    palette: Palette = "white hot"


class Gallery:
    """Draws the frames of a library.

    Parameters
    ----------
    library : Library
    """

    def __init__(self, library: Library) -> None:
        self.library = library
        self.layers = drawable(library.layers)
        self._ranges = lru_cache(maxsize=64)(self._ranges_of)
        # The page asks for a caption, then the browser for the picture above it.
        self._drawn = lru_cache(maxsize=32)(self._draw)

    def panel(self, clip: int, frame: int, layer: str, tone: Tone) -> Panel:
        """One layer of a frame, in colours that mean the same in all frames of its clip."""
        return self._drawn(clip, frame, layer, tone)

    def png(self, clip: int, frame: int, layer: str, tone: Tone) -> bytes:
        """The same as a file."""
        picture = self.panel(clip, frame, layer, tone).picture
        done, data = cv2.imencode(".png", picture[..., ::-1], [cv2.IMWRITE_PNG_COMPRESSION, 1])
        assert done
        return bytes(data)

    @staticmethod
    def address(clip: int, frame: int, layer: str, tone: Tone) -> str:
        """Where the page finds a picture."""
        asked = {"clip": clip, "frame": frame, "layer": layer, "gain": tone.gain, "palette": tone.palette}
        return f"{ROUTE}?{urlencode(asked)}"

    def asked(self, clip: int, frame: int, layer: str, gain: Any, palette: Any) -> bytes:
        """Answer an address.

        Raises
        ------
        InputError
            If there is no such picture.
        """
        clips = self.library.clips
        if not (0 <= clip < len(clips) and 0 <= frame < clips[clip].frames):
            raise InputError(f"no frame {frame} of clip {clip}")
        for word, known in ((layer, self.layers), (gain, get_args(Gain)), (palette, PALETTES)):
            if word not in known:
                raise InputError(f"no picture '{word}'{nearest(str(word), known)}")
        return self.png(clip, frame, layer, Tone(gain, palette))

    def _draw(self, clip: int, frame: int, layer: str, tone: Tone) -> Panel:
        return panel(self.library.still(clip, frame), layer, self._ranges(clip), tone.gain, tone.palette)

    def _ranges_of(self, clip: int) -> Ranges:
        last = self.library.clips[clip].frames - 1
        return Ranges.of([self.library.still(clip, frame) for frame in sorted({0, last // 2, last})])
