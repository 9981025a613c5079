"""``scenegen info``: what a dataset holds."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import asdict, dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import tyro

from scenegen.foundation.words import counted, size
from scenegen_cli.console import say, say_json, table
from scenegen_cli.parse import parse

if TYPE_CHECKING:
    from scenegen_datasets.info import DatasetInfo

_UNITS = {"m": "m", "km": "km", "deg": "deg", "mps": "m/s", "K": "K"}


@dataclass(frozen=True)
class Info:
    """Say what a dataset holds: pairs, splits, hours, weather, ids."""

    dataset: Annotated[Path, tyro.conf.Positional]
    """Directory of the dataset."""
    json: bool = False
    """Report as JSON."""


def run(arguments: Sequence[str]) -> int:
    """Run the subcommand; returns the exit code."""
    command = parse(Info, "info", arguments)
    from scenegen_datasets.info import info

    found = info(command.dataset)
    if command.json:
        say_json(asdict(found))
        return 0
    say(table(_rows(found)))
    return 0


def _rows(found: DatasetInfo) -> list[tuple[str, str]]:
    rows = [
        ("name", f"{found.name} {found.version}".strip()),
        ("state", _state(found)),
        (
            "pairs",
            f"{found.pairs:,} in {counted(found.clips, 'clip')} of {counted(found.worlds, 'world')} "
            f"({found.frames:,} frames)",
        ),
        ("splits", ", ".join(f"{name} {count:,}" for name, count in found.splits.items())),
        *_listed("held out", found.held_out or ("nothing but worlds",)),
        *_listed("merged of", found.parts),
        ("maps", ", ".join(found.maps) or "-"),
        ("image", _image(found)),
        ("layers", ", ".join(found.layers) or "-"),
        ("size", size(found.bytes)),
        ("licence", found.license),
    ]
    rows += [_range(name, *span) for name, span in found.ranges.items()]
    rows += [("recipe id", found.recipe_id), ("content id", found.content_id or "none while it grows")]
    return rows


def _state(found: DatasetInfo) -> str:
    if found.missing:
        named = ", ".join(found.missing[:3]) + (", ..." if len(found.missing) > 3 else "")
        return f"finished without {len(found.missing)} of its clips: {named}"
    if found.complete:
        return "complete"
    return f"growing, {'?' if found.pairs_planned is None else f'{found.pairs_planned:,}'} pairs planned"


def _listed(name: str, lines: Sequence[str]) -> list[tuple[str, str]]:
    return [(name if k == 0 else "", line.replace("`", "")) for k, line in enumerate(lines)]


def _image(found: DatasetInfo) -> str:
    if found.grid_px is None or found.band_um is None:
        return "-"
    return "{}x{} px, {:g} to {:g} um".format(*found.grid_px, *found.band_um)


def _range(name: str, low: float, high: float) -> tuple[str, str]:
    """A quantity under a name for people, its unit after the numbers: ``air_mean_K`` is ``air mean``, in K."""
    words, _, unit = name.removeprefix("weather.").rpartition("_")
    if unit not in _UNITS:
        words, unit = name.removeprefix("weather."), ""
    if words.endswith("hour"):
        unit = "h"
    span = " to ".join(dict.fromkeys(f"{end:.4g}" for end in (low, high)))
    return words.replace("_", " "), f"{span} {_UNITS.get(unit, unit)}".rstrip()
