"""The plan of a campaign: an endless, deterministic sequence of batches, of which a job flies the first so many.

Nothing here depends on the pilot, on how many flights are asked for or on how many workers fly them: flight 17 of a
map starts at the same place, in the same world, hour and wind, whoever flies it.
"""

from __future__ import annotations

import itertools
from collections.abc import Iterator
from dataclasses import dataclass

from scenegen_datasets.plan import split_of
from scenegen_trainers.campaign.knobs import CampaignKnobs


@dataclass(frozen=True, order=True)
class Batch:
    """Flights that share a world, an hour and a clock.

    Attributes
    ----------
    map : str
    index : int
        Position among the map's batches, from 0.
    world : int
        Of the dataset plan.
    clip : int
        Batch within the world; weather, hour and clock are those of this clip of the dataset plan.
    first, count : int
        Id of the first flight, and how many are flown.
    """

    map: str
    index: int
    world: int
    clip: int
    first: int
    count: int

    @property
    def name(self) -> str:
        """Unique within a map, and in order: ``00003``."""
        return f"{self.index:05d}"

    @property
    def flights(self) -> range:
        """Ids of the flights."""
        return range(self.first, self.first + self.count)


def worlds(split: str) -> Iterator[int]:
    """Worlds of the dataset plan that belong to a split, or ``"all"``; endless."""
    return (world for world in itertools.count() if split in ("all", split_of(world)))


def batches(map: str, flights: int, knobs: CampaignKnobs) -> tuple[Batch, ...]:
    """Batches that hold the first `flights` flights of a map; the last one may be cut short."""
    size = knobs.flights_per_batch
    found: list[Batch] = []
    places = ((world, clip) for world in worlds(knobs.split) for clip in range(knobs.batches_per_world))
    for first, (world, clip) in zip(range(0, flights, size), places, strict=False):
        found.append(Batch(map, len(found), world, clip, first, min(size, flights - first)))
    return tuple(found)


def batch_of(map: str, flight: int, flights: int, knobs: CampaignKnobs) -> Batch:
    """The batch a flight belongs to, of a campaign of so many flights."""
    return batches(map, flights, knobs)[flight // knobs.flights_per_batch]
