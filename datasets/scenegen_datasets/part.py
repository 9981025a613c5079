"""Pieces of a dataset that cost nothing until they are read: a slice of its samples, and the table of its clips."""

from __future__ import annotations

import operator
from collections.abc import Callable, Iterator, Sequence
from typing import TYPE_CHECKING, Any, SupportsIndex, overload

import numpy as np
from numpy.typing import NDArray

from scenegen_datasets.index import checked, job_of
from scenegen_datasets.sample import Sample

if TYPE_CHECKING:
    from scenegen_datasets.loader import PairDataset
    from scenegen_datasets.source import Source


class Part:
    """What ``pairs[10:50:2]`` gives: some of the samples, as a sequence that reads nothing before it is asked.

    Parameters
    ----------
    pairs : PairDataset
    indices : range
        Of the samples in it.
    """

    def __init__(self, pairs: PairDataset, indices: range) -> None:
        self._pairs, self._indices = pairs, indices

    def __len__(self) -> int:
        return len(self._indices)

    def __iter__(self) -> Iterator[Sample]:
        return (self._pairs[i] for i in self._indices)

    @overload
    def __getitem__(self, index: SupportsIndex) -> Sample: ...
    @overload
    def __getitem__(self, index: slice) -> Part: ...
    def __getitem__(self, index: SupportsIndex | slice) -> Sample | Part:
        """One sample, or a part of the part; errors as those of the dataset."""
        if isinstance(index, slice):
            return Part(self._pairs, self._indices[index])
        return self._pairs[self._indices[position(index, len(self))]]

    def __repr__(self) -> str:
        return f"<{len(self)} samples of {self._pairs!r}>"


class Clips(Sequence[dict[str, Any]]):
    """The clips a dataset has samples of, in their order; each is looked up when it is asked for.

    A clip is a dict: ``map``, ``world``, ``clip``, ``split``, ``samples`` (a range of indices of the dataset), and
    its facts: season, hour, sun, speed and weather, as in every sample.

    Parameters
    ----------
    source : Source
    ends : int64 (clips,)
        Samples up to the end of each clip of the source.
    facts : callable
        Facts of the clip at a position of the source.
    """

    def __init__(
        self, source: Source, ends: NDArray[np.int64], facts: Callable[[int], dict[str, Any]]
    ) -> None:
        self._source, self._ends, self._facts = source, ends, facts
        self._chosen = np.flatnonzero(np.diff(ends, prepend=0))

    def __len__(self) -> int:
        return len(self._chosen)

    @overload
    def __getitem__(self, index: SupportsIndex) -> dict[str, Any]: ...
    @overload
    def __getitem__(self, index: slice) -> list[dict[str, Any]]: ...
    def __getitem__(self, index: SupportsIndex | slice) -> dict[str, Any] | list[dict[str, Any]]:
        """One clip, or a list of them.

        Raises
        ------
        IndexError
            Past the end.
        DatasetError
            If what is stored of the clip is damaged.
        """
        if isinstance(index, slice):
            return [self[k] for k in range(*index.indices(len(self)))]
        at = int(self._chosen[position(index, len(self), "clip")])
        job = job_of(checked(self._source.heads[at]))
        samples = range(int(self._ends[at - 1]) if at else 0, int(self._ends[at]))
        place = {"map": job.map, "world": job.world, "clip": job.clip, "split": job.split}
        return {**place, "samples": samples, **self._facts(at)}

    def __repr__(self) -> str:
        return f"<{len(self)} clips>"


def position(index: SupportsIndex, length: int, what: str = "sample") -> int:
    """Where an index points, counted from the end if it is negative.

    Raises
    ------
    IndexError
        If there is no such place.
    TypeError
        If it is no whole number.
    """
    at = operator.index(index)
    if not -length <= at < length:
        held = f"there are {length}, 0 to {length - 1}" if length else "there is none"
        raise IndexError(f"no {what} {at}: {held}")
    return at % length
