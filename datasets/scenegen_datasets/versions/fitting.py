"""What stands in the way of datasets that are to become one: refused in one line, with what, where, and what to do."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path
from typing import Any

from scenegen.foundation.errors import InputError
from scenegen_datasets.licence import licence_of
from scenegen_datasets.splits.faults import clip_fault
from scenegen_datasets.splits.held_out import HeldOut
from scenegen_datasets.store import differing_keys
from scenegen_datasets.versions.numbers import World
from scenegen_datasets.versions.parts import Part
from scenegen_datasets.versions.state import meaning_of, names_of

_NAMED = 3
_REMEDY = "render one of them with another --seed, or from another --first-world on"
_CAMERA = ("grid.", "sensor.", "recipe.sensor.")
"""What parts may differ in if they only saw with different cameras."""


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
        _refuse_other_layers(first, other)
        found = list(differing_keys(_agreed(first), _agreed(other)))
        if found:
            more = f" and {len(found) - _NAMED} more" if len(found) > _NAMED else ""
            cameras = all(line.startswith(_CAMERA) for line in found)
            remedy = "; 'scenegen sense' may give both one camera" if cameras else ""
            raise InputError(
                f"{first.root} and {other.root} cannot be read as one dataset; they differ in "
                f"{'; '.join(found[:_NAMED])}{more}{remedy}"
            )
        ours, theirs = names_of(first.description), names_of(other.description)
        for kind, names in ours.items():
            for number in sorted(names.keys() & theirs[kind].keys(), key=int):
                if names[number] != theirs[kind][number]:
                    raise InputError(
                        f"{kind} {number} is '{names[number]}' in {first.root} and '{theirs[kind][number]}' in "
                        f"{other.root}; they cannot be read as one dataset"
                    )


def _refuse_other_layers(first: Part, other: Part) -> None:
    ours, theirs = (meaning_of(part.description)["layers"].keys() for part in (first, other))
    for one, two, more in ((first, other, ours - theirs), (other, first, theirs - ours)):
        if more:
            raise InputError(
                f"{one.root} stores {', '.join(sorted(more))}, {two.root} does not; merge datasets with the same layers"
            )


def _refuse_collisions(parts: Sequence[Part]) -> None:
    """No place twice, whatever its name: a world is its map, seed and number."""
    clips: dict[tuple[World, int], Part] = {}
    worlds: dict[World, tuple[Part, str]] = {}
    for part in parts:
        for clip, origin, world in zip(part.clips, part.origins, part.worlds, strict=True):
            job, recipe = clip.job, str(origin.entry["recipe_id"])
            first, made_by = worlds.setdefault(world, (part, recipe))
            if made_by != recipe:
                raise InputError(
                    f"{job.map}-{job.world:05d} of seed {origin.seed} is in {first.root} and, by another recipe, in "
                    f"{part.root}: one place twice; {_REMEDY}"
                )
            before = clips.setdefault((world, job.clip), part)
            if before is not part:
                raise InputError(
                    f"clip {job.name} of seed {origin.seed} is in {before.root} and in {part.root}, by the same "
                    f"recipe: the larger one may hold all of the other; else {_REMEDY}"
                )


def _refuse_twins(parts: Sequence[Part]) -> None:
    roots: set[Path] = set()
    for part in parts:
        if part.root.resolve() in roots:
            raise InputError(f"{part.root} is named twice; name each dataset once")
        roots.add(part.root.resolve())
