"""What a JSON document must look like before anything is computed from it.

A checksum says that a file is what somebody wrote, not that it makes sense. A shape is written like an example of the
document: a mapping of the names it must have, a list of what every entry must be, a rule for a value.

>>> misshapen({"size": 3, "more": 1}, {"size": Whole(0, 9)})
>>> misshapen({"size": True}, {"size": Whole(0, 9)})
'size is not a whole number from 0 to 9'
"""

from __future__ import annotations

import re
from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

_LARGEST = 1e300


@dataclass(frozen=True)
class Whole:
    """A whole number from `least` to `most`, both included."""

    least: int
    most: int

    def __call__(self, value: Any) -> str | None:
        """What is wrong with the value, or None."""
        if type(value) is int and self.least <= value <= self.most:
            return None
        return f"is not a whole number from {self.least} to {self.most}"


@dataclass(frozen=True)
class Text:
    """Text of at most `most` letters, all of which match `pattern`."""

    pattern: str = r"(?s).*"
    most: int = 4096

    def __call__(self, value: Any) -> str | None:
        """What is wrong with the value, or None."""
        if isinstance(value, str) and len(value) <= self.most and re.fullmatch(self.pattern, value):
            return None
        return "is not text as it belongs there"


@dataclass(frozen=True)
class Numbers:
    """Numbers in nested lists of these lengths: ``Numbers(4, 4)`` is a matrix, ``Numbers()`` one number."""

    lengths: tuple[int, ...]

    def __init__(self, *lengths: int) -> None:
        object.__setattr__(self, "lengths", lengths)

    def __call__(self, value: Any) -> str | None:
        """What is wrong with the value, or None."""
        level = [value]
        for length in self.lengths:
            if not all(isinstance(row, list) and len(row) == length for row in level):
                return f"is not a list of {'x'.join(map(str, self.lengths))} numbers"
            level = [x for row in level for x in row]
        if all(type(x) in (float, int) and -_LARGEST <= x <= _LARGEST for x in level):
            return None
        return "is not a number" if not self.lengths else "holds what is not a number"


@dataclass(frozen=True)
class Maybe:
    """What the shape says, or null."""

    shape: Any


@dataclass(frozen=True)
class Each:
    """A mapping with any names of the pattern, those in `names` among them, all of whose values have one shape."""

    shape: Any
    names: tuple[str, ...] = ()
    pattern: str = r"(?s).*"


def mapping(value: Any) -> str | None:
    """A mapping, whatever is in it."""
    return None if isinstance(value, Mapping) else "is not a mapping"


def misshapen(value: Any, shape: Any, where: str = "") -> str | None:
    """Where and how a document differs from its shape; None if it has it. Names beyond the shape's are allowed.

    Parameters
    ----------
    value : Any
        Parsed JSON, whose depth was bounded.
    shape : Any
        A mapping, a list of one shape, `Each`, `Maybe`, or a rule: a callable that says what is wrong.
    where : str
        Dotted name of the value.
    """
    if isinstance(shape, Maybe):
        return None if value is None else misshapen(value, shape.shape, where)
    if isinstance(shape, Each):
        if not isinstance(value, Mapping):
            return _said(where, "is not a mapping")
        missing = next((name for name in shape.names if name not in value), None)
        if missing is not None:
            return _said(_join(where, missing), "is missing")
        odd = next((name for name in value if not re.fullmatch(shape.pattern, name)), None)
        if odd is not None:
            return _said(_join(where, odd), "is not a name as it belongs there")
        return _first((item, shape.shape, _join(where, str(name))) for name, item in value.items())
    if isinstance(shape, Mapping):
        if not isinstance(value, Mapping):
            return _said(where, "is not a mapping")
        missing = next((name for name in shape if name not in value), None)
        if missing is not None:
            return _said(_join(where, missing), "is missing")
        return _first((value[name], inner, _join(where, name)) for name, inner in shape.items())
    if isinstance(shape, list):
        if not isinstance(value, list):
            return _said(where, "is not a list")
        return _first((item, shape[0], f"{where}[{k}]") for k, item in enumerate(value))
    wrong = shape(value)
    return _said(where, wrong) if wrong else None


def _first(parts: Any) -> str | None:
    return next((wrong for part in parts if (wrong := misshapen(*part)) is not None), None)


def _join(where: str, name: str) -> str:
    return f"{where}.{name[:60]}" if where else name[:60]


def _said(where: str, wrong: str) -> str:
    return f"{where} {wrong}" if where else f"it {wrong}"
