"""Where modules of a user's own are looked for."""

from __future__ import annotations

import sys
from pathlib import Path


def find_modules_here(path: str = "") -> None:
    """Look for plug-ins in the user's own directory too, last of all."""
    here = path or str(Path.cwd())
    if here not in sys.path:
        sys.path.append(here)
