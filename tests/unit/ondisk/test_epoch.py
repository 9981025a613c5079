"""The order of samples: the same for the same seed, every sample once, nothing twice, continued exactly."""

from __future__ import annotations

import json
from pathlib import Path

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from scenegen.foundation.errors import InputError
from scenegen_datasets import PairDataset
from scenegen_datasets.epoch import Epoch


class Clips:
    """Something with clips of these many samples."""

    def __init__(self, *samples: int) -> None:
        self.clip_ends = np.cumsum(samples)

    def __len__(self) -> int:
        return int(self.clip_ends[-1])


CLIPS = Clips(7, 0, 5, 9, 1, 8, 3, 6, 7, 4)


@pytest.mark.parametrize("clips_at_once", [0, 1, 3, 50])
@pytest.mark.parametrize("shuffle", [True, False])
@pytest.mark.parametrize("ranks", [1, 3, 4])
def test_ranks_share_the_samples_without_overlap(clips_at_once: int, shuffle: bool, ranks: int) -> None:
    def seen(even: bool) -> list[list[int]]:
        orders = [
            Epoch(CLIPS, 5, shuffle=shuffle, clips_at_once=clips_at_once, rank=r, ranks=ranks, even=even)
            for r in range(ranks)
        ]
        return [list(order) for order in orders]

    uneven, even = seen(False), seen(True)
    assert sorted(i for one in uneven for i in one) == list(range(50))
    assert len({len(order) for order in even}) == 1
    for whole, cut in zip(uneven, even, strict=True):
        assert whole[: len(cut)] == cut or not clips_at_once
    flat = [i for one in even for i in one]
    assert len(set(flat)) == len(flat)
    assert len(flat) >= 50 - ranks + 1 or clips_at_once


def test_passes_differ_and_seeds_differ_and_nothing_else_matters() -> None:
    first = Epoch(CLIPS, 5)
    orders = [list(first) for _ in range(3)]
    assert first.epoch == 3 and len({tuple(o) for o in orders}) == 3
    again = Epoch(range(50), 5)
    assert [list(again) for _ in range(3)] == orders
    assert list(Epoch(CLIPS, 6)) != orders[0]
    assert list(Epoch(CLIPS, 5, shuffle=False)) == list(range(50))


def test_by_clips_each_clip_is_read_on_and_few_are_open() -> None:
    order = list(Epoch(CLIPS, 1, clips_at_once=3))
    clip = np.searchsorted(CLIPS.clip_ends, order, side="right")
    for k in range(10):
        assert (np.diff(np.array(order)[clip == k]) == 1).all()
    first = {k: int(np.flatnonzero(clip == k)[0]) for k in set(clip.tolist())}
    last = {k: int(np.flatnonzero(clip == k)[-1]) for k in set(clip.tolist())}
    for at in range(50):
        assert sum(first[k] <= at <= last[k] for k in first) <= 3
    assert len(set(clip[:8].tolist())) > 1, "clips are mixed"


@pytest.mark.parametrize("clips_at_once", [0, 2])
@pytest.mark.parametrize("stop", [0, 1, 24, 25, 26, 60])
def test_a_saved_position_continues_exactly(clips_at_once: int, stop: int) -> None:
    def order() -> Epoch:
        return Epoch(CLIPS, 9, clips_at_once=clips_at_once, rank=1, ranks=2)

    def taken(epoch: Epoch, count: int) -> list[int]:
        found: list[int] = []
        while len(found) < count:
            for index in epoch:
                found.append(index)
                if len(found) == count:
                    break
        return found

    whole = taken(order(), 80)
    stopped = order()
    assert taken(stopped, stop) == whole[:stop]
    resumed = order()
    resumed.load_state_dict(json.loads(json.dumps(stopped.state_dict())))
    assert taken(resumed, 80 - stop) == whole[stop:]


@settings(max_examples=60, deadline=None)
@given(
    clips=st.lists(st.integers(0, 9), min_size=1, max_size=8).filter(sum),
    seed=st.integers(0, 2**32),
    ranks=st.integers(1, 4),
    at_once=st.integers(0, 3),
    shuffle=st.booleans(),
    taken=st.integers(0, 60),
)
def test_any_rank_goes_on_from_the_position_of_the_first(
    clips: list[int], seed: int, ranks: int, at_once: int, shuffle: bool, taken: int
) -> None:
    """What a checkpoint of many ranks holds: rank 0 alone writes it, all of them read it."""

    def orders() -> list[Epoch]:
        named = {"shuffle": shuffle, "clips_at_once": at_once, "ranks": ranks}
        return [Epoch(Clips(*clips), seed, rank=r, **named) for r in range(ranks)]

    straight, resumed = orders(), orders()
    length = len(straight[0])
    assert {len(order) for order in straight} == {length}
    stop = taken % length if length else 0
    whole = [list(order.order()) for order in straight]
    flat = [index for order in whole for index in order]
    assert len(set(flat)) == len(flat), "no sample in two ranks"
    straight[0].advance(stop) if stop else None
    state = json.loads(json.dumps(straight[0].state_dict()))
    for order, all_of_it in zip(resumed, whole, strict=True):
        order.load_state_dict(state)
        assert list(order) == all_of_it[stop:]
    assert {order.epoch for order in resumed} == {1}, "all ranks begin the next pass together"


def test_a_position_of_other_settings_is_refused() -> None:
    state = Epoch(CLIPS, 9).state_dict()
    for other in (
        Epoch(CLIPS, 8),
        Epoch(range(49), 9),
        Epoch(CLIPS, 9, ranks=2),
        Epoch(CLIPS, 9, even=False),
        Epoch(CLIPS, 9, shuffle=False),
    ):
        with pytest.raises(InputError, match="the position was saved with"):
            other.load_state_dict(state)
    uneven = Epoch(CLIPS, 9, rank=1, ranks=2, even=False)
    with pytest.raises(InputError, match="saved with rank 0"):
        uneven.load_state_dict(Epoch(CLIPS, 9, ranks=2, even=False).state_dict())
    for nothing in ({}, {"epoch": 1, "position": 0}):
        with pytest.raises(InputError, match="no position that `state_dict` gave"):
            Epoch(CLIPS, 9).load_state_dict(nothing)
    with pytest.raises(InputError, match="rank 2 of 2"):
        Epoch(CLIPS, rank=2, ranks=2)
    with pytest.raises(InputError, match="clips_at_once"):
        Epoch(range(3), clips_at_once=2)


def test_a_dataset_tells_where_its_clips_end(pristine: Path) -> None:
    pairs = PairDataset(pristine, "val", ["thermal"])
    assert pairs.clip_ends.tolist() == [0, 0, 3, 6, 6, 6]
    order = list(Epoch(pairs, 2, clips_at_once=2))
    assert sorted(order) == list(range(6))
