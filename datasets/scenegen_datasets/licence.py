"""The licence of the data: an SPDX name, and how catalogues want to hear it."""

from __future__ import annotations

import re
from collections.abc import Mapping
from typing import Any

from scenegen.foundation.errors import DatasetError, InputError

DEFAULT = "CC-BY-4.0"
"""Everybody may use, change and share the data, and says where it comes from."""

KEY = "license"
"""Name in ``recipe.lock.json`` (where something else than the default was asked for) and in ``dataset.json``."""

_SPDX = re.compile(r"[A-Za-z0-9][A-Za-z0-9.+-]{0,63}")
_ON_THE_HUB = {
    "cc0-1.0",
    "cc-by-4.0",
    "cc-by-sa-4.0",
    "cc-by-nd-4.0",
    "cc-by-nc-4.0",
    "cc-by-nc-sa-4.0",
    "cc-by-nc-nd-4.0",
    "cdla-permissive-1.0",
    "cdla-permissive-2.0",
    "cdla-sharing-1.0",
    "odc-by",
    "odbl",
    "pddl",
    "apache-2.0",
    "mit",
    "bsd-3-clause",
    "unlicense",
}
"""Names the Hub knows, of licences for data and code."""


def checked_licence(name: str) -> str:
    """Return the name.

    Raises
    ------
    InputError
        If it cannot be an SPDX identifier.
    """
    if not _SPDX.fullmatch(name):
        raise InputError(f"--license {name!r}: name a licence as SPDX does, such as {DEFAULT} or CC0-1.0")
    return name


def licence_of(told: Mapping[str, Any]) -> str:
    """The licence a lock or a ``dataset.json`` names; the default where it names none.

    Raises
    ------
    DatasetError
        If it cannot be an SPDX identifier: it stands in the header of the card, where a line end begins another key.
    """
    name = told.get(KEY, DEFAULT)
    if not isinstance(name, str) or not _SPDX.fullmatch(name):
        raise DatasetError(f"{KEY} {str(name)[:40]!a}: not the name of a licence; restore it from a copy")
    return name


def hub_lines(name: str) -> list[str]:
    """Lines of the YAML header that Hugging Face reads."""
    known = name.lower()
    return [f"license: {known}"] if known in _ON_THE_HUB else ["license: other", f"license_name: {known}"]


def licence_url(name: str) -> str:
    """Where its text stands."""
    return f"https://spdx.org/licenses/{name}.html"
