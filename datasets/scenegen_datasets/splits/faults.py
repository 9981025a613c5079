"""The proof that no split shows what is kept for another, and its statement in ``dataset.json``."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Mapping
from typing import Any

from scenegen.foundation.errors import DatasetError
from scenegen_datasets.clip import ClipRecord
from scenegen_datasets.plan import SPLIT_OF, SPLIT_PERIOD, split_of
from scenegen_datasets.splits.held_out import HeldOut


def split_rule(lock: Mapping[str, Any]) -> dict[str, Any]:
    """State how the clips of a dataset were split, as plain data.

    Parameters
    ----------
    lock : mapping
        ``recipe.lock.json``.
    """
    return {
        "by": "world",
        "period": SPLIT_PERIOD,
        "val": [world for world, split in SPLIT_OF.items() if split == "val"],
        "test": [world for world, split in SPLIT_OF.items() if split == "test"],
        "held_out_for_test": HeldOut.of_lock(lock).statement(),
    }


def split_faults(
    lock: Mapping[str, Any], told: Mapping[str, Any], clips: Iterable[ClipRecord]
) -> Iterator[tuple[str, str]]:
    """Find clips outside the split they belong to, or that show what only the test split may show.

    Parameters
    ----------
    lock : mapping
        ``recipe.lock.json``.
    told : mapping
        ``dataset.json``; empty if there is none. One that was written before splits were stated in it is taken as is.
    clips : iterable of ClipRecord

    Yields
    ------
    (str, str)
        Path below the dataset, and what is wrong there.
    """
    try:
        held_out = HeldOut.of_lock(lock)
    except DatasetError as error:
        yield "recipe.lock.json", str(error).partition(": ")[2]
        return
    if "split_rule" in told and told["split_rule"] != split_rule(lock):
        yield "dataset.json", "split_rule is not that of the recipe"
    for clip in clips:
        fault = clip_fault(held_out, clip)
        if fault:
            yield clip.job.receipt, fault


def clip_fault(held_out: HeldOut, clip: ClipRecord) -> str:
    """Say why a clip may not be in its split; "" if it may."""
    job = clip.job
    if job.split != "test" and job.map in held_out.maps:
        return f"is in split {job.split}, map {job.map} is held out for test"
    right = split_of(job.world, job.map in held_out.maps)
    if job.split != right:
        return f"is in split {job.split}, world {job.world} of {job.map} belongs to {right}"
    seen = held_out.condition(clip.hour, clip.weather) if job.split != "test" else ""
    return f"is in split {job.split} and shows what is held out for test: {seen}" if seen else ""
