"""Read pairs and sequences as numpy arrays.

Plain ``len`` and ``[]``: works in a torch ``DataLoader`` (spawned workers, shuffling), in Grain, and in a plain loop.
Every byte is checked against its CRC-32 before it is decoded: damage raises `CorruptFrameError`, it never becomes data.
"""

from __future__ import annotations

from collections import OrderedDict
from collections.abc import Iterator, Mapping, Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Any, SupportsIndex, overload

import numpy as np
from numpy.typing import NDArray

from scenegen.foundation.errors import CorruptFrameError, DatasetError, InputError, nearest
from scenegen_datasets.index import checked, job_of
from scenegen_datasets.job import SPLITS, ClipJob
from scenegen_datasets.layers import LAYERS, check_layers, layers_by_member
from scenegen_datasets.part import Clips, Part, position
from scenegen_datasets.reader import ShardReader
from scenegen_datasets.remote import files_at, plain_root
from scenegen_datasets.sample import Sample, facts_of, stacked
from scenegen_datasets.source import Source, open_source

if TYPE_CHECKING:
    from scenegen_datasets.sensing.retake import Retake

PREVIOUS = "previous_thermal"
"""Pseudo-layer: the thermal frame before."""

_FACTS_KEPT = 1024


class PairDataset:
    """A dataset as a sequence of samples: ``len(d)``, ``d[i]`` -> dict of numpy arrays and plain values.

    Parameters
    ----------
    path : str or Path
        A directory, or a URL of a finished dataset: ``s3://``, ``gs://``, ``hf://``, ``https://`` ... (extra `remote`).
    split : str or None
        ``train``, ``val``, ``test``; None for all.
    layers : sequence of str
        Which layers are decoded (`scenegen_datasets.layers.LAYERS`), and ``previous_thermal``; nothing else is read.
    seq_length : int
        Pairs per sample; 1 gives single pairs without a leading axis.
    frame_skip : int
        Frames left out between two of a sequence.
    seq_stride : int
        Frames between the starts of two sequences of one clip. Sequences never cross clips.
    allow_partial : bool
        Read what is there of a dataset that still grows.
    storage_options : mapping, optional
        What fsspec's file system wants to know about a URL: keys, end points.
    retake : scenegen_datasets.sensing.retake.Retake, optional
        Sense ``thermal`` and ``previous_thermal`` again, from stored radiance through this camera.

    Attributes
    ----------
    root : Path or str
        The directory, or the URL.
    split : str or None
    layers : tuple of str
        What a sample holds, in storage order.
    retake : Retake or None
        May be set to another between two samples.

    Raises
    ------
    InputError
        If there is no dataset, it does not hold what is asked for, or no clip is as long as a sequence.

    Notes
    -----
    A sample holds the layers asked for, as (rows, columns) arrays: ``thermal`` and ``previous_thermal`` uint16 counts,
    ``depth`` float32 [m] along the optical axis (z, not the length of the ray; sky is inf), ``flow`` float32
    (rows, columns, 2) [px], ``temperature`` float32 [K], ``radiance`` float32 [W m^-2 sr^-1], ``semantic`` uint8,
    ``instance`` uint32, ``material`` uint16, ``covisible`` bool; see docs/conventions.md. Besides, ``key``, ``map``,
    ``world``, ``clip``, ``frame``, ``split``, ``time_s``, ``world_from_camera`` (4, 4), ``K`` (3, 3), and ``facts``:
    hour, season, sun and weather of the clip. With ``seq_length`` n > 1, everything that belongs to a frame has a
    leading axis of n.
    """

    def __init__(
        self,
        path: str | Path,
        split: str | None = None,
        layers: Sequence[str] = ("thermal", "depth"),
        seq_length: int = 1,
        frame_skip: int = 0,
        seq_stride: int = 1,
        allow_partial: bool = False,
        storage_options: Mapping[str, Any] | None = None,
        retake: Retake | None = None,
    ) -> None:
        if split is not None and split not in SPLITS:
            raise InputError(f"unknown split '{split}'{nearest(split, SPLITS)}")
        for name, value, least in (
            ("seq_length", seq_length, 1),
            ("frame_skip", frame_skip, 0),
            ("seq_stride", seq_stride, 1),
        ):
            if value < least:
                raise InputError(f"{name} is {value}; it must be at least {least}")
        self.root = plain_root(path)
        self.split = split
        asked = (layers,) if isinstance(layers, str) else tuple(layers)
        self._stored = check_layers(asked, besides=(PREVIOUS,))
        self._previous = PREVIOUS in asked
        self.layers = (*self._stored, PREVIOUS) if self._previous else self._stored
        self._skip = frame_skip
        self._steps = np.arange(seq_length) * (frame_skip + 1)
        self._stride = seq_stride
        self._allow_partial = allow_partial
        self._storage_options = storage_options
        self.retake = retake
        self._open()

    def _open(self, source: Source | None = None) -> None:
        files = files_at(self.root, self._storage_options)
        self._source = source or open_source(self.root, self._allow_partial, files)
        self._reader = ShardReader(self.root, files)
        self._facts: OrderedDict[int, dict[str, Any]] = OrderedDict()
        stored = self._source.layers
        wanted = self._needed()
        missing = [x for x in wanted if x not in stored]
        if missing and len(self._source.rows):
            raise InputError(f"{self.root} holds no layer '{missing[0]}'; it holds {', '.join(stored)}")
        self._groups = {
            member: tuple(LAYERS[x] for x in stored if LAYERS[x].member == member)
            for member in layers_by_member(self._stored if self.retake is None else wanted)
        }
        self._count_sequences()

    def _needed(self) -> tuple[str, ...]:
        """Layers that must be stored: a retaken thermal frame comes from radiance."""
        needed = {*self._stored, *(("thermal",) if self._previous else ())}
        if self.retake is not None and "thermal" in needed:
            needed = needed - {"thermal"} | {"radiance"}
        return check_layers(needed)

    def _count_sequences(self) -> None:
        """Sequences per clip, and their running total: sample i is found by bisection, without a list of samples."""
        first = self._source.heads
        span = int(self._steps[-1]) + 1
        pairs = first["frames"].astype(np.int64) - 1
        counts = np.maximum((pairs - span) // self._stride + 1, 0)
        if self.split is not None:
            other = first["split"] != SPLITS.index(self.split)
            counts[other] = pairs[other] = 0
        if pairs.any() and not counts.any():
            raise InputError(
                f"a sequence of {len(self._steps)} (seq_length) with frame_skip {self._skip} takes {span} pairs, "
                f"and the longest clip of {self.split or 'all splits'} in {self.root} has {pairs.max()}"
            )
        self._ends = np.cumsum(counts)

    @property
    def clip_ends(self) -> NDArray[np.int64]:
        """How many samples there are up to the end of each clip, shape (clips,)."""
        return self._ends

    @property
    def clips(self) -> Clips:
        """The clips there are samples of: map, world, hour, weather, ..., and ``samples``, the range of their indices.

        >>> night = [i for clip in pairs.clips if clip["hour"] > 20 for i in clip["samples"]]  # doctest: +SKIP
        """
        return Clips(self._source, self._ends, self._clip_facts)

    @property
    def intrinsics(self) -> NDArray[np.float64]:
        """Camera matrix K (3, 3) [px] of every frame; (0, 0) is the corner of the upper left pixel.

        Raises
        ------
        InputError
            If there is no frame, or their cameras differ: then each sample says its own ``K``.
        """
        heads = self._source.heads
        if not len(heads) or (heads["K"] != heads["K"][0]).any():
            raise InputError(f"{self.root} holds no camera that all frames share; take 'K' of each sample")
        return np.array(checked(heads[0])["K"], np.float64)

    def __repr__(self) -> str:
        split = f", {self.split!r}" if self.split else ""
        held = f"{len(self)} samples of {', '.join(self.layers) or 'poses'}, {len(self.clips)} clips"
        return f"<PairDataset({str(self.root)!r}{split}): {held}>"

    def __len__(self) -> int:
        return int(self._ends[-1]) if len(self._ends) else 0

    def __iter__(self) -> Iterator[Sample]:
        return (self[i] for i in range(len(self)))

    @overload
    def __getitem__(self, index: SupportsIndex) -> Sample: ...
    @overload
    def __getitem__(self, index: slice) -> Part: ...
    def __getitem__(self, index: SupportsIndex | slice) -> Sample | Part:
        """Return one sample, negative indices count from the end; or, of a slice, a sequence that reads when asked.

        Raises
        ------
        IndexError
            Past the end.
        CorruptFrameError
            If the stored bytes are not what was written.
        DatasetError
            If what is behind a URL cannot be reached now.
        """
        if isinstance(index, slice):
            return Part(self, range(len(self))[index])
        at = position(index, len(self))
        clip = int(np.searchsorted(self._ends, at, side="right"))
        before = int(self._ends[clip - 1]) if clip else 0
        first = int(self._source.starts[clip]) + 1 + (at - before) * self._stride
        frames = [self._frame(first + int(step), clip) for step in self._steps]
        sample = frames[0] if len(frames) == 1 else stacked(frames)
        sample["facts"] = self._clip_facts(clip)
        return sample

    def _clip_facts(self, clip: int) -> dict[str, Any]:
        """Facts of a clip; those of the clips seen last are kept."""
        facts = self._facts.get(clip)
        if facts is None:
            facts = self._facts[clip] = facts_of(self._source.facts(clip))
            if len(self._facts) > _FACTS_KEPT:
                self._facts.popitem(last=False)
        return dict(facts)

    def _frame(self, position: int, clip: int) -> Sample:
        row = checked(self._source.rows[position])
        if int(row["frame"]) != position - int(self._source.starts[clip]):
            raise CorruptFrameError(f"{self.root}/index.npy: rows are out of order; run `scenegen verify`")
        job = job_of(row)
        arrays = self._reader.frame(row, job, self._groups)
        if self.retake is not None and (self._previous or "thermal" in self._stored):
            arrays |= self._retaken(self.retake, arrays["radiance"], row, job, position)
        elif self._previous:
            before = checked(self._source.rows[position - 1])
            group = (LAYERS["thermal"],)
            arrays[PREVIOUS] = self._reader.arrays(before, job, "thermal.png", group)["thermal"]
        sample: Sample = {name: arrays[name] for name in self.layers}
        return sample | {
            "key": job.key(int(row["frame"])),
            "map": job.map,
            "world": job.world,
            "clip": job.clip,
            "frame": int(row["frame"]),
            "split": job.split,
            "time_s": float(row["time_s"]),
            "world_from_camera": row["world_from_camera"].copy(),
            "K": row["K"].copy(),
        }

    def _retaken(
        self, retake: Retake, radiance: NDArray[Any], row: np.void, job: ClipJob, position: int
    ) -> dict[str, NDArray[Any]]:
        """Thermal of a frame and of the one before, sensed one after the other."""
        before = checked(self._source.rows[position - 1])
        member = LAYERS["radiance"].member
        stored = self._reader.arrays(before, job, member, self._groups[member])["radiance"]
        times = np.array([before["time_s"], row["time_s"]], np.float64)
        counts = retake.counts(np.stack([stored, radiance]), times, row["K"], job.key(int(row["frame"])))
        return {PREVIOUS: counts[0], "thermal": counts[1]}

    def __getstate__(self) -> dict[str, Any]:
        """Only the arguments travel to another process, which opens index and shards itself.

        A growing dataset travels as it was seen here, so that all workers agree on its length.
        """
        state = {k: v for k, v in self.__dict__.items() if k not in ("_reader", "_facts", "_ends")}
        if isinstance(self._source.rows, np.memmap):
            state["_source"] = self._source.content_id
        return state

    def __setstate__(self, state: dict[str, Any]) -> None:
        self.__dict__.update(state)
        source = state["_source"]
        self._open(source if isinstance(source, Source) else None)
        if not isinstance(source, Source) and self._source.content_id != source:
            raise DatasetError(f"{self.root} changed while it was being read; open it again")
