"""What audits look at: pairs of consecutive frames, drawn by a seeded lot and bounded in number whatever the size."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from itertools import pairwise
from pathlib import Path
from typing import Any

import numpy as np
from jaxtyping import Bool, Float32, Float64, UInt8, UInt16, UInt32

from scenegen.foundation.rng import stream
from scenegen_datasets.index import checked, job_of
from scenegen_datasets.layers import LAYERS, layers_by_member
from scenegen_datasets.reader import ShardReader
from scenegen_datasets.scale import scale_of
from scenegen_datasets.source import Source
from scenegen_render.sensor.scale import CountScale

SEED = 20_220_322
"""Of the lot that picks frames: the same dataset is always judged by the same frames."""

MOST_STEPS, LEAST_STEPS = 160, 48
PIXELS = MOST_STEPS * 256 * 256
"""Looked at in all, so that large images are as quickly judged as small ones."""

_NOW = ("thermal", "depth", "flow", "covisible", "radiance", "semantic", "instance")
_NEXT = ("thermal", "depth", "flow_back", "covisible_back", "radiance")


@dataclass(frozen=True, eq=False)
class Still:
    """One frame as far as the dataset stores it.

    Attributes
    ----------
    world_from_camera : float64 (4, 4)
    counts : uint16 (rows, columns)
    depth : float32 (rows, columns)
        [m], +inf for sky.
    flow, covisible
        Towards the other frame of the step.
    radiance : float32 (rows, columns)
        [W m^-2 sr^-1], free of noise.
    semantic, instance
        Ids.
    """

    world_from_camera: Float64[np.ndarray, "4 4"]
    counts: UInt16[np.ndarray, "rows columns"]
    depth: Float32[np.ndarray, "rows columns"]
    flow: Float32[np.ndarray, "rows columns 2"] | None = None
    covisible: Bool[np.ndarray, "rows columns"] | None = None
    radiance: Float32[np.ndarray, "rows columns"] | None = None
    semantic: UInt8[np.ndarray, "rows columns"] | None = None
    instance: UInt32[np.ndarray, "rows columns"] | None = None


@dataclass(frozen=True, eq=False)
class Step:
    """Two consecutive frames of a flight.

    Attributes
    ----------
    key : str
        Of the first frame.
    world, clip : str
        Names of what it belongs to, such as ``city-00003`` and ``city-00003-001``.
    split : str
    facts : mapping
        The clip's line of ``clips.jsonl``.
    K : float64 (3, 3)
    scale : CountScale
        What its counts mean.
    now, next : Still
        `now` holds the flow forward, `next` the flow back where the dataset has it.
    """

    key: str
    world: str
    clip: str
    split: str
    facts: Mapping[str, Any]
    K: Float64[np.ndarray, "3 3"]
    scale: CountScale
    now: Still
    next: Still


@dataclass(frozen=True)
class Place:
    """Where a step stands: position of its clip in the plan, and its first frame."""

    clip: int
    frame: int


def draw_places(source: Source, most: int | None = None) -> tuple[Place, ...]:
    """Draw the steps to look at: as many clips as possible, then as many moments of each, in plan order.

    Parameters
    ----------
    source : Source
    most : int, optional
        Steps at most; by default what `PIXELS` allows.
    """
    rng = stream(SEED, "audit", "places")
    first = source.rows[source.starts]
    usable = np.flatnonzero(first["frames"] > 1)
    if not len(usable):
        return ()
    pixels = int(first["height_px"][0]) * int(first["width_px"][0])
    count = most or int(np.clip(PIXELS // max(pixels, 1), LEAST_STEPS, MOST_STEPS))
    clips = np.sort(rng.permutation(usable)[:count])
    share, more = divmod(count, len(clips))
    places = []
    for k, clip in enumerate(clips.tolist()):
        steps = int(first["frames"][clip]) - 1
        wanted = min(share + (k < more), steps)
        edges = np.linspace(0, steps, wanted + 1).astype(int)
        places += [Place(clip, int(rng.integers(a, b))) for a, b in pairwise(edges)]
    return tuple(places)


class StepReader:
    """Reads steps of one dataset.

    Parameters
    ----------
    root : Path
    source : Source
    """

    def __init__(self, root: Path, source: Source) -> None:
        self._source, self._shards = source, ShardReader(root)

    def read(self, place: Place) -> Step:
        """Decode the two frames of a step.

        Raises
        ------
        CorruptFrameError
            If the stored bytes are not what was written.
        """
        facts = self._source.facts(place.clip)
        at = int(self._source.starts[place.clip]) + place.frame
        row = checked(self._source.rows[at])
        job = job_of(row)
        return Step(
            job.key(place.frame),
            f"{job.map}-{job.world:05d}",
            job.name,
            job.split,
            facts,
            row["K"].copy(),
            scale_of(facts),
            self._still(row, _NOW),
            self._still(checked(self._source.rows[at + 1]), _NEXT),
        )

    def steps(self, places: tuple[Place, ...]) -> Iterator[Step]:
        """Read one step after the other."""
        return (self.read(place) for place in places)

    def _still(self, row: np.void, wanted: tuple[str, ...]) -> Still:
        job, stored = job_of(row), self._source.layers
        found: dict[str, Any] = {}
        for member in layers_by_member(name for name in wanted if name in stored):
            group = tuple(LAYERS[name] for name in stored if LAYERS[name].member == member)
            arrays = self._shards.arrays(row, job, member, group)
            found |= {name: arrays[name] for name in arrays if name in wanted}
        names = {"thermal": "counts", "flow_back": "flow", "covisible_back": "covisible"}
        layers = {names.get(name, name): array for name, array in found.items()}
        return Still(row["world_from_camera"].copy(), **layers)
