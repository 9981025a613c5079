"""``scenegen diff``: compare two datasets, and say which version the change needs."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import tyro

from scenegen_cli.console import say, say_json, size, table
from scenegen_cli.parse import HelpShown, parse

if TYPE_CHECKING:
    from scenegen_datasets.versions.diff import Difference
    from scenegen_datasets.versions.measure import Measures

_SHOWN = 20


@dataclass(frozen=True)
class Diff:
    """Compare two datasets: recipe, counts, clips, classes, temperature and depth; propose a version.

    Exits with 0 if they hold the same samples in the same bytes, 1 if they differ, 2 if one cannot be read.
    """

    old: Annotated[Path, tyro.conf.Positional]
    """Directory of the older dataset."""
    new: Annotated[Path, tyro.conf.Positional]
    """Directory of the newer one."""
    pairs: int = 64
    """Pairs of each whose pixels are looked at; 0 looks at none."""
    json: bool = False
    """Report as JSON."""


def run(arguments: Sequence[str]) -> int:
    """Run the subcommand; returns the exit code."""
    try:
        command = parse(Diff, "diff", arguments)
    except HelpShown:
        return 0
    from scenegen.foundation.errors import DatasetError, InputError
    from scenegen_datasets.versions.diff import diff

    if not 0 <= command.pairs <= 1_000_000:
        raise InputError(f"--pairs {command.pairs}: look at 0 to 1,000,000 pairs")
    try:
        found = diff(command.old, command.new, command.pairs)
    except DatasetError as error:  # 1 says that two sound datasets differ
        raise InputError(str(error)) from None
    if command.json:
        say_json(found.to_dict())
    else:
        say("\n".join(_words(found)))
    return 0 if found.same else 1


def _words(found: Difference) -> Iterator[str]:
    old, new = found.old, found.new
    rows = [
        ("", "old", "new"),
        ("directory", old.root, new.root),
        ("version", old.version, new.version),
        ("recipe id", old.recipe_id[:16], new.recipe_id[:16]),
        ("content id", old.content_id[:16], new.content_id[:16]),
    ]
    for name in old.counts:
        show = size if name == "shard_bytes" else "{:,}".format
        rows.append((name.replace("_", " "), show(old.counts[name]), show(new.counts[name])))
    yield table(rows)
    if found.recipe:
        yield f"\nrecipe, {len(found.recipe)} keys differ:"
        yield from (f"  {line}" for line in found.recipe[:_SHOWN])
        if len(found.recipe) > _SHOWN:
            yield f"  ... and {len(found.recipe) - _SHOWN} more (--json lists all)"
    if old.measures is not None and new.measures is not None:
        yield from _pixels(old.measures, new.measures)
    yield "\nsame: every sample and every byte of them" if found.same else "\nchanges:"
    yield from (f"  {change.bump.name:5}  {change}" for change in found.changes)
    if found.proposed:
        yield f"\nas the next version after {old.version}: {found.proposed} ({found.bump.name})"


def _pixels(old: Measures, new: Measures) -> Iterator[str]:
    from scenegen.classes import CLASSES
    from scenegen_datasets.versions.measure import QUANTILES

    yield f"\npixels of {old.pairs} and {new.pairs} pairs:"
    rows = [("", *(f"{q:.0%}" for q in QUANTILES))]
    for name, values in (
        ("depth [m], old", old.depth_m),
        ("depth [m], new", new.depth_m),
        ("temperature [K], old", old.temperature_K),
        ("temperature [K], new", new.temperature_K),
    ):
        rows.append((name, *(f"{value:.2f}" for value in values or [float("nan")] * len(QUANTILES))))
    yield table(rows)
    names = {int(kind.id): kind.name for kind in CLASSES}
    shares = [
        (k, old.classes.get(k, 0.0), new.classes.get(k, 0.0)) for k in sorted({*old.classes, *new.classes})
    ]
    if shares:
        yield ""
        yield table(
            [
                ("share of pixels", "old", "new", "change"),
                *(
                    (names.get(k, str(k)), f"{a:.2%}", f"{b:.2%}", f"{100 * (b - a):+.2f} points")
                    for k, a, b in shares
                ),
            ]
        )
