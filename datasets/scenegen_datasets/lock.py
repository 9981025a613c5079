"""``recipe.lock.json``: everything that decided the data, resolved."""

from __future__ import annotations

import platform
from collections.abc import Mapping
from importlib.metadata import PackageNotFoundError, version
from typing import Any

from scenegen.foundation import cpu
from scenegen.foundation.canonical import digest
from scenegen_datasets.licence import KEY

VOLATILE_KEYS = ("pairs", "out", "jobs", "engine", "part")
"""Top-level recipe keys that do not change any sample, hence not part of ``recipe_id``."""

SOURCE = "source"
"""Name in the lock of a sensed dataset for that of the dataset it was sensed from, as far as it decides samples."""

_PACKAGES = {
    "numpy": "numpy",
    "cv2": "opencv-python-headless",
    "OpenEXR": "OpenEXR",
    "scipy": "scipy",
    "pvlib": "pvlib",
    "shapely": "shapely",
}
"""What takes part in making bytes, besides the renderer: arrays, codecs, sun, geometry."""


def recipe_id(recipe: Mapping[str, Any], scene_semantics: int) -> str:
    """SHA-256 of the canonical JSON of the resolved recipe without `VOLATILE_KEYS` and the scene semantics version."""
    return digest({"recipe": stable(recipe), "scene_semantics": scene_semantics})


def stable(recipe: Mapping[str, Any]) -> dict[str, Any]:
    """Return the part of a recipe that decides samples."""
    return {key: value for key, value in recipe.items() if key not in VOLATILE_KEYS}


def fingerprint(render: Mapping[str, str]) -> dict[str, str]:
    """Versions and CPU class that decide bytes: what the renderer says of itself, our libraries, the CPU."""
    return {**render, **{name: _version(package) for name, package in _PACKAGES.items()}, "cpu": cpu.level()}


def fingerprint_id(fingerprint: Mapping[str, str]) -> str:
    """First 16 hexadecimal digits of the SHA-256 of the fingerprint."""
    return digest(dict(fingerprint))[:16]


def make_lock(
    recipe: Mapping[str, Any],
    *,
    name: str,
    scene_semantics: int,
    render: Mapping[str, str],
    git_sha: str | None = None,
    license: str | None = None,
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
    license : str or None
        Of the data, if another than the default was asked for.
    """
    prints = fingerprint(render)
    return {
        "name": name,
        "recipe": {k: v for k, v in recipe.items() if k == "pairs" or k not in VOLATILE_KEYS},
        "recipe_id": recipe_id(recipe, scene_semantics),
        "scene_semantics": scene_semantics,
        "fingerprint": prints,
        "fingerprint_id": fingerprint_id(prints),
        "mixed_with": [],
        "software": {"thermal-scenegen": _version("thermal-scenegen"), "python": platform.python_version()},
        "git_sha": git_sha,
        **({} if license is None else {KEY: license}),
    }


def _version(package: str) -> str:
    try:
        return version(package)
    except PackageNotFoundError:
        return "unknown"
