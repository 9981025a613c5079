"""What there is to look at: the clips of a dataset, and single frames with every layer decoded."""

from __future__ import annotations

from collections import OrderedDict
from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
from jaxtyping import Float32, Float64, UInt16
from numpy.typing import NDArray

from scenegen.foundation.errors import InputError
from scenegen_datasets.index import checked, job_of
from scenegen_datasets.layers import IMU_MEMBER, layers_by_member
from scenegen_datasets.pictures.words import clip_words
from scenegen_datasets.reader import ShardReader
from scenegen_datasets.scale import scale_of
from scenegen_datasets.source import open_source
from scenegen_render.sensor.scale import counts_to_brightness_K, counts_to_radiance

_KEPT_FRAMES = 16


@dataclass(frozen=True)
class Clip:
    """One clip as the page lists it.

    Attributes
    ----------
    position : int
        In the dataset, in plan order.
    split, map : str
    world, clip : int
    frames : int
        Stored frames, the one before the first pair included.
    """

    position: int
    split: str
    map: str
    world: int
    clip: int
    frames: int

    @property
    def label(self) -> str:
        """Such as ``world 3, clip 1``."""
        return f"world {self.world}, clip {self.clip}"


@dataclass(frozen=True, eq=False)
class Still:
    """One stored frame.

    Attributes
    ----------
    key : str
        As in the shard.
    layers : dict
        Every stored layer of the pixel grid, decoded (`scenegen_datasets.layers.LAYERS`).
    brightness_K : float32 (rows, columns)
        Brightness temperature that the counts stand for [K].
    measured : float32 (rows, columns)
        Band radiance that the counts stand for [W m^-2 sr^-1].
    world_from_camera : float64 (4, 4)
    K : float64 (3, 3)
    time_s : float
    """

    key: str
    layers: Mapping[str, NDArray[Any]]
    brightness_K: Float32[np.ndarray, "rows columns"]
    measured: Float32[np.ndarray, "rows columns"]
    world_from_camera: Float64[np.ndarray, "4 4"]
    K: Float64[np.ndarray, "3 3"]
    time_s: float

    @property
    def counts(self) -> UInt16[np.ndarray, "rows columns"]:
        """What the camera reported."""
        return self.layers["thermal"]


class Library:
    """Reads frames of a dataset, finished or growing; keeps the last few.

    Raises
    ------
    InputError
        If there is no dataset, or nothing in it yet.
    DatasetError
        If what describes it is damaged.
    """

    def __init__(self, root: Path) -> None:
        self.root = root
        self._source = open_source(root, allow_partial=True)
        self._reader = ShardReader(root)
        self._members = {
            member: tuple(group)
            for member, group in layers_by_member(self._source.layers).items()
            if member != IMU_MEMBER
        }
        self._kept: OrderedDict[tuple[int, int], Still] = OrderedDict()
        jobs = (job_of(checked(row)) for row in self._source.heads)
        self.clips = tuple(
            Clip(k, job.split, job.map, job.world, job.clip, job.frames) for k, job in enumerate(jobs)
        )
        if not self.clips:
            raise InputError(f"{root} holds no pair yet; let a render finish its first clip")

    @property
    def layers(self) -> tuple[str, ...]:
        """Names of the stored layers that are pictures."""
        return tuple(layer.name for group in self._members.values() for layer in group)

    def words(self, clip: int) -> str:
        """Hour, date, place and weather of a clip in one line."""
        facts = self._source.facts(clip)
        return clip_words({**facts, **facts["weather"]})

    def path(self, clip: int) -> Float64[np.ndarray, "frames 4 4"]:
        """Poses of all stored frames of a clip, ``world_from_camera``."""
        start = int(self._source.starts[clip])
        rows = self._source.rows[start : start + self.clips[clip].frames]
        return np.array([checked(row)["world_from_camera"] for row in rows])

    def still(self, clip: int, frame: int) -> Still:
        """Decode one frame.

        Raises
        ------
        CorruptFrameError
            If its bytes are not those that were written.
        """
        at = (clip, frame)
        if at not in self._kept:
            self._kept[at] = self._decode(clip, frame)
            while len(self._kept) > _KEPT_FRAMES:
                self._kept.popitem(last=False)
        self._kept.move_to_end(at)
        return self._kept[at]

    def _decode(self, clip: int, frame: int) -> Still:
        row = checked(self._source.rows[int(self._source.starts[clip]) + frame])
        job = job_of(row)
        layers: dict[str, NDArray[Any]] = {}
        for member, group in self._members.items():
            layers |= self._reader.arrays(row, job, member, group)
        scale = scale_of(self._source.facts(clip))
        counts = layers["thermal"]
        return Still(
            key=job.key(frame),
            layers=layers,
            brightness_K=counts_to_brightness_K(counts, scale),
            measured=counts_to_radiance(counts, scale),
            world_from_camera=row["world_from_camera"].copy(),
            K=row["K"].copy(),
            time_s=float(row["time_s"]),
        )
