"""One clip to be made: the unit of work, of commit and of resume."""

from __future__ import annotations

from dataclasses import dataclass

SPLITS = ("train", "val", "test")
"""Names of the splits; the index stores positions in this tuple."""


@dataclass(frozen=True, order=True)
class ClipJob:
    """One clip of the plan.

    Attributes
    ----------
    ordinal : int
        Position in the plan, from 0.
    map : str
        Name of the map, lower-case letters, digits and underscores.
    world, clip : int
        World of that map, clip of that world, from 0.
    split : str
        One of `SPLITS`.
    pairs : int
        Pairs in the clip; it stores one frame more, because frame 0 has no predecessor.
    """

    ordinal: int
    map: str
    world: int
    clip: int
    split: str
    pairs: int

    @property
    def frames(self) -> int:
        """Stored frames."""
        return self.pairs + 1

    @property
    def name(self) -> str:
        """Unique name inside a dataset, e.g. ``city-00012-003``."""
        return f"{self.map}-{self.world:05d}-{self.clip:03d}"

    @property
    def shard(self) -> str:
        """Path of the clip's tar below the dataset."""
        return f"shards/{self.split}/{self.map}-{self.world:05d}/{self.clip:03d}.tar"

    @property
    def receipt(self) -> str:
        """Path of the clip's receipt below the dataset."""
        return f"receipts/{self.split}/{self.map}-{self.world:05d}/{self.clip:03d}.json"

    def key(self, frame: int) -> str:
        """Key of one frame, e.g. ``city-00012-003-0000``; no dots, as WebDataset wants it."""
        return f"{self.name}-{frame:04d}"
