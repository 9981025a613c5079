"""Colours and small pieces all parts of the page share."""

from __future__ import annotations

from collections.abc import Mapping
from html import escape

from scenegen_trainers.campaign.statistics import Rate

END_COLOUR: Mapping[str, str] = {
    "goal": "#4fc3a1",
    "collision": "#ff5c5c",
    "timeout": "#e8b04a",
    "pilot": "#b18cf0",
}
END_WORDS: Mapping[str, str] = {
    "goal": "reached the goal",
    "collision": "collided",
    "timeout": "ran out of time",
    "pilot": "pilot failed",
}
PILOT_COLOUR = ("#7db7ff", "#ffb35c", "#4fc3a1", "#b18cf0")
"""Of the first pilot, the second, ..."""


def text(words: object) -> str:
    """Words safe between tags and in attributes."""
    return escape(str(words), quote=True)


def percent(rate: Rate, digits: int = 1) -> str:
    """A rate in per cent, or a dash."""
    return f"{100 * rate.share:.{digits}f} %" if rate.of else "-"


def interval(rate: Rate) -> str:
    """Its interval in per cent."""
    return f"{100 * rate.low:.1f} to {100 * rate.high:.1f} %"
