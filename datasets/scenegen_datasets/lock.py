"""``recipe.lock.json``: everything that decided the data, resolved."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

VOLATILE_KEYS = ("pairs", "out", "jobs", "engine", "part")
"""Top-level recipe keys that do not change any sample, hence not part of ``recipe_id``."""


def recipe_id(recipe: Mapping[str, Any], scene_semantics: int) -> str:
    """SHA-256 of the canonical JSON of the resolved recipe without `VOLATILE_KEYS` and the scene semantics version."""
    raise NotImplementedError


def fingerprint(render: Mapping[str, str]) -> dict[str, str]:
    """Versions and CPU class that decide bytes: what the renderer says of itself, plus numpy, cv2, OpenEXR, CPU."""
    raise NotImplementedError


def fingerprint_id(fingerprint: Mapping[str, str]) -> str:
    """First 16 hexadecimal digits of the SHA-256 of the fingerprint."""
    raise NotImplementedError


def make_lock(
    recipe: Mapping[str, Any],
    *,
    name: str,
    scene_semantics: int,
    render: Mapping[str, str],
    git_sha: str | None = None,
) -> dict[str, Any]:
    """Compose the lock.

    Parameters
    ----------
    recipe : mapping
        The resolved recipe as plain data, every default in place; ``pairs`` at the top level.
    name : str
        Name of the dataset, e.g. ``city-256``.
    scene_semantics : int
        Version of the meaning of a recipe: raised whenever the same recipe gives other samples.
    render : mapping of str to str
        The renderer's own part of the fingerprint (mitsuba, drjit, LLVM, variant).
    git_sha : str or None
        Commit of the code, if it is known.
    """
    raise NotImplementedError
