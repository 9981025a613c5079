"""The plan: an endless, deterministic sequence of worlds and clips, of which a job makes the first so many.

Nothing here depends on how many pairs are asked for, so a dataset can grow: its first clips stay what they were.
"""

from __future__ import annotations

import itertools
from collections.abc import Collection, Iterator, Sequence

from scenegen_datasets.job import ClipJob

SPLIT_PERIOD = 10
"""Worlds per repetition of the split pattern."""

SPLIT_OF = {1: "val", 2: "test"}
"""Worlds of each period that are not for training."""


def split_of(world: int, held_out: bool = False) -> str:
    """Split of a world by its index within its map: worlds 1 and 2 of each ten are kept for validation and test.

    A whole world belongs to one split, because frames of one world share buildings; val and test come early, so that
    a dataset of three worlds has all splits. All worlds of a map that is `held_out` belong to the test split.
    """
    return "test" if held_out else SPLIT_OF.get(world % SPLIT_PERIOD, "train")


def clips(
    maps: Sequence[str],
    clips_per_world: int,
    pairs_per_clip: int,
    test_maps: Collection[str] = (),
    first_world: int = 0,
) -> Iterator[ClipJob]:
    """Yield all clips there will ever be from a world on, in plan order; maps take turns world by world.

    Parameters
    ----------
    maps : sequence of str
        At least one, without repetition.
    clips_per_world, pairs_per_clip : int
        At least 1.
    test_maps : collection of str
        Maps that are held out for the test split.
    first_world : int
        Number of the first world of each map.
    """
    for ordinal in itertools.count():
        turn, clip = divmod(ordinal, clips_per_world)
        after, which = divmod(turn, len(maps))
        world = first_world + after
        split = split_of(world, maps[which] in test_maps)
        yield ClipJob(ordinal, maps[which], world, clip, split, pairs_per_clip)


def last_world(maps: int, clips_per_world: int, pairs_per_clip: int, pairs: int, first_world: int = 0) -> int:
    """Largest number of a world in a plan of so many pairs."""
    turns = -(-pairs // (pairs_per_clip * clips_per_world))
    return first_world + (turns - 1) // maps


def plan(
    maps: Sequence[str],
    clips_per_world: int,
    pairs_per_clip: int,
    pairs: int,
    test_maps: Collection[str] = (),
    first_world: int = 0,
) -> tuple[ClipJob, ...]:
    """Clips that hold at least `pairs` pairs: the first ``ceil(pairs / pairs_per_clip)`` of `clips`."""
    count = -(-pairs // pairs_per_clip)
    endless = clips(maps, clips_per_world, pairs_per_clip, test_maps, first_world)
    return tuple(itertools.islice(endless, count))
