"""Sixteen bits of thermal to eight, for formats that know no more.

One gain holds for a whole clip: a gain per frame would move the grey of a wall between two frames, and optical flow
and photometric losses would take that for motion. The mapping is a table over all counts, so that it can be written
beside the pictures and turned round.

``clip``    linear in counts between the 1st and 99th percentile of all pixels of the clip
``ground``  the same of pixels that show a surface: the cold sky is black and leaves the whole scale to the ground
``fixed``   linear in brightness temperature between two temperatures, the same for all clips
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

import numpy as np
from jaxtyping import Float64, UInt8, UInt16

from scenegen_datasets.exports.clip import Clip
from scenegen_datasets.exports.options import Options
from scenegen_datasets.layers import MAX_COUNT
from scenegen_datasets.scale import scale_of

LOW_SHARE, HIGH_SHARE = 0.01, 0.99
"""Shares of pixels that become black and white with a gain from percentiles."""

CLIPPED = "thermal_clipped"
"""Name of the count of pixels outside the gain's ends."""

CLIPPING = {CLIPPED: "thermal pixels beyond the gain became black or white"}
"""What that count means, for `scenegen_datasets.exports.format.Format.invalid`."""

CHOICES = frozenset({"gain", "gain_K"})
"""Options that a format with eight bits of thermal heeds."""


@dataclass(frozen=True, eq=False)
class Gain:
    """How counts become grey levels.

    Attributes
    ----------
    position : float64 (16384,)
        Grey level of every count before rounding and clipping: black is 0, white 255.
    facts : mapping
        How it was chosen, in plain data that allows to turn grey levels back: ``kind``, ``unit`` and the values of
        black and white in that unit.
    """

    position: Float64[np.ndarray, "counts"]
    facts: Mapping[str, Any]

    def grey(self, counts: UInt16[np.ndarray, "rows columns"]) -> UInt8[np.ndarray, "rows columns"]:
        """Grey levels of a frame."""
        return np.asarray(self._levels[counts])

    def clipped(self, counts: UInt16[np.ndarray, "rows columns"]) -> int:
        """Pixels whose value lies more than half a level beyond black or white."""
        return int(self._outside[counts].sum())

    def __post_init__(self) -> None:
        levels = np.clip(np.rint(self.position), 0, 255).astype(np.uint8)
        object.__setattr__(self, "_levels", levels)
        object.__setattr__(self, "_outside", (self.position < -0.5) | (self.position > 255.5))

    _levels: Any = None
    _outside: Any = None


def gain_of(clip: Clip, options: Options) -> Gain:
    """The gain of one clip; reads its thermal frames once unless it is fixed."""
    if options.gain == "fixed":
        return _fixed(clip, *options.gain_K)
    low, high = _percentiles(_histogram(clip, ground=options.gain == "ground"))
    position = (np.arange(MAX_COUNT + 1) - low) * (255.0 / (high - low))
    return Gain(position, {"kind": options.gain, "unit": "count", "black": low, "white": high})


def _fixed(clip: Clip, low_K: float, high_K: float) -> Gain:
    from scenegen_render.sensor.scale import counts_to_brightness_K

    table = counts_to_brightness_K(np.arange(MAX_COUNT + 1, dtype=np.uint16), scale_of(clip.facts))
    position = (table.astype(np.float64) - low_K) * (255.0 / (high_K - low_K))
    return Gain(position, {"kind": "fixed", "unit": "K", "black": low_K, "white": high_K})


def _histogram(clip: Clip, *, ground: bool) -> Float64[np.ndarray, "counts"]:
    """How often each count occurs in the clip; over all pixels if none of them shows a surface."""
    total = np.zeros(MAX_COUNT + 1)
    for picture in clip.pictures("thermal", "depth") if ground else clip.pictures("thermal"):
        counts = picture["thermal"]
        chosen = counts[np.isfinite(picture["depth"])] if ground else counts
        total += np.bincount(chosen.ravel(), minlength=MAX_COUNT + 1)
    return total if total.any() else _histogram(clip, ground=False)


def _percentiles(histogram: Float64[np.ndarray, "counts"]) -> tuple[int, int]:
    """Counts at both shares, at least one count apart."""
    below = np.cumsum(histogram) / histogram.sum()
    low = int(np.searchsorted(below, LOW_SHARE))
    high = int(np.searchsorted(below, HIGH_SHARE))
    return low, max(high, low + 1)
