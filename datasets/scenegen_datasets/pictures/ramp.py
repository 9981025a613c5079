"""Bars of colours between two values: what explains a picture, for pages that draw it themselves."""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np
from jaxtyping import UInt8

from scenegen_datasets.pictures.colour import colormap
from scenegen_datasets.pictures.scales import Tone

STOPS = 12
"""Colours of a bar; what is between them is interpolated by the browser."""


@dataclass(frozen=True)
class Ramp:
    """A bar of colours and what its two ends stand for.

    Attributes
    ----------
    low, high : str
        Values with their unit.
    colours : tuple of (red, green, blue)
        Evenly spaced, from `low` to `high`.
    """

    low: str
    high: str
    colours: tuple[tuple[int, ...], ...]

    @property
    def css(self) -> str:
        """The same as a value of CSS's ``background``."""
        stops = ",".join(f"rgb({r},{g},{b})" for r, g, b in self.colours)
        return f"linear-gradient(90deg,{stops})"


def ramp_of(low: str, high: str, colours: UInt8[np.ndarray, "colours 3"]) -> Ramp:
    """A bar from a row of colours."""
    return Ramp(low, high, tuple(tuple(map(int, colour)) for colour in colours.tolist()))


def thermal_ramp(tone: Tone) -> Ramp:
    """Greys of a gain between its two temperatures, evenly in counts."""
    greys = np.repeat(tone.ramp(STOPS)[:, None], 3, axis=1)
    return ramp_of(f"{tone.low_K:.1f}\u00a0K", f"{tone.high_K:.1f}\u00a0K", greys)


def depth_ramp(span_m: tuple[float, float]) -> Ramp:
    """Colours of distances, near first; logarithmic."""
    stops = np.linspace(255, 0, STOPS).round().astype(int)
    return ramp_of(f"{span_m[0]:g}\u00a0m", f"{span_m[1]:g}\u00a0m", colormap()[stops])


def depth_ticks(low_m: float, high_m: float) -> list[float]:
    """Both ends [m] and the powers of ten between them that leave room for their words."""
    decades = range(math.ceil(math.log10(low_m)), math.floor(math.log10(high_m)) + 1)
    between = [10.0**k for k in decades if low_m * 2.6 < 10.0**k < high_m / 2.6]
    return [low_m, *between, high_m]
