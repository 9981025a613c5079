"""Compare two datasets: what was asked, what is there, what it looks like, and which version the change needs."""

from __future__ import annotations

import re
from collections.abc import Iterator, Mapping
from dataclasses import asdict, dataclass, replace
from pathlib import Path
from typing import Any

from scenegen_datasets.job import SPLITS
from scenegen_datasets.store import differing_keys, read_lock
from scenegen_datasets.versions.measure import QUANTILES, Measures, measure
from scenegen_datasets.versions.rule import MERGED, Change, compare, needed
from scenegen_datasets.versions.semver import Bump, Version
from scenegen_datasets.versions.state import finished_description, state_of

_BY_PART = "not the same in all parts"


@dataclass(frozen=True)
class Side:
    """One of the two datasets.

    Attributes
    ----------
    root : str
    name, version, recipe_id, content_id : str
    counts : mapping of str to int
        Pairs, pairs of each split, frames, clips, worlds, shard_bytes.
    parts : tuple of str
        Name and version of each dataset it was merged of.
    measures : Measures or None
        None if pixels were not looked at.
    """

    root: str
    name: str
    version: str
    recipe_id: str
    content_id: str
    counts: Mapping[str, int]
    parts: tuple[str, ...]
    measures: Measures | None


@dataclass(frozen=True)
class Difference:
    """What `diff` found.

    Attributes
    ----------
    old, new : Side
    recipe : tuple of str
        Recipe keys that differ, ``key: old -> new``; of a merged dataset, a key on which its parts disagree says so.
    changes : tuple of Change
        Largest first.
    bump : Bump
        What the changes ask of the version.
    proposed : str
        Version for `new` as the successor of `old`; empty if nothing changed.
    """

    old: Side
    new: Side
    recipe: tuple[str, ...]
    changes: tuple[Change, ...]
    bump: Bump
    proposed: str

    @property
    def same(self) -> bool:
        """Whether both hold the same samples, stored and described in the same way."""
        return not self.changes

    def to_dict(self) -> dict[str, Any]:
        """Return plain data."""
        changes = [{"bump": c.bump.name, "what": c.what, "clips": list(c.clips)} for c in self.changes]
        return {
            "same": self.same,
            "bump": self.bump.name,
            "proposed": self.proposed,
            "recipe": list(self.recipe),
            "changes": changes,
            "quantiles": list(QUANTILES),
            "old": asdict(self.old),
            "new": asdict(self.new),
        }


def diff(old: Path, new: Path, pairs: int = 64) -> Difference:
    """Compare two finished datasets.

    Parameters
    ----------
    old, new : Path
    pairs : int
        Pairs of each whose pixels are looked at; 0 looks at none. Everything else is read from the receipts.

    Raises
    ------
    InputError
        If one is no dataset or not finished.
    DatasetError
        If one is damaged.
    """
    before, after = state_of(old), state_of(new)
    changes = compare(before, after)
    bump = needed(changes)
    one = _side(old, pairs)
    same = after.clips.keys() == before.clips.keys() and not changes  # then it shows what the other one does
    sides = one, _side(new, 0 if same else pairs)
    if same:
        sides = one, replace(sides[1], measures=one.measures)
    last = Version.parse(sides[0].version.removesuffix("-dev"))
    return Difference(
        old=sides[0],
        new=sides[1],
        recipe=tuple(_recipe_lines(before.recipe, after.recipe)),
        changes=changes,
        bump=bump,
        proposed=str(last.bumped(bump)) if bump is not Bump.NONE else "",
    )


def _recipe_lines(old: Mapping[str, Any], new: Mapping[str, Any]) -> Iterator[str]:
    """Keys that differ; a merged dataset has those on which its parts agree, and their ids, which tell nothing."""
    before, after = ({key: value for key, value in recipe.items() if key != MERGED} for recipe in (old, new))
    for line in differing_keys(before, after):
        if MERGED in new:
            line = re.sub(r" -> null$", f" -> {_BY_PART}", line)
        if MERGED in old:
            line = re.sub(r"^([^ ]+:) null -> ", rf"\1 {_BY_PART} -> ", line)
        yield line


def _side(root: Path, pairs: int) -> Side:
    told = finished_description(root)
    by_split = {f"{split}_pairs": told["splits"][split]["pairs"] for split in SPLITS}
    order = ("clips", "worlds", "frames", "shard_bytes")
    counts = {"pairs": told["counts"]["pairs"], **by_split, **{name: told["counts"][name] for name in order}}
    return Side(
        root=str(root),
        name=told["name"],
        version=told["version"],
        recipe_id=told["recipe_id"],
        content_id=told["content_id"],
        counts=counts,
        parts=tuple(sorted(f"{part['name']} {part['version']}" for part in read_lock(root).get("parts", ()))),
        measures=measure(root, pairs) if pairs else None,
    )
