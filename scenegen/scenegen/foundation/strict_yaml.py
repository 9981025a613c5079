"""YAML as a recipe needs it: plain data only, no surprises, one error that names file and line.

YAML 1.1 turns ``no`` into false, ``12:30:45`` into 45045 and ``017`` into 15, keeps the last of two equal keys, and
lets a 342-byte file of aliases grow to gigabytes once it is serialised. Here PyYAML only splits the text into events;
what a scalar means is decided below, near YAML 1.2's JSON schema: ``null``, ``true``, decimal numbers, text.
"""

from __future__ import annotations

import re
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import yaml

from scenegen.foundation.errors import InputError

MAX_BYTES = 1 << 20
MAX_DEPTH = 32
MAX_NODES = 20_000
MAX_DIGITS = 18

_NULL = re.compile(r"null|Null|NULL|~|")
_TRUE = re.compile(r"true|True|TRUE")
_FALSE = re.compile(r"false|False|FALSE")
_INTEGER = re.compile(r"[-+]?(?:0|[1-9][0-9]*)")
_REAL = re.compile(r"[-+]?(?:(?:0|[1-9][0-9]*)(?:\.[0-9]*)?|\.[0-9]+)(?:[eE][-+]?[0-9]+)?")
_INFINITE = re.compile(r"[-+]?\.(?:inf|Inf|INF)")
_NAN = re.compile(r"\.(?:nan|NaN|NAN)")

_PARSER = getattr(yaml, "CSafeLoader", yaml.SafeLoader)


def read_mapping(path: Path) -> dict[str, Any]:
    """Read a YAML file that must hold one mapping.

    Parameters
    ----------
    path : Path
        A regular file of at most 1 MiB.

    Returns
    -------
    dict
        Text keys; values are None, bool, int, float, str, lists and further mappings.

    Raises
    ------
    InputError
        If the file cannot be read or is not such a mapping; one line with file and line number.
    """
    try:
        if not path.is_file():
            what = (
                "is a directory" if path.is_dir() else "does not exist" if not path.exists() else "is no file"
            )
            raise InputError(f"{path}: {what}; give the path of a YAML file")
        with path.open("rb") as file:
            content = file.read(MAX_BYTES + 1)
    except InputError:
        raise
    except OSError as error:
        raise InputError(f"{path}: cannot be read: {error.strerror}") from None
    except ValueError as error:  # a NUL byte in the path
        raise InputError(f"{path!r}: is no usable path: {error}") from None
    return parse_mapping(content, str(path))


def parse_mapping(content: bytes | str, name: str) -> dict[str, Any]:
    """Parse YAML text that must hold one mapping; `name` stands for the file in errors.

    Raises
    ------
    InputError
        One line: file, line, what is wrong.
    """
    raw = content if isinstance(content, bytes) else content.encode("utf-8", "surrogatepass")
    if len(raw) > MAX_BYTES:
        raise InputError(f"{name}: larger than 1 MiB; a recipe is a few lines")
    try:
        text = raw.decode("utf-8-sig")
    except UnicodeDecodeError as error:
        raise InputError(f"{name}: is not UTF-8 text (byte {error.start})") from None
    reader = _Reader(text, name)
    try:
        return reader.document()
    except yaml.YAMLError as error:
        raise InputError(_one_line(error, name)) from None


def scalar(text: str) -> Any:
    """What an unquoted scalar means: None, bool, int, float or the text itself.

    Raises
    ------
    ValueError
        If it is a whole number of more digits than any key could want.
    """
    if _NULL.fullmatch(text):
        return None
    if _TRUE.fullmatch(text):
        return True
    if _FALSE.fullmatch(text):
        return False
    if _INTEGER.fullmatch(text):
        if len(text) > MAX_DIGITS:
            raise ValueError(f"a number of {len(text)} digits")
        return int(text)
    if _REAL.fullmatch(text):
        return float(text)
    if _INFINITE.fullmatch(text):
        return float("-inf") if text[0] == "-" else float("inf")
    return float("nan") if _NAN.fullmatch(text) else text


class _Reader:
    """Builds plain data from parser events, refusing everything a recipe has no use for."""

    def __init__(self, text: str, name: str) -> None:
        self._name = name
        self._nodes = 0
        self._events: Iterator[Any] = iter(yaml.parse(text, Loader=_PARSER))

    def document(self) -> dict[str, Any]:
        """Read the stream: exactly one document, exactly one mapping."""
        next(self._events)  # stream start
        start = next(self._events)
        if isinstance(start, yaml.StreamEndEvent):
            raise InputError(f"{self._name}: is empty; a recipe is a mapping of keys to values")
        first = next(self._events)
        if not isinstance(first, yaml.MappingStartEvent):
            raise self._error(first, "a recipe is a mapping (lines of 'key: value')")
        value = self._mapping(first, 1)
        next(self._events)  # document end
        after = next(self._events)
        if not isinstance(after, yaml.StreamEndEvent):
            raise self._error(after, "a second document ('---') has no meaning here")
        return value

    def _error(self, event: Any, what: str) -> InputError:
        return InputError(f"{self._name}:{event.start_mark.line + 1}: {' '.join(what.split())[:200]}")

    def _value(self, event: Any, depth: int) -> Any:
        self._nodes += 1
        if self._nodes > MAX_NODES:
            raise self._error(event, f"more than {MAX_NODES} values")
        if isinstance(event, yaml.AliasEvent):
            raise self._error(event, f"alias '*{event.anchor}': aliases are not read, write the value out")
        if event.anchor is not None:
            raise self._error(event, f"anchor '&{event.anchor}': anchors are not read, write the value out")
        if event.tag is not None:
            raise self._error(event, f"tag '{event.tag}': tags are not read, write the plain value")
        if depth > MAX_DEPTH:
            raise self._error(event, f"nested deeper than {MAX_DEPTH} levels")
        if isinstance(event, yaml.MappingStartEvent):
            return self._mapping(event, depth + 1)
        if isinstance(event, yaml.SequenceStartEvent):
            return self._sequence(depth + 1)
        return self._scalar(event)

    def _mapping(self, start: Any, depth: int) -> dict[str, Any]:
        if start.anchor is not None or start.tag is not None:
            raise self._error(start, "anchors and tags are not read")
        found: dict[str, Any] = {}
        while not isinstance(event := next(self._events), yaml.MappingEndEvent):
            if not isinstance(event, yaml.ScalarEvent):
                raise self._error(event, "a key is plain text")
            key = self._value(event, depth)
            if not isinstance(key, str):
                raise self._error(event, f"key '{event.value}': a key is text, not a number or empty")
            if key in found:
                raise self._error(event, f"duplicate key '{key}'")
            found[key] = self._value(next(self._events), depth)
        return found

    def _sequence(self, depth: int) -> list[Any]:
        found = []
        while not isinstance(event := next(self._events), yaml.SequenceEndEvent):
            found.append(self._value(event, depth))
        return found

    def _scalar(self, event: Any) -> Any:
        if event.style:  # quoted or block text stays text
            return event.value
        try:
            return scalar(event.value)
        except ValueError as error:
            raise self._error(event, str(error)) from None


def _one_line(error: yaml.YAMLError, name: str) -> str:
    mark = getattr(error, "problem_mark", None)
    where = f"{name}:{mark.line + 1}" if mark is not None else name
    problem = getattr(error, "problem", None) or getattr(error, "reason", None) or "unreadable"
    return f"{where}: is not YAML: {' '.join(str(problem).split())}"
