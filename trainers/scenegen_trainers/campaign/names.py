"""Names of directories made of words: points of a sweep, pilots."""

from __future__ import annotations

import re

_SLUG = re.compile(r"[A-Za-z0-9][A-Za-z0-9._=+,-]{0,119}")


def slug(words: str) -> str:
    """Words as the name of a directory."""
    return re.sub(r"[^A-Za-z0-9._=+,-]+", "-", words).strip("-.+,=_")[:120] or "x"


def is_slug(name: str) -> bool:
    """Whether a directory may be called so."""
    return _SLUG.fullmatch(name) is not None
