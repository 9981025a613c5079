"""``scenegen diff``: compare two datasets, and say which version the change needs."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import tyro

from scenegen.foundation.words import size
from scenegen_cli.console import say, say_json, table
from scenegen_cli.parse import parse

if TYPE_CHECKING:
    from scenegen_datasets.versions.diff import Difference
    from scenegen_datasets.versions.measure import Measures

_SHOWN = 20
_CLASSES = 12


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
    command = parse(Diff, "diff", arguments)
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
    yield table(_sides(found))
    if found.recipe:
        yield f"\nrecipe, {len(found.recipe)} {'key differs' if len(found.recipe) == 1 else 'keys differ'}:"
        yield from (f"  {line}" for line in found.recipe[:_SHOWN])
        if len(found.recipe) > _SHOWN:
            yield f"  ... and {len(found.recipe) - _SHOWN} more (--json lists all)"
    if found.old.measures is not None and found.new.measures is not None and not found.same:
        yield from _pixels(found.old.measures, found.new.measures)
    yield "\nsame: every sample and every byte of them" if found.same else "\nchanges:"
    yield from (f"  {change.bump.name:5}  {change}" for change in found.changes)
    if found.proposed:
        yield f"\nas the next version after {found.old.version}: {found.proposed} ({found.bump.name})"


def _sides(found: Difference) -> Iterator[tuple[str, ...]]:
    old, new = found.old, found.new
    yield ("", "old", "new", "change")
    yield ("directory", old.root, new.root, "")
    yield ("version", old.version, new.version, "")
    if old.parts or new.parts:
        yield ("merged of", ", ".join(old.parts) or "-", ", ".join(new.parts) or "-", "")
    for name, one, other in (
        ("recipe id", old.recipe_id, new.recipe_id),
        ("content id", old.content_id, new.content_id),
    ):
        yield (name, one[:16], other[:16], "" if one == other else "another")
    for name in old.counts:
        show = size if name == "shard_bytes" else "{:,}".format
        more = new.counts[name] - old.counts[name]
        sign = "-" if more < 0 else "+"
        change = f"{sign}{show(abs(more))}" if more else ""
        yield (name.replace("_", " "), show(old.counts[name]), show(new.counts[name]), change)


def _pixels(old: Measures, new: Measures) -> Iterator[str]:
    from scenegen_datasets.versions.measure import QUANTILES

    yield f"\nwhat {old.pairs:,} and {new.pairs:,} pairs show, spread evenly over each:"
    rows = [("", *(f"{q:.0%}" for q in QUANTILES))]
    for name, before, after in (
        ("depth [m]", old.depth_m, new.depth_m),
        ("temperature [K]", old.temperature_K, new.temperature_K),
    ):
        if before and after:
            rows.append((f"{name}, old", *(f"{value:.2f}" for value in before)))
            rows.append((f"{name}, new", *(f"{value:.2f}" for value in after)))
            rows.append(("  change", *(f"{b - a:+.2f}" for a, b in zip(before, after, strict=True))))
    yield table(rows)
    yield from _classes(old.classes, new.classes)


def _classes(old: Mapping[int, float], new: Mapping[int, float]) -> Iterator[str]:
    """The classes whose share changed most."""
    from scenegen.classes import CLASSES

    names = {int(kind.id): kind.name for kind in CLASSES}
    moved = sorted({*old, *new}, key=lambda k: (-abs(new.get(k, 0.0) - old.get(k, 0.0)), k))
    if not moved:
        return
    rows = [("share of pixels", "old", "new", "change")]
    for k in moved[:_CLASSES]:
        a, b = old.get(k, 0.0), new.get(k, 0.0)
        rows.append((names.get(k, str(k)), f"{a:.2%}", f"{b:.2%}", f"{100 * (b - a):+.2f} points"))
    yield ""
    yield table(rows)
    if len(moved) > _CLASSES:
        yield f"and {len(moved) - _CLASSES} classes that changed less (--json lists all)"
