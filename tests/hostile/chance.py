"""What all mutants draw with."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np

Rng = np.random.Generator


def pick(rng: Rng, things: Any) -> Any:
    """One of several things."""
    return things[int(rng.integers(len(things)))]


def files(root: Path) -> list[str]:
    """Plain files of a dataset, sorted."""
    return sorted(str(p.relative_to(root)) for p in root.rglob("*") if p.is_file() and not p.is_symlink())
