"""Datasets that are to become one: what stands in the way, and what is kept of where their clips come from."""

from __future__ import annotations

import json
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any

from scenegen.foundation import canonical
from scenegen.foundation.errors import InputError
from scenegen_datasets.clip import ClipRecord
from scenegen_datasets.job import ClipJob
from scenegen_datasets.licence import KEY, licence_of
from scenegen_datasets.lock import SOURCE, fingerprint_id, recipe_id
from scenegen_datasets.source import open_source
from scenegen_datasets.splits.faults import clip_fault
from scenegen_datasets.splits.held_out import HeldOut
from scenegen_datasets.store import differing_keys, read_lock
from scenegen_datasets.versions.numbers import KEY as OFFSET
from scenegen_datasets.versions.numbers import Origin, World, offset_of, offsets, origin_of, seed_of, spans
from scenegen_datasets.versions.state import finished_description, meaning_of, names_of

_NAMED = 3
_REMEDY = "render one of them with another --seed, or from another --first-world on"


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
        known = ClipRecord.__dataclass_fields__.keys()
        clips = []
        for line in open_source(root, allow_partial=False).lines:
            facts = json.loads(line)
            clips.append(ClipRecord.from_dict({k: v for k, v in facts.items() if k in known}))
        return cls(root, lock, description, tuple(clips), tuple(origin_of(lock, c.job) for c in clips))

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


def check_parts(parts: Sequence[Part]) -> None:
    """Refuse parts that cannot be read as one dataset, share a clip, or break each other's splits.

    Raises
    ------
    InputError
        With the first thing that stands in the way, and where.
    """
    if len(parts) < 2:
        raise InputError("name at least two datasets to merge")
    _refuse_twins(parts)
    _refuse_disagreement(parts)
    _refuse_collisions(parts)
    held_out = HeldOut.union(HeldOut.of_lock(part.lock) for part in parts)
    for part in parts:
        for clip in part.clips:
            fault = clip_fault(held_out, clip)
            if fault:
                raise InputError(
                    f"{part.root}: {clip.job.name} {fault}; merge datasets that hold out the same, or less"
                )


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
        "merged": sorted({str(entry["recipe_id"]) for entry in entries}),
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


def _agreed(part: Part) -> dict[str, Any]:
    """What parts must have in common: what numbers mean, and the whole camera behind the counts, noise included."""
    return {**meaning_of(part.description), "recipe": {"sensor": part.lock["recipe"].get("sensor")}}


def _refuse_disagreement(parts: Sequence[Part]) -> None:
    first = parts[0]
    for other in parts[1:]:
        licences = licence_of(first.lock), licence_of(other.lock)
        if licences[0] != licences[1]:
            raise InputError(
                f"{first.root} is licensed {licences[0]}, {other.root} {licences[1]}; "
                "merge only what is under one licence"
            )
        found = list(differing_keys(_agreed(first), _agreed(other)))
        if found:
            more = f" and {len(found) - _NAMED} more" if len(found) > _NAMED else ""
            raise InputError(
                f"{first.root} and {other.root} cannot be read as one dataset; they differ in "
                f"{'; '.join(found[:_NAMED])}{more}"
            )
        ours, theirs = names_of(first.description), names_of(other.description)
        for kind, names in ours.items():
            for number in sorted(names.keys() & theirs[kind].keys(), key=int):
                if names[number] != theirs[kind][number]:
                    raise InputError(
                        f"{kind} {number} is '{names[number]}' in {first.root} and '{theirs[kind][number]}' in "
                        f"{other.root}; they cannot be read as one dataset"
                    )


def _refuse_collisions(parts: Sequence[Part]) -> None:
    """No place twice, whatever its name: a world is its map, seed and number."""
    clips: dict[tuple[World, int], Part] = {}
    worlds: dict[World, tuple[Part, str]] = {}
    for part in parts:
        for clip, origin, world in zip(part.clips, part.origins, part.worlds, strict=True):
            job, recipe = clip.job, str(origin.entry["recipe_id"])
            before = clips.setdefault((world, job.clip), part)
            if before is not part:
                raise InputError(
                    f"clip {job.name} of seed {origin.seed} is in {before.root} and in {part.root}, and a merged "
                    f"dataset holds a clip once; {_REMEDY}"
                )
            first, made_by = worlds.setdefault(world, (part, recipe))
            if made_by != recipe:
                raise InputError(
                    f"{job.map}-{job.world:05d} of seed {origin.seed} is in {first.root} and, by another recipe, in "
                    f"{part.root}: one place twice; {_REMEDY}"
                )


def _refuse_twins(parts: Sequence[Part]) -> None:
    roots: set[Path] = set()
    for part in parts:
        if part.root.resolve() in roots:
            raise InputError(f"{part.root} is named twice; name each dataset once")
        roots.add(part.root.resolve())
