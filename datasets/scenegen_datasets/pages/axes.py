"""Axes: round ticks on even and logarithmic scales, and where a value stands in a chart."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass, replace

from scenegen_datasets.pages.markup import text

SUPERSCRIPT = str.maketrans("-0123456789", "⁻⁰¹²³⁴⁵⁶⁷⁸⁹")
"""For exponents."""


_LARGE_PX = 450  # what is wider gets larger letters on a narrow page
_UP_PX = 17


@dataclass(frozen=True)
class Scale:
    """From values to places.

    Attributes
    ----------
    low, high : float
        Values at both ends.
    start, end : float
        Their places [px]; `end` may lie before `start`.
    log : bool
    """

    low: float
    high: float
    start: float
    end: float
    log: bool = False

    def __call__(self, value: float) -> float:
        """Place of a value; beyond the ends it stays at the end."""
        inside = min(max(value, self.low), self.high)
        if self.log:
            share = math.log(inside / self.low) / math.log(self.high / self.low)
        else:
            share = (inside - self.low) / (self.high - self.low)
        return self.start + share * (self.end - self.start)

    def ticks(self, about: int = 5) -> list[float]:
        """Round values inside."""
        return log_ticks(self.low, self.high, about) if self.log else even_ticks(self.low, self.high, about)


def even_ticks(low: float, high: float, about: int = 5) -> list[float]:
    """Multiples of 1, 2 or 5 times a power of ten, `about` as many."""
    if not high > low:
        return [low]
    raw = (high - low) / max(about, 1)
    power = 10.0 ** math.floor(math.log10(raw))
    step = power * next(s for s in (1.0, 2.0, 5.0, 10.0) if raw <= s * power * (1 + 1e-9))
    first, last = math.ceil(low / step - 1e-9), math.floor(high / step + 1e-9)
    return [k * step for k in range(first, last + 1)]


def log_ticks(low: float, high: float, about: int = 5) -> list[float]:
    """Powers of ten, with 2 and 5 times them where the range is short."""
    decades = range(math.floor(math.log10(low)), math.ceil(math.log10(high)) + 1)
    few = [10.0**k for k in decades]
    many = [m * power for power in few for m in (1.0, 2.0, 5.0)]
    inside = [value for value in few if low * 0.999 <= value <= high * 1.001]
    if len(inside) < 3:
        return [value for value in many if low * 0.999 <= value <= high * 1.001]
    stride = math.ceil(len(inside) / max(about, 1))
    return inside[::stride]


def tick_words(value: float, log: bool = False) -> str:
    """A tick as it is written: 1 000 and 10⁻⁶ rather than 1e3 and 1e-06."""
    if value and log and not 1e-3 <= abs(value) < 1e5:
        return f"10{str(round(math.log10(value))).translate(SUPERSCRIPT)}"
    if abs(value) >= 1e4:
        return f"{value:,.0f}"
    return f"{round(value, 10):g}".replace("-", "−")


@dataclass(frozen=True)
class Frame:
    """Size and margins of a chart, and its axes as SVG.

    Attributes
    ----------
    width, height : int
    left, right, top, bottom : int
        Margins.
    """

    width: int = 360
    height: int = 190
    left: int = 40
    right: int = 12
    top: int = 12
    bottom: int = 38

    def across(self, low: float, high: float, log: bool = False) -> Scale:
        """Scale from left to right."""
        return Scale(low, high, self.left, self.width - self.right, log)

    def up(self, low: float, high: float, log: bool = False) -> Scale:
        """Scale from the foot to the top."""
        return Scale(low, high, self.height - self.bottom, self.top, log)

    def foot(self, scale: Scale, words: str) -> str:
        """Line, ticks and words of the axis below."""
        return self.marked_foot([(scale(v), tick_words(v, scale.log)) for v in scale.ticks(6)], words)

    def marked_foot(self, marks: Sequence[tuple[float, str]], words: str) -> str:
        """The same with ticks of one's own: (place [px], words)."""
        y = self.height - self.bottom
        ticks = "".join(
            f'<path class="grid" d="M{x:.1f} {y}v4"/><text class="x" x="{x:.1f}" y="{y + 16}">{text(tick)}</text>'
            for x, tick in marks
        )
        middle = (self.left + self.width - self.right) / 2
        return (
            f'<path class="grid" d="M{self.left} {y}H{self.width - self.right}"/>{ticks}'
            f'<text class="axis" x="{middle:.1f}" y="{self.height - 5}">{text(words)}</text>'
        )

    def side(self, scale: Scale, unit: str = "", about: int = 4) -> str:
        """Grid lines and ticks of the axis on the left."""
        return "".join(
            f'<path class="grid" d="M{self.left} {scale(v):.1f}H{self.width - self.right}"/>'
            f'<text class="y" x="{self.left - 6}" y="{scale(v) + 4:.1f}">'
            f"{text(tick_words(v, scale.log))}{text(unit)}</text>"
            for v in scale.ticks(about)
        )

    def upright(self, words: str) -> str:
        """Words of the axis on the left, level above it."""
        return f'<text class="up" x="2" y="15">{text(words)}</text>' if words else ""

    def under(self, words: str) -> Frame:
        """The same frame with room for these words above."""
        return replace(self, top=self.top + _UP_PX, height=self.height + _UP_PX) if words else self

    def svg(self, *parts: str, words: str) -> str:
        """The whole chart; `words` say what it shows to those who cannot see it."""
        inside = "".join(parts)
        kind = "large" if self.width > _LARGE_PX else "small"
        return (
            f'<svg viewBox="0 0 {self.width} {self.height}" class="{kind}" role="img" '
            f'aria-label="{text(words)}">{inside}</svg>'
        )
