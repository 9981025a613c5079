"""What a dataset is, in a few numbers."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from scenegen_datasets.description import ranges_of, read_description
from scenegen_datasets.job import SPLITS
from scenegen_datasets.licence import licence_of
from scenegen_datasets.receipt import read_receipt, receipt_paths
from scenegen_datasets.splits.held_out import HeldOut
from scenegen_datasets.store import DATASET, read_lock


@dataclass(frozen=True)
class DatasetInfo:
    """Summary of a dataset on disk.

    Attributes
    ----------
    name, version, recipe_id, content_id : str
        `version` and `content_id` are empty while the dataset grows.
    complete : bool
        Whether ``dataset.json`` is there and every clip of the plan was made.
    pairs, frames, clips, worlds : int
    splits : mapping of str to int
        Pairs per split.
    bytes : int
        Size of the shards.
    ranges : mapping of str to (float, float)
        Smallest and largest ``hour``, ``sun_elevation_deg``, ``weather.air_mean_K``, ... over the clips.
    missing : tuple of str
        Clips of the plan that were not made; unknown, hence empty, while the dataset grows.
    pairs_planned : int or None
        What the recipe asked for.
    maps, layers : tuple of str
    grid_px : (int, int) or None
        Columns and rows of every picture; None before the first clip.
    band_um : (float, float) or None
    license : str
        Of the data, by its SPDX name.
    held_out : tuple of str
        What only the test split shows, in words.
    parts : tuple of str
        Datasets it was merged of: name, version and worlds.
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
    ranges: Mapping[str, tuple[float, float]]
    missing: tuple[str, ...]
    pairs_planned: int | None
    maps: tuple[str, ...]
    layers: tuple[str, ...]
    grid_px: tuple[int, int] | None
    band_um: tuple[float, float] | None
    license: str
    held_out: tuple[str, ...]
    parts: tuple[str, ...]


def info(root: Path) -> DatasetInfo:
    """Read the summary of a finished or growing dataset.

    Raises
    ------
    InputError
        If there is no dataset at `root`.
    DatasetError
        If its ``dataset.json``, lock or, while it grows, a receipt is damaged.
    """
    lock = read_lock(root)
    planned = lock["recipe"].get("pairs")
    if not (root / DATASET).exists():
        return _growing(root, lock, planned)
    d = read_description(root / DATASET)
    counts = d["counts"]
    return DatasetInfo(
        name=d["name"],
        version=d["version"],
        recipe_id=d["recipe_id"],
        content_id=d["content_id"],
        complete=not d["missing"],
        pairs=counts["pairs"],
        frames=counts["frames"],
        clips=counts["clips"],
        worlds=counts["worlds"],
        splits={s: d["splits"][s]["pairs"] for s in SPLITS},
        bytes=counts["shard_bytes"],
        ranges={name: (low, high) for name, (low, high) in d["ranges"].items()},
        missing=tuple(d["missing"]),
        pairs_planned=planned,
        maps=tuple(d["maps"]),
        layers=tuple(layer["name"] for layer in d["layers"]),
        grid_px=(d["grid"]["width_px"], d["grid"]["height_px"]),
        band_um=(d["band_um"][0], d["band_um"][1]),
        **_of_lock(lock),
    )


def _growing(root: Path, lock: Mapping[str, Any], planned: int | None) -> DatasetInfo:
    receipts = (
        read_receipt(root, path) for path in receipt_paths(root)
    )  # one at a time: their frames are many
    made = [(r.clip, r.layers, r.size) for r in receipts]
    clips, jobs = [clip for clip, *_ in made], [clip.job for clip, *_ in made]
    first, layers, _ = made[0] if made else (None, (), 0)
    return DatasetInfo(
        name=lock["name"],
        version="",
        recipe_id=lock["recipe_id"],
        content_id="",
        complete=False,
        pairs=sum(j.pairs for j in jobs),
        frames=sum(j.frames for j in jobs),
        clips=len(jobs),
        worlds=len({(j.map, j.world) for j in jobs}),
        splits={s: sum(j.pairs for j in jobs if j.split == s) for s in SPLITS},
        bytes=sum(size for *_, size in made),
        ranges=ranges_of(clips),
        missing=(),
        pairs_planned=planned,
        maps=tuple(sorted({j.map for j in jobs})),
        layers=layers,
        grid_px=None if first is None else (first.width_px, first.height_px),
        band_um=None if first is None else first.band_um,
        **_of_lock(lock),
    )


def _of_lock(lock: Mapping[str, Any]) -> dict[str, Any]:
    """What the lock alone tells."""
    return {
        "license": licence_of(lock),
        "held_out": HeldOut.of_lock(lock).words,
        "parts": tuple(
            sorted(
                f"{part['name']} {part['version']} ({worlds_in_words(part)})"
                for part in lock.get("parts", ())
            )
        ),
    }


def worlds_in_words(part: Mapping[str, Any]) -> str:
    """Names of the worlds that a merged dataset has from one of its parts: ``city 0 to 15``."""
    runs = [
        f"{map} {first}" if first == last else f"{map} {first} to {last}"
        for map, spans in part["worlds"].items()
        for first, last in spans
    ]
    return ", ".join(runs)
