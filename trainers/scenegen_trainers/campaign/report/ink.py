"""Colours and words all parts of the page share."""

from __future__ import annotations

from collections.abc import Mapping

from scenegen_datasets.pages.sheet import BAD, GOOD, NOTE, SERIES
from scenegen_trainers.campaign.statistics import Rate

END_COLOUR: Mapping[str, str] = {"goal": GOOD, "collision": BAD, "timeout": NOTE, "pilot": "var(--violet)"}
END_WORDS: Mapping[str, str] = {
    "goal": "reached the goal",
    "collision": "collided",
    "timeout": "ran out of time",
    "pilot": "pilot failed",
}
PILOT_COLOUR = SERIES
"""Of the first pilot, the second, ..."""


def percent(rate: Rate, digits: int = 1) -> str:
    """A rate in per cent, or a dash."""
    return f"{100 * rate.share:.{digits}f} %" if rate.of else "-"


def interval(rate: Rate) -> str:
    """Its interval in per cent."""
    return f"{100 * rate.low:.1f} to {100 * rate.high:.1f} %"
