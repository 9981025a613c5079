"""``scenegen info``: what a dataset holds."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import asdict, dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import tyro

from scenegen_cli.console import say, say_json, size, table
from scenegen_cli.parse import HelpShown, parse

if TYPE_CHECKING:
    from scenegen_datasets.info import DatasetInfo


@dataclass(frozen=True)
class Info:
    """Say what a dataset holds: pairs, splits, hours, weather, ids."""

    dataset: Annotated[Path, tyro.conf.Positional]
    """Directory of the dataset."""
    json: bool = False
    """Report as JSON."""


def run(arguments: Sequence[str]) -> int:
    """Run the subcommand; returns the exit code."""
    try:
        command = parse(Info, "info", arguments)
    except HelpShown:
        return 0
    from scenegen_datasets.info import info

    found = info(command.dataset)
    if command.json:
        say_json(asdict(found))
        return 0
    say(table(_rows(found)))
    return 0


def _rows(found: DatasetInfo) -> list[tuple[str, str]]:
    planned = found.pairs_planned
    state = "complete" if found.complete else f"growing, {planned or '?'} pairs planned"
    if found.missing:
        state = f"finished without {len(found.missing)} clips: {', '.join(found.missing[:3])}"
    rows = [
        ("name", f"{found.name} {found.version}".strip()),
        ("state", state),
        (
            "pairs",
            f"{found.pairs:,} in {found.clips:,} clips of {found.worlds:,} worlds ({found.frames:,} frames)",
        ),
        ("splits", ", ".join(f"{name} {count:,}" for name, count in found.splits.items())),
        ("size", size(found.bytes)),
    ]
    rows += [(name, f"{low:.4g} to {high:.4g}") for name, (low, high) in found.ranges.items()]
    rows += [("recipe id", found.recipe_id), ("content id", found.content_id or "none while it grows")]
    return rows
