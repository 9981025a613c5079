"""One clip to be made: the unit of work, of commit and of resume."""

from __future__ import annotations

import re
from dataclasses import dataclass

SPLITS = ("train", "val", "test")
"""Names of the splits; the index stores positions in this tuple."""

_MAP = re.compile(r"[a-z][a-z0-9_]{0,23}")
MAX_WORLD = 99_999
"""Largest number of a world: names have five digits for it."""

_BOUNDS = (("ordinal", 0, 2**32 - 1), ("world", 0, MAX_WORLD), ("clip", 0, 999), ("pairs", 1, 9_998))


def is_map_name(name: str) -> bool:
    """Whether paths and keys can be made of it: lower-case letters, digits, underscores, 24 at most."""
    return _MAP.fullmatch(name) is not None


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

    Raises
    ------
    ValueError
        If a field is out of range: paths are made of them.
    """

    ordinal: int
    map: str
    world: int
    clip: int
    split: str
    pairs: int

    def __post_init__(self) -> None:
        if not (isinstance(self.map, str) and is_map_name(self.map)):
            raise ValueError(f"'{self.map}' cannot be the name of a map")
        if self.split not in SPLITS:
            raise ValueError(f"'{self.split}' is not a split")
        for name, least, most in _BOUNDS:
            value = getattr(self, name)
            if type(value) is not int or not least <= value <= most:
                raise ValueError(f"{name} is {value!r}, not a whole number from {least} to {most}")

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
