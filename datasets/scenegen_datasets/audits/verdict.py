"""What an audit concludes, in words that need no glossary."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Literal

Level = Literal["fine", "note", "fault", "skipped"]


@dataclass(frozen=True)
class Verdict:
    """The conclusion of an audit.

    Attributes
    ----------
    level : {"fine", "note", "fault", "skipped"}
        `note` is worth knowing before training, `fault` says that the data are not what they should be, `skipped`
        that they do not hold what the audit needs.
    headline : str
        One sentence.
    words : str
        What it was concluded from.
    """

    level: Level
    headline: str
    words: str = ""


def skipped(why: str) -> Verdict:
    """The verdict of an audit that could not be made."""
    return Verdict("skipped", why)
