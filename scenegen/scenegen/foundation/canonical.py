"""Canonical JSON: one byte sequence per value, so that its SHA-256 names the value.

Keys sorted, no blanks, UTF-8, floats as the shortest text that reads back to the same double, no NaN or infinity.
Reading is bounded in size and depth before anything is built from it.
"""

from __future__ import annotations

import hashlib
import json
import math
from pathlib import Path
from typing import Any

from scenegen.foundation.errors import DatasetError

MAX_JSON_BYTES = 256 << 20
"""No file this project writes as one JSON document comes near it."""

MAX_VALUES = 4_000_000
"""Values in one document; each costs up to a hundred bytes of memory, however few it takes in the file."""

_MAX_DEPTH = 64


def canonical(value: Any) -> bytes:
    """Encode plain data (dict with string keys, list, tuple, str, int, float, bool, None) as canonical JSON.

    Raises
    ------
    ValueError
        For NaN or infinity.
    TypeError
        For anything that is not plain data, and for keys that are not strings.
    """
    _check_keys(value)
    text = json.dumps(value, sort_keys=True, separators=(",", ":"), ensure_ascii=False, allow_nan=False)
    return text.encode()


def pretty(value: Any) -> bytes:
    """Encode as `canonical` does, but indented for people, with a final newline; just as deterministic."""
    _check_keys(value)
    text = json.dumps(value, sort_keys=True, indent=2, ensure_ascii=False, allow_nan=False)
    return f"{text}\n".encode()


def digest(value: Any) -> str:
    """SHA-256 of the canonical JSON, in hexadecimal."""
    return hashlib.sha256(canonical(value)).hexdigest()


def parse(data: bytes, where: str, *, max_bytes: int = MAX_JSON_BYTES) -> Any:
    """Read JSON from untrusted bytes.

    Parameters
    ----------
    data : bytes
    where : str
        File or field named in the error.
    max_bytes : int
        Longer input is refused before it is parsed.

    Raises
    ------
    DatasetError
        If it is too long, too deeply nested, not UTF-8, not JSON, or holds a name twice, which readers understand
        differently, NaN, infinity (``1e999`` is one) or half a surrogate pair, which nothing could write again.
    """
    if len(data) > max_bytes:
        raise DatasetError(
            f"{where}: {len(data)} bytes of JSON, more than the {max_bytes} a sound file can have"
        )
    if data.count(b",") + data.count(b"[") + data.count(b"{") > MAX_VALUES:
        raise DatasetError(f"{where}: more than the {MAX_VALUES} values a sound file can have")
    try:
        text = data.decode()
        value = json.loads(
            text, parse_constant=_refuse_constant, parse_float=_finite, object_pairs_hook=_named_once
        )
        if "\\u" in text:
            json.dumps(value, ensure_ascii=False).encode()
    except RecursionError:
        raise DatasetError(f"{where}: JSON nested too deeply") from None
    except ValueError as error:
        raise DatasetError(f"{where}: not JSON ({error})") from None
    if _depth_exceeds(value, _MAX_DEPTH):
        raise DatasetError(f"{where}: JSON nested too deeply")
    return value


def read(path: Path, *, max_bytes: int = MAX_JSON_BYTES) -> Any:
    """Read a JSON file; the size is checked before the file is read. Errors as `parse`."""
    try:
        with path.open("rb") as file:
            return parse(file.read(max_bytes + 1), str(path), max_bytes=max_bytes)
    except FileNotFoundError:
        raise DatasetError(f"{path}: missing") from None


def _refuse_constant(name: str) -> float:
    raise ValueError(f"{name} is not a number this project writes")


def _named_once(pairs: list[tuple[str, Any]]) -> dict[str, Any]:
    found = dict(pairs)
    if len(found) != len(pairs):
        last = {name: k for k, (name, _) in enumerate(pairs)}
        twice = next(name for k, (name, _) in enumerate(pairs) if last[name] != k)
        raise ValueError(f"the name {twice[:60]!a} stands there twice")
    return found


def _finite(text: str) -> float:
    value = float(text)
    if not math.isfinite(value):
        raise ValueError(f"{text[:20]} is beyond any number this project writes")
    return value


def _depth_exceeds(value: Any, limit: int) -> bool:
    """Walk without recursion, so that the depth itself cannot hurt."""
    level = [value]
    for _ in range(limit):
        level = [
            child
            for node in level
            for child in (node.values() if isinstance(node, dict) else node if isinstance(node, list) else ())
            if isinstance(child, dict | list)
        ]
        if not level:
            return False
    return True


def _check_keys(value: Any) -> None:
    if isinstance(value, dict):
        for key, child in value.items():
            if not isinstance(key, str):
                raise TypeError(f"JSON keys are strings, not {type(key).__name__}: {key!r}")
            _check_keys(child)
    elif isinstance(value, list | tuple):
        for child in value:
            _check_keys(child)
