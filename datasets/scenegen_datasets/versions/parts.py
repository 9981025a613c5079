"""Datasets that are to become one: the place of their clips in the whole, and what is kept of where they come from."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any

from scenegen.foundation import canonical
from scenegen_datasets.clip import ClipRecord
from scenegen_datasets.job import ClipJob
from scenegen_datasets.licence import KEY, licence_of
from scenegen_datasets.lock import SOURCE, fingerprint_id, recipe_id
from scenegen_datasets.source import open_source
from scenegen_datasets.store import read_lock
from scenegen_datasets.versions.numbers import KEY as OFFSET
from scenegen_datasets.versions.numbers import Origin, World, offset_of, offsets, origin_of, seed_of, spans
from scenegen_datasets.versions.rule import MERGED
from scenegen_datasets.versions.state import finished_description


@dataclass(frozen=True)
class Part:
    """A finished dataset that goes into a merged one.

    Attributes
    ----------
    root : Path
    lock, description : mapping
        Its ``recipe.lock.json`` and ``dataset.json``.
    clips : tuple of ClipRecord
        In its plan's order.
    origins : tuple of Origin
        Of each clip.
    """

    root: Path
    lock: Mapping[str, Any]
    description: Mapping[str, Any]
    clips: tuple[ClipRecord, ...]
    origins: tuple[Origin, ...]

    @classmethod
    def read(cls, root: Path) -> Part:
        """Read a finished dataset.

        Raises
        ------
        InputError
            If there is none at `root`, or it is not finished.
        DatasetError
            If it is damaged.
        """
        lock, description = read_lock(root), finished_description(root)
        source = open_source(root, allow_partial=False)
        clips = tuple(source.record(clip) for clip in range(len(source.lines)))
        return cls(root, lock, description, clips, tuple(origin_of(lock, c.job) for c in clips))

    @property
    def worlds(self) -> tuple[World, ...]:
        """World of each clip."""
        pairs = zip(self.clips, self.origins, strict=True)
        return tuple((origin.seed, clip.job.map, origin.world) for clip, origin in pairs)

    def provenance(self) -> list[dict[str, Any]]:
        """What the merged dataset keeps of this one: one entry, or those of a merged dataset it is itself."""
        if self.lock.get("parts"):
            return [dict(part) for part in self.lock["parts"]]
        told = self.description
        whence = {key: self.lock[key] for key in (SOURCE,) if key in self.lock}
        worlds: dict[str, set[int]] = {}
        for clip in self.clips:
            worlds.setdefault(clip.job.map, set()).add(clip.job.world)
        return [
            {
                "name": told["name"],
                "version": told["version"],
                "recipe_id": told["recipe_id"],
                "content_id": told["content_id"],
                "counts": told["counts"],
                "missing": told["missing"],
                "worlds": {map: spans(sorted(found)) for map, found in sorted(worlds.items())},
                "recipe": self.lock["recipe"],
                "scene_semantics": self.lock.get("scene_semantics"),
                "software": self.lock.get("software"),
                **whence,
            }
        ]


@dataclass(frozen=True)
class Piece:
    """One clip of a merged dataset: where it comes from, and its name and place in the whole."""

    part: Part
    clip: ClipRecord
    job: ClipJob


def pieces_of(parts: Sequence[Part]) -> list[Piece]:
    """All clips in the order of the merged dataset: by world, map and clip, whatever the order of the parts."""
    added = offsets(world for part in parts for world in part.worlds)
    found = [
        (number + added[seed], map, clip.job.clip, part, clip)
        for part in parts
        for clip, (seed, map, number) in zip(part.clips, part.worlds, strict=True)
    ]
    found.sort(key=lambda entry: entry[:3])
    return [
        Piece(part, clip, replace(clip.job, ordinal=k, world=number))
        for k, (number, _, _, part, clip) in enumerate(found)
    ]


def merged_lock(parts: Sequence[Part], name: str) -> dict[str, Any]:
    """``recipe.lock.json`` of the whole; the same for every order of the parts, and for parts merged one by one.

    Its recipe holds what the recipes of all parts agree on, with all their maps, and the parts' recipe ids; each part's
    own recipe stands below ``parts``.
    """
    added = offsets(world for part in parts for world in part.worlds)
    entries = [_numbered(entry, added[seed_of(entry)]) for part in parts for entry in part.provenance()]
    entries.sort(key=canonical.canonical)
    recipe = {
        **_common([entry["recipe"] for entry in entries]),
        "map": sorted({clip.job.map for part in parts for clip in part.clips}),
        MERGED: sorted({str(entry["recipe_id"]) for entry in entries}),
        "pairs": sum(clip.job.pairs for part in parts for clip in part.clips),
    }
    semantics = max(int(entry["scene_semantics"] or 0) for entry in entries)
    locks = [part.lock for part in parts]
    prints = {fingerprint_id(p): p for lock in locks for p in (lock["fingerprint"], *lock["mixed_with"])}
    first, *others = (prints[key] for key in sorted(prints))
    return {
        "name": name,
        "recipe": recipe,
        "recipe_id": recipe_id(recipe, semantics),
        "scene_semantics": semantics,
        "fingerprint": first,
        "fingerprint_id": fingerprint_id(first),
        "mixed_with": others,
        "parts": entries,
        **({KEY: licence_of(locks[0])} if any(KEY in lock for lock in locks) else {}),
    }


def _numbered(entry: Mapping[str, Any], offset: int) -> dict[str, Any]:
    """A part's entry with its worlds' names in the whole."""
    more = offset - offset_of(entry)
    worlds = {
        map: [[first + more, last + more] for first, last in runs] for map, runs in entry["worlds"].items()
    }
    plain = {key: value for key, value in entry.items() if key != OFFSET}
    return {**plain, "worlds": worlds, **({OFFSET: offset} if offset else {})}


def _common(recipes: Sequence[Mapping[str, Any]]) -> dict[str, Any]:
    """The keys of several recipes that have the same value in all."""
    found: dict[str, Any] = {}
    for key, value in recipes[0].items():
        values = [recipe.get(key) for recipe in recipes]
        if all(isinstance(one, dict) for one in values):
            found[key] = _common([recipe[key] for recipe in recipes])
        elif all(key in recipe for recipe in recipes) and all(one == value for one in values):
            found[key] = value
    return found
