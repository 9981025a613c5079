"""The rule of versions: MAJOR when existing samples change, MINOR when something is added, PATCH when only bytes do."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass

from scenegen_datasets.store import differing_keys
from scenegen_datasets.versions.semver import Bump
from scenegen_datasets.versions.state import ClipMark, State

MERGED = "merged"
"""Key in the recipe of a merged dataset: the recipe ids of its parts."""

_NAMED = 3
"""Clips named in a message; the rest are counted."""


@dataclass(frozen=True)
class Change:
    """One kind of difference between two states of a dataset.

    Attributes
    ----------
    bump : Bump
        What it asks of the version.
    what : str
        In words, one line.
    clips : tuple of str
        Clips it is about, if it is about clips.
    """

    bump: Bump
    what: str
    clips: tuple[str, ...] = ()

    def __str__(self) -> str:
        more = len(self.clips) - _NAMED
        named = ", ".join(self.clips[:_NAMED]) + (f" and {more} more" if more > 0 else "")
        return f"{self.what}: {named}" if self.clips else self.what


def compare(old: State, new: State) -> tuple[Change, ...]:
    """List what changed from one state to another, largest first; the order within a size is fixed."""
    found = [*_meaning(old, new), *_clips(old.clips, new.clips), *_description(old, new)]
    return tuple(sorted(found, key=lambda change: -change.bump))


def needed(changes: Iterable[Change]) -> Bump:
    """The bump that a set of changes asks for."""
    return max((change.bump for change in changes), default=Bump.NONE)


def _meaning(old: State, new: State) -> Iterator[Change]:
    before, after = dict(old.meaning), dict(new.meaning)
    layers, now = before.pop("layers"), after.pop("layers")
    for line in differing_keys(before, after):
        yield Change(Bump.MAJOR, f"what samples mean: {line}")
    for name in sorted(layers.keys() | now.keys()):
        if name not in now:
            yield Change(Bump.MAJOR, f"layer {name} is gone")
        elif name not in layers:
            yield Change(Bump.MINOR, f"layer {name} is new")
        elif layers[name] != now[name]:
            yield Change(Bump.MAJOR, f"layer {name} is of another type or unit")
    for kind in ("class", "material"):
        yield from _names(kind, old.names.get(kind, {}), new.names.get(kind, {}))


def _names(kind: str, before: Mapping[str, str], after: Mapping[str, str]) -> Iterator[Change]:
    for number in sorted(before.keys() | after.keys(), key=_in_order):
        old, new = before.get(number), after.get(number)
        if old is None:
            yield Change(Bump.MINOR, f"{kind} {number} '{new}' is new")
        elif old != new:
            yield Change(Bump.MAJOR, f"{kind} {number} was '{old}' and is " + (f"'{new}'" if new else "gone"))


def _in_order(number: str) -> tuple[int, str]:
    """Ids as numbers; what is none stands last."""
    return (int(number), "") if number.isascii() and number.isdigit() else (2**31, number)


def _clips(before: Mapping[str, ClipMark], after: Mapping[str, ClipMark]) -> Iterator[Change]:
    gone, new = sorted(before.keys() - after.keys()), sorted(after.keys() - before.keys())
    both = [(name, before[name], after[name]) for name in sorted(before.keys() & after.keys())]
    moved = [f"{name} ({a.split} -> {b.split})" for name, a, b in both if a.split != b.split]
    told = [name for name, a, b in both if a.facts != b.facts]
    stored = [name for name, a, b in both if a.layers == b.layers and a.shard != b.shard]
    yield from _about(Bump.MAJOR, gone, "is gone", "are gone")
    yield from _about(Bump.MAJOR, moved, "is in another split", "are in another split")
    yield from _about(Bump.MAJOR, told, "has other facts", "have other facts")
    for layer in sorted({layer for _, a, b in both for layer in a.layers.keys() & b.layers.keys()}):
        pairs = [(name, a.layers.get(layer), b.layers.get(layer)) for name, a, b in both]
        changed = [name for name, x, y in pairs if x and y and x != y]
        what = "other metadata of its frames" if layer == "json" else f"another {layer}"
        yield from _about(Bump.MAJOR, changed, f"has {what}", f"have {what.replace('its', 'their')}")
    yield from _about(Bump.MINOR, new, "is new", "are new")
    yield from _about(
        Bump.PATCH, stored, "holds the same samples in other bytes", "hold the same samples in other bytes"
    )


def _about(bump: Bump, clips: Sequence[str], one: str, many: str) -> Iterator[Change]:
    if clips:
        words = f"1 clip {one}" if len(clips) == 1 else f"{len(clips)} clips {many}"
        yield Change(bump, words, tuple(clips))


def _description(old: State, new: State) -> Iterator[Change]:
    """What tells of samples without changing one."""
    keys = [line.partition(": ")[0] for line in differing_keys(old.recipe, new.recipe)]
    if MERGED in keys:
        keys.remove(MERGED)
        yield Change(Bump.PATCH, "it is made of other parts, or of parts with other recipes")
    if keys:
        more = f" and {len(keys) - _NAMED} more" if len(keys) > _NAMED else ""
        yield Change(Bump.PATCH, f"the recipe has other values for {', '.join(keys[:_NAMED])}{more}")
    if old.scene_semantics != new.scene_semantics:
        yield Change(
            Bump.PATCH, f"scene semantics {old.scene_semantics} -> {new.scene_semantics}, of the recipe"
        )
    common = old.storage["layers"].keys() & new.storage["layers"].keys()
    for line in differing_keys(_stored(old, common), _stored(new, common)):
        yield Change(Bump.PATCH, f"storage: {line}")


def _stored(state: State, layers: Iterable[str]) -> dict[str, object]:
    return {
        "schema_version": state.storage["schema_version"],
        "layers": {name: state.storage["layers"][name] for name in layers},
    }
