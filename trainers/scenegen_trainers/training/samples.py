"""Samples of a dataset as a network is shown them, and the order in which a training draws them."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from copy import copy
from dataclasses import dataclass
from functools import lru_cache
from pathlib import Path
from typing import Any

import numpy as np
import torch
from jaxtyping import Float32, Int64, UInt8

from scenegen.foundation.errors import InputError
from scenegen.foundation.rng import stream
from scenegen_datasets.loader import PREVIOUS, PairDataset
from scenegen_datasets.sensing.retake import Retake
from scenegen_trainers.inputs.knobs import InputKnobs, TargetKnobs
from scenegen_trainers.inputs.look import Look, centred, compose, look
from scenegen_trainers.inputs.target import check_truth, encode
from scenegen_trainers.models.learner import Batch
from scenegen_trainers.training.recipe import TrainingKnobs


@dataclass(frozen=True)
class Draw:
    """One showing of one sample: which, whether mirrored, and in which epoch."""

    index: int
    mirror: bool = False
    epoch: int = 0


@dataclass(frozen=True, eq=False)
class Shown:
    """A sample as a network is shown it.

    Attributes
    ----------
    image : uint8 (channels, rows, columns)
        Composed input.
    depth_m : float32 (rows, columns)
        True depth [m], sky +inf.
    """

    image: UInt8[np.ndarray, "channels rows columns"]
    depth_m: Float32[np.ndarray, "rows columns"]


class Samples:
    """A split of a dataset, sample by sample; a map-style dataset for a torch ``DataLoader``.

    Parameters
    ----------
    root : Path
    split : str
    inputs : InputKnobs
    pairs : int
        So many, evenly spread; 0 takes all.
    keep : bool
        Keep composed inputs in memory: flow is computed once.
    redrawn : Retake, optional
        Senses thermal frames anew at every epoch; nothing is kept then.
    mirror_embedded : bool
        Mirror what is composed, grid and all, instead of composing what is mirrored.

    Raises
    ------
    InputError
        If the dataset cannot be read, lacks a layer, or the split is empty.
    """

    def __init__(
        self,
        root: Path,
        split: str,
        inputs: InputKnobs,
        pairs: int = 0,
        keep: bool = False,
        redrawn: Retake | None = None,
        mirror_embedded: bool = False,
    ) -> None:
        self.inputs, self._mirror_embedded = inputs, mirror_embedded
        self._redrawn = redrawn
        self._dataset = _opened(root, split, inputs, redrawn is not None)
        if len(self._dataset) == 0:
            raise InputError(
                f"{root}: its split '{split}' has no pairs; worlds 1 and 2 of each map become val and test, "
                "so render at least three worlds of each (more --pairs)"
            )
        self.index = spread(len(self._dataset), pairs)
        self._kept: dict[tuple[int, bool], Shown] | None = {} if keep and redrawn is None else None

    def __len__(self) -> int:
        return len(self.index)

    def __getitem__(self, draw: Draw) -> Shown:
        key = (draw.index, draw.mirror)
        if self._kept is None:
            return self._shown(*self._seen(draw), draw.mirror)
        if key not in self._kept:
            seen, depth = self._seen(draw)
            for mirror in (False, True):
                self._kept[draw.index, mirror] = self._shown(seen, depth, mirror)
        return self._kept[key]

    def only(self, index: Sequence[int]) -> Samples:
        """Some of the split, by their index in it."""
        some = copy(self)
        some.index = np.asarray(index, np.int64)
        some._kept = None
        return some

    def raw(self, position: int) -> dict[str, Any]:
        """The dataset's own sample, for those who need more than a network may know."""
        return self._dataset[int(self.index[position])]

    def _shown(self, seen: Look, depth: Float32[np.ndarray, "rows columns"], mirror: bool) -> Shown:
        if not mirror:
            return Shown(compose(seen, self.inputs), depth)
        if self._mirror_embedded:
            return Shown(compose(seen, self.inputs)[..., ::-1], depth[:, ::-1])
        return Shown(compose(seen.mirrored(), self.inputs), depth[:, ::-1])

    def _seen(self, draw: Draw) -> tuple[Look, Float32[np.ndarray, "rows columns"]]:
        sample = self.raw(draw.index)
        if self._redrawn is None:
            now, before = sample["thermal"], sample[PREVIOUS]
            depth, flow = sample["depth"], sample.get("flow_back")
        else:
            before, now = self._redrawn.sense(sample, draw.epoch)
            depth = sample["depth"][1]
            flow = sample["flow_back"][1] if "flow_back" in sample else None
        try:
            check_truth(depth)
            return look(now, before, self.inputs, flow), depth
        except InputError as error:
            raise InputError(f"{sample['key']}: {error}") from None


def batches(
    count: int, knobs: TrainingKnobs, seed: int, first: int, share: slice = slice(None)
) -> Iterator[list[Draw]]:
    """The draws of each step from step `first` on: a pure function of seed and step, so that nothing need be saved.

    Parameters
    ----------
    count : int
        Samples there are; every epoch shows each once, in an order of its own.
    knobs : TrainingKnobs
    seed : int
    first : int
    share : slice
        Which of a step's draws this process takes.
    """
    for step in range(first, knobs.steps):
        mirrors = stream(seed, "mirror", step).random(knobs.batch) < 0.5
        draws = []
        for k, place in enumerate(range(step * knobs.batch, (step + 1) * knobs.batch)):
            epoch, position = divmod(place, count)
            index = int(_order(count, seed, epoch)[position])
            draws.append(Draw(index, bool(knobs.mirror and mirrors[k]), epoch))
        yield draws[share]


def collate(target: TargetKnobs, shown: Sequence[Shown]) -> Batch:
    """Stack samples to a batch on the CPU.

    Raises
    ------
    InputError
        If they differ in size, or true depth is not what it should be.
    """
    if len({s.depth_m.shape for s in shown}) > 1:
        raise InputError("samples of one batch differ in size; a training takes one image size")
    codes, judged = zip(*(encode(np.ascontiguousarray(s.depth_m), target) for s in shown), strict=True)
    return Batch(
        image=torch.from_numpy(centred(np.stack([s.image for s in shown]))),
        code=torch.from_numpy(np.stack(codes)[:, None]),
        judged=torch.from_numpy(np.stack(judged)[:, None]),
        depth_m=torch.from_numpy(np.stack([s.depth_m for s in shown])[:, None]),
    )


def _opened(root: Path, split: str, inputs: InputKnobs, redrawn: bool) -> PairDataset:
    thermal = ("radiance",) if redrawn else ("thermal", PREVIOUS)
    flow = ("flow_back",) if inputs.flow == "truth" else ()
    try:
        return PairDataset(root, split, (*thermal, "depth", *flow), seq_length=2 if redrawn else 1)
    except InputError as error:
        if "holds no layer" in str(error):
            raise InputError(f"{error}; `scenegen render --layers ...` makes one that does") from None
        raise


def spread(count: int, wanted: int) -> Int64[np.ndarray, "samples"]:
    """So many of `count` positions, evenly spread; all for 0."""
    if wanted == 0 or wanted >= count:
        return np.arange(count)
    return np.asarray(np.linspace(0, count - 1, wanted).round(), np.int64)


@lru_cache(maxsize=4)
def _order(count: int, seed: int, epoch: int) -> Int64[np.ndarray, "count"]:
    return stream(seed, "order", epoch).permutation(count)
