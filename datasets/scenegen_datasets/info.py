"""What a dataset is, in a few numbers."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path


@dataclass(frozen=True)
class DatasetInfo:
    """Summary of a dataset on disk.

    Attributes
    ----------
    name, version, recipe_id, content_id : str
        `content_id` is empty while the dataset grows.
    complete : bool
        Whether ``dataset.json`` is there and every clip of the plan was made.
    pairs, frames, clips, worlds : int
    splits : mapping of str to int
        Pairs per split.
    bytes : int
        Size of the shards.
    hours, air_mean_K, sun_elevation_deg : (float, float)
        Smallest and largest over the clips.
    missing : tuple of str
        Clips of the plan without a receipt.
    """

    name: str
    version: str
    recipe_id: str
    content_id: str
    complete: bool
    pairs: int
    frames: int
    clips: int
    worlds: int
    splits: Mapping[str, int]
    bytes: int
    hours: tuple[float, float]
    air_mean_K: tuple[float, float]
    sun_elevation_deg: tuple[float, float]
    missing: tuple[str, ...]


def info(root: Path) -> DatasetInfo:
    """Read the summary of a finished or growing dataset.

    Raises
    ------
    InputError
        If there is no dataset at `root`.
    """
    raise NotImplementedError
