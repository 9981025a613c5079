"""The order in which samples are seen: seeded, the same everywhere, divided among ranks, continued where it stopped.

Plain numpy; any loader that takes indices can follow it (`scenegen_datasets.adapters.torch`, Grain, a loop).
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sized
from typing import Any

import numpy as np
from numpy.typing import NDArray

from scenegen.foundation.errors import InputError
from scenegen.foundation.rng import stream


class Epoch:
    """Indices of one rank's samples, pass after pass.

    Iterating yields what is left of the current pass and moves on to the next one; ``len`` is that of a whole pass.

    Parameters
    ----------
    pairs : PairDataset, or anything with a length
    seed : int
        With it, every pass has an order of its own; nothing else enters it.
    shuffle : bool
        False takes the samples as they are stored.
    clips_at_once : int
        0 shuffles everything with everything: right for a dataset on a disk. n > 0 draws an order of clips and goes
        through n of them at a time, each from its beginning to its end: right behind a URL, where reading on is cheap
        and jumping about is not. A batch then mixes n clips.
    rank, ranks : int
        This process, of so many; no sample is seen by two of them in one pass.
    even : bool
        Whether all ranks see equally many samples, as collective training needs; up to ``ranks - 1`` samples are left
        out of a pass then (more with `clips_at_once`, where clips are not divided), others in each.

    Attributes
    ----------
    epoch : int
        Passes that are over.
    position : int
        Samples of the current pass that were handed out.

    Raises
    ------
    InputError
        For a rank that does not exist, or `clips_at_once` of something that has no clips.
    """

    def __init__(
        self,
        pairs: Sized,
        seed: int = 0,
        *,
        shuffle: bool = True,
        clips_at_once: int = 0,
        rank: int = 0,
        ranks: int = 1,
        even: bool = True,
    ) -> None:
        if not 0 <= rank < ranks:
            raise InputError(f"rank {rank} of {ranks} does not exist; ranks count from 0")
        if clips_at_once < 0 or (clips_at_once and not hasattr(pairs, "clip_ends")):
            raise InputError(f"clips_at_once is {clips_at_once}; it takes a PairDataset, and 0 or more")
        self._settings = {
            "seed": seed,
            "samples": len(pairs),
            "shuffle": shuffle,
            "clips_at_once": clips_at_once,
            "rank": rank,
            "ranks": ranks,
            "even": even,
        }
        self._ends: NDArray[np.int64] = np.asarray(getattr(pairs, "clip_ends", [len(pairs)]), np.int64)
        self.epoch, self.position = 0, 0
        self._drawn: tuple[int, NDArray[np.int64]] | None = None

    def __len__(self) -> int:
        return len(self.order())

    def __iter__(self) -> Iterator[int]:
        order = self.order()
        if not len(order):  # more ranks than samples: this pass is over, the next may have some for this rank
            self.finish()
        for index in order[self.position :]:
            self.advance(1)
            yield int(index)

    def order(self) -> NDArray[np.int64]:
        """All indices of the current pass, those handed out included."""
        if self._drawn is None or self._drawn[0] != self.epoch:
            drawn = self._by_clips() if self._settings["clips_at_once"] else self._by_samples()
            self._drawn = self.epoch, drawn
        return self._drawn[1]

    def advance(self, count: int) -> None:
        """Count samples as handed out that somebody took from `order`; behind the last one the next pass begins."""
        self.position += count
        if self.position >= len(self):
            self.finish()

    def finish(self) -> None:
        """Begin the next pass."""
        self.epoch, self.position = self.epoch + 1, 0

    def state_dict(self) -> dict[str, Any]:
        """Where we are, as plain data."""
        return {**self._settings, "epoch": self.epoch, "position": self.position}

    def load_state_dict(self, state: Mapping[str, Any]) -> None:
        """Continue where `state_dict` was taken, on this rank or, with `even`, on any: even ranks move in step.

        Raises
        ------
        InputError
            If it was taken of another dataset or other settings: the continuation would not be exact.
        """
        if not {*self._settings, "epoch", "position"} <= state.keys():
            raise InputError("this is no position that `state_dict` gave; save one, or start a new pass")
        of_any = (
            ("rank",) if self._settings["even"] else ()
        )  # checkpoints hold the position of the first rank
        for name, value in self._settings.items():
            if name not in of_any and state[name] != value:
                raise InputError(
                    f"the position was saved with {name} {state[name]}, this order has {value}; "
                    "use the same settings, or start a new pass"
                )
        self.epoch, self.position = int(state["epoch"]), int(state["position"])

    def _by_samples(self) -> NDArray[np.int64]:
        rank, ranks, count = (self._settings[name] for name in ("rank", "ranks", "samples"))
        order = np.arange(count)
        if self._settings["shuffle"]:
            order = stream(self._settings["seed"], "epoch", self.epoch).permutation(count)
        return order[: count - count % ranks if self._settings["even"] else count][rank::ranks]

    def _by_clips(self) -> NDArray[np.int64]:
        """Deal clips to ranks; each rank lays its clips end to end on a few tracks and draws which track comes next."""
        seed, rank, ranks = (self._settings[name] for name in ("seed", "rank", "ranks"))
        begins = np.concatenate([[0], self._ends[:-1]])
        clips = np.flatnonzero(self._ends > begins)
        if self._settings["shuffle"]:
            clips = stream(seed, "epoch", self.epoch).permutation(clips)
        mine = clips[rank::ranks]
        count = self._settings["clips_at_once"]
        pieces = [np.arange(begins[clip], self._ends[clip]) for clip in mine]
        tracks = [np.concatenate([np.zeros(0, np.int64), *pieces[k::count]]) for k in range(count)]
        turns = np.repeat(np.arange(len(tracks)), [len(track) for track in tracks])
        if self._settings["shuffle"]:
            turns = stream(seed, "epoch", self.epoch, "rank", rank).permutation(turns)
        order = np.zeros(len(turns), np.int64)
        for k, track in enumerate(tracks):
            order[turns == k] = track
        sizes = (self._ends - begins)[clips]
        least = min(int(sizes[k::ranks].sum()) for k in range(ranks))
        return order[:least] if self._settings["even"] else order
