"""Version numbers of data: MAJOR.MINOR.PATCH."""

from __future__ import annotations

import re
from dataclasses import dataclass
from enum import IntEnum

from scenegen.foundation.errors import InputError

_SEMVER = re.compile(r"(0|[1-9][0-9]{0,8})\.(0|[1-9][0-9]{0,8})\.(0|[1-9][0-9]{0,8})")

FIRST = "1.0.0"
"""Version of a dataset that was never released."""


class Bump(IntEnum):
    """How much changed, and which number of a version has to rise for it."""

    NONE = 0
    PATCH = 1
    """The same samples, stored or described in another way."""
    MINOR = 2
    """Something was added; every sample there was is what it was."""
    MAJOR = 3
    """A sample that was there is another one now, means something else, or is gone."""


@dataclass(frozen=True, order=True)
class Version:
    """A version without pre-release or build parts; versions compare as numbers."""

    major: int
    minor: int
    patch: int

    @classmethod
    def parse(cls, text: str) -> Version:
        """Read ``1.2.3``.

        Raises
        ------
        InputError
            If it is written in any other way.
        """
        match = _SEMVER.fullmatch(text)
        if match is None:
            raise InputError(f"version '{text[:40]}' is not MAJOR.MINOR.PATCH, such as 1.1.0")
        return cls(*(int(number) for number in match.groups()))

    def __str__(self) -> str:
        return f"{self.major}.{self.minor}.{self.patch}"

    def bumped(self, bump: Bump) -> Version:
        """Return the next version after a change of this size."""
        if bump is Bump.MAJOR:
            return Version(self.major + 1, 0, 0)
        if bump is Bump.MINOR:
            return Version(self.major, self.minor + 1, 0)
        return Version(self.major, self.minor, self.patch + (bump is Bump.PATCH))

    def step_to(self, later: Version) -> Bump:
        """Which number rises first on the way to `later`; `NONE` if that is not later."""
        if later <= self:
            return Bump.NONE
        if later.major > self.major:
            return Bump.MAJOR
        return Bump.MINOR if later.minor > self.minor else Bump.PATCH
