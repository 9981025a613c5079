"""A dataset directory: made, opened again, grown."""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path
from typing import Any


def create_or_open(
    root: Path, recipe_yaml: str, lock: Mapping[str, Any], *, allow_mixed: bool = False
) -> None:
    """Make a new dataset directory or open one to resume or to grow it. Call it with the `DirectoryLock` held.

    Raises
    ------
    InputError
        If `root` holds something that is not a dataset, or a dataset of another recipe (the differing keys are named
        with both values), of more pairs, or of another render fingerprint (unless `allow_mixed`); if it or one of
        our names in it is a symbolic link, or cannot be written.
    """
    raise NotImplementedError


def finished(root: Path) -> set[str]:
    """Names of the clips whose receipt is sound and whose shard has the right size; the rest is to be done."""
    raise NotImplementedError
