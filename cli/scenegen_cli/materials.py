"""``scenegen materials``: the material table."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import asdict, dataclass
from typing import Any

from scenegen_cli.listing import Listing, show

COLUMNS = ("id", "name", "emissivity", "solar_absorptance", "thickness_m", "build", "source")


@dataclass(frozen=True)
class Materials(Listing):
    """List the materials with their thermal and optical properties, and where each row is from."""


def run(arguments: Sequence[str]) -> int:
    """Run the subcommand; returns the exit code."""
    return show(Materials, "materials", arguments, _rows, COLUMNS)


def _rows() -> list[dict[str, Any]]:
    from scenegen.materials.table import materials

    return [
        {
            key: None if isinstance(value, float) and not math.isfinite(value) else value
            for key, value in row.items()
        }
        for row in (asdict(material) for material in materials().values())
    ]
