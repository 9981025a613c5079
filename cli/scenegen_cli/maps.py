"""``scenegen maps``: the kinds of worlds."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

from scenegen_cli.listing import show


def run(arguments: Sequence[str]) -> int:
    """Run the subcommand; returns the exit code."""
    return show("maps", arguments, _rows, ("name", "description"))


def _rows() -> list[dict[str, Any]]:
    from scenegen.maps.registry import MAPS

    return [
        {
            "name": family.name,
            "description": family.description,
            "keys": {
                f"{family.name}.{key}": field.description for key, field in family.knobs.model_fields.items()
            },
        }
        for family in MAPS.values()
    ]
