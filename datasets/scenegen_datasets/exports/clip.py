"""One clip of a dataset, frame by frame, as the formats read it."""

from __future__ import annotations

import hashlib
from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from functools import cached_property
from typing import Any

import numpy as np
from jaxtyping import Float64
from numpy.typing import NDArray

from scenegen.foundation.errors import InputError
from scenegen_datasets.index import checked, job_of
from scenegen_datasets.job import ClipJob
from scenegen_datasets.layers import LAYERS, MEMBERS, check_layers, layers_by_member, member_field
from scenegen_datasets.reader import ShardReader
from scenegen_datasets.source import Source


@dataclass(frozen=True, eq=False)
class Picture:
    """One frame with the layers that were asked for.

    Attributes
    ----------
    frame : int
        Number in its clip; frame 0 is no pair.
    key : str
    time_s : float
        Since the first frame of the clip.
    world_from_camera : float64 (4, 4)
        OpenCV camera to ENU world [m].
    K : float64 (3, 3)
        Pixel centres at half-integers [px].
    arrays : mapping of str to array
        By layer.
    """

    frame: int
    key: str
    time_s: float
    world_from_camera: Float64[np.ndarray, "4 4"]
    K: Float64[np.ndarray, "3 3"]
    arrays: Mapping[str, NDArray[Any]]

    def __getitem__(self, layer: str) -> NDArray[Any]:
        return self.arrays[layer]


def clip_sha256(source: Source, position: int) -> str:
    """SHA-256 of a clip's line in ``clips.jsonl``.

    The line holds all facts of the clip and the hash of its shard, and a format reads nothing else: where the sum is
    the same, so is every byte a format writes of the clip.
    """
    return hashlib.sha256(source.lines[position]).hexdigest()


class Clip:
    """One clip of a finished dataset.

    Parameters
    ----------
    source : Source
    reader : ShardReader
        Of the same dataset.
    position : int
        Of the clip in plan order.

    Attributes
    ----------
    job : ClipJob
    layers : tuple of str
        Layers that are stored.
    sha256 : str
        `clip_sha256`.
    """

    def __init__(self, source: Source, reader: ShardReader, position: int) -> None:
        self._reader, self._source, self._position = reader, source, position
        self._start = int(source.starts[position])
        self.job: ClipJob = job_of(checked(source.rows[self._start]))
        self.layers = source.layers
        self.sha256 = clip_sha256(source, position)

    @cached_property
    def facts(self) -> Mapping[str, Any]:
        """What ``clips.jsonl`` says of it."""
        return self._source.facts(self._position)

    @property
    def shape(self) -> tuple[int, int]:
        """Rows and columns of every frame."""
        row = self._source.rows[self._start]
        return int(row["height_px"]), int(row["width_px"])

    def pictures(self, *layers: str, pairs_only: bool = False) -> Iterator[Picture]:
        """All frames in order, with these layers; every byte is checked.

        Raises
        ------
        InputError
            If a layer is not stored.
        CorruptFrameError
            If stored bytes are not those that were written.
        """
        missing = [name for name in check_layers(layers) if name not in self.layers]
        if missing:
            raise InputError(f"{self.job.name} holds no layer '{missing[0]}'")
        groups = {
            member: tuple(LAYERS[x] for x in self.layers if LAYERS[x].member == member)
            for member in layers_by_member(layers)
        }
        for frame in range(int(pairs_only), self.job.frames):
            row = self._row(frame)
            arrays: dict[str, NDArray[Any]] = {}
            for member, group in groups.items():
                arrays |= self._reader.arrays(row, self.job, member, group)
            yield Picture(
                frame=frame,
                key=self.job.key(frame),
                time_s=float(row["time_s"]),
                world_from_camera=row["world_from_camera"].astype(np.float64),
                K=row["K"].astype(np.float64),
                arrays={name: arrays[name] for name in layers},
            )

    def stored(self, frame: int) -> Iterator[tuple[str, bytes]]:
        """Suffix and bytes of every member of one frame, as they stand in the shard."""
        row = self._row(frame)
        for suffix in MEMBERS:
            if int(row[f"{member_field(suffix)}_size"]):
                yield suffix, self._reader.stored(row, self.job, suffix)

    def _row(self, frame: int) -> np.void:
        return checked(self._source.rows[self._start + frame])
