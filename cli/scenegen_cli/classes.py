"""``scenegen classes``: the semantic classes, and what others call them."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

from scenegen_cli.listing import Listing, show

COLUMNS = ("id", "name", "kind", "colour", "cityscapes", "airsim")


@dataclass(frozen=True)
class Classes(Listing):
    """List the semantic classes, and what Cityscapes and AirSim call them."""


def run(arguments: Sequence[str]) -> int:
    """Run the subcommand; returns the exit code."""
    return show(Classes, "classes", arguments, _rows, COLUMNS)


def _rows() -> list[dict[str, Any]]:
    from scenegen.class_sets import AIRSIM, CITYSCAPES, CITYSCAPES_LABELS
    from scenegen.classes import CLASSES

    return [
        {
            "id": int(row.id),
            "name": row.name,
            "kind": "thing" if row.thing else "stuff",
            "colour": "#{:02x}{:02x}{:02x}".format(*row.colour),
            "cityscapes": f"{CITYSCAPES[row.id]} ({CITYSCAPES_LABELS[CITYSCAPES[row.id]]})",
            "airsim": AIRSIM[row.id],
        }
        for row in CLASSES
    ]
