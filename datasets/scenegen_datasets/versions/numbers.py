"""Numbers of the worlds in a merged dataset: two seeds of one map both have a world 0.

A world is told apart by map, seed and its number there. Its name in a dataset is map and number; where two seeds claim
one name, each gets a thousand numbers of its own, so that ``city-07012`` is world 12 of seed 7.
"""

from __future__ import annotations

from collections import defaultdict
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass
from typing import Any

from scenegen.foundation.errors import DatasetError, InputError
from scenegen_datasets.job import MAX_WORLD, ClipJob

BLOCK = 1000
"""Numbers of a seed; a multiple of `scenegen_datasets.plan.SPLIT_PERIOD`, so that a world stays in its split."""

KEY = "world_offset"
"""Of a part, in the lock: what is added to its own numbers; not there if nothing is."""

World = tuple[int, str, int]
"""Seed, map, and number below that seed."""


@dataclass(frozen=True)
class Origin:
    """Where a clip of a dataset was made.

    Attributes
    ----------
    entry : mapping
        With the ``recipe`` it was made with: the lock itself, or one of its parts.
    world : int
        Number the world has by that recipe.
    """

    entry: Mapping[str, Any]
    world: int

    @property
    def seed(self) -> int:
        """Of the recipe."""
        return seed_of(self.entry)


def seed_of(entry: Mapping[str, Any]) -> int:
    """Seed of a lock or of a part of one."""
    seed = entry["recipe"].get("seed", 0)
    return seed if type(seed) is int else 0


def offset_of(entry: Mapping[str, Any]) -> int:
    """What is added to a part's own world numbers in the merged dataset.

    Raises
    ------
    DatasetError
        If it is no multiple of `BLOCK`.
    """
    offset = entry.get(KEY, 0)
    if type(offset) is not int or not 0 <= offset <= MAX_WORLD or offset % BLOCK:
        raise DatasetError(f"recipe.lock.json: {KEY} of a part makes no sense")
    return offset


def origin_of(lock: Mapping[str, Any], job: ClipJob) -> Origin:
    """The recipe a clip was made with, and its world's number there.

    Parameters
    ----------
    lock : mapping
        ``recipe.lock.json`` of the dataset that holds the clip.
    job : ClipJob

    Raises
    ------
    DatasetError
        If no part of a merged dataset holds the clip's world.
    """
    if not lock.get("parts"):
        return Origin(lock, job.world)
    for part in lock["parts"]:
        if any(first <= job.world <= last for first, last in part["worlds"].get(job.map, ())):
            return Origin(part, job.world - offset_of(part))
    raise DatasetError(f"{job.name}: no part of the merged dataset holds its world")


def offsets(worlds: Iterable[World]) -> dict[int, int]:
    """What is added to the numbers of each seed's worlds, so that no two worlds have one name.

    It follows from the worlds alone, not from their order. A seed keeps its numbers unless it shares one with another;
    the others get those of their own thousand, which is ``1000 * (seed % 100)``, or the next that is free. So
    the names of a seed's worlds stay when a dataset grows, or more seeds join.

    Raises
    ------
    InputError
        If there are not enough numbers.
    """
    places: dict[int, set[tuple[str, int]]] = defaultdict(set)
    for seed, map, number in worlds:
        places[seed].add((map, number))
    owners: dict[tuple[str, int], set[int]] = defaultdict(set)
    for seed, held in places.items():
        for place in held:
            owners[place].add(seed)
    contested = {seed for seeds in owners.values() if len(seeds) > 1 for seed in seeds}
    found = dict.fromkeys(places.keys() - contested, 0)
    taken = {place for seed in found for place in places[seed]}
    for seed in sorted(contested):
        found[seed] = _free(seed, places[seed], taken)
        taken |= _moved(places[seed], found[seed])
    return found


def spans(numbers: Sequence[int]) -> list[list[int]]:
    """Runs of consecutive numbers, first and last of each; `numbers` rise."""
    found: list[list[int]] = []
    for number in numbers:
        if found and number == found[-1][1] + 1:
            found[-1][1] = number
        else:
            found.append([number, number])
    return found


def _free(seed: int, held: set[tuple[str, int]], taken: set[tuple[str, int]]) -> int:
    blocks = (MAX_WORLD + 1) // BLOCK
    largest = max(number for _, number in held)
    for turn in range(blocks):
        offset = BLOCK * ((seed + turn) % blocks)
        if largest + offset <= MAX_WORLD and taken.isdisjoint(_moved(held, offset)):
            return offset
    raise InputError(
        f"the worlds of seed {seed} share numbers with those of other seeds, and {MAX_WORLD + 1:,} numbers are not "
        "enough for all; merge fewer"
    )


def _moved(held: set[tuple[str, int]], offset: int) -> set[tuple[str, int]]:
    return {(map, number + offset) for map, number in held}
