"""What an expert asks a dataset at the prompt: what it is, a slice of it, its clips, its camera; none reads a shard."""

from __future__ import annotations

import pickle
from pathlib import Path
from types import ModuleType

import numpy as np
import pytest

from scenegen.foundation.errors import CorruptFrameError, InputError
from scenegen_datasets import PairDataset
from scenegen_datasets.epoch import Epoch
from scenegen_datasets.part import position


def test_a_dataset_says_what_it_is(pristine: Path) -> None:
    pairs = PairDataset(pristine, "val", ("depth", "previous_thermal", "thermal"))
    assert repr(pairs) == (
        f"<PairDataset('{pristine}', 'val'): 6 samples of thermal, depth, previous_thermal, 2 clips>"
    )
    assert pairs.layers == ("thermal", "depth", "previous_thermal")
    assert PairDataset(pristine, layers="depth").layers == ("depth",)
    assert repr(pairs[1:3]) == f"<2 samples of {pairs!r}>" and repr(pairs.clips) == "<2 clips>"


def test_a_slice_is_a_sequence_that_behaves_like_that_of_a_list(pristine: Path) -> None:
    pairs = PairDataset(pristine, layers=("depth",))
    keys = [sample["key"] for sample in pairs]
    for piece in (slice(3, 9), slice(None, None, -2), slice(-4, None), slice(9, 3), slice(2, 99)):
        assert [sample["key"] for sample in pairs[piece]] == keys[piece]
        assert len(pairs[piece]) == len(keys[piece])
    part = pickle.loads(pickle.dumps(pairs[4:16:3]))
    assert [sample["key"] for sample in part[1:]] == keys[4:16:3][1:] and part[-1]["key"] == keys[13]
    assert sorted(Epoch(part, 3)) == [0, 1, 2, 3]
    for index in (4, -5):
        with pytest.raises(IndexError, match=f"no sample {index}: there are 4, 0 to 3"):
            part[index]
    with pytest.raises(IndexError, match="no clip 0: there is none"):
        position(0, 0, "clip")
    with pytest.raises(TypeError):
        pairs[1.0]  # type: ignore[call-overload]


def test_clips_tell_which_samples_are_theirs(pristine: Path) -> None:
    pairs = PairDataset(pristine, "val", ("thermal",), seq_length=2)
    assert [tuple(clip["samples"]) for clip in pairs.clips] == [(0, 1), (2, 3)]
    for clip in pairs.clips:
        for index in clip["samples"]:
            sample = pairs[index]
            assert all(sample[name] == clip[name] for name in ("map", "world", "clip", "split"))
            assert all(clip[name] == value for name, value in sample["facts"].items())
    assert pairs.clips[-1] == pairs.clips[1:][0]


def test_the_camera_of_all_frames(pristine: Path, fakes: ModuleType) -> None:
    pairs = PairDataset(pristine, layers=())
    np.testing.assert_array_equal(pairs.intrinsics, fakes.K)
    np.testing.assert_array_equal(pairs.intrinsics, pairs[7]["K"])
    pairs.intrinsics[0, 0] = 0.0
    np.testing.assert_array_equal(pairs.intrinsics, fakes.K)


def test_cameras_that_differ_and_damaged_rows_are_told(dataset: Path) -> None:
    pairs = PairDataset(dataset)
    clips = pairs.clips  # while all is whole: the check of its type reads any one of them
    heads = pairs._source.heads.copy()
    object.__setattr__(pairs._source, "heads", heads)
    heads["K"][3, 0, 0] += 1.0
    with pytest.raises(InputError, match="take 'K' of each sample"):
        _ = pairs.intrinsics
    heads["map"][0] = b"citx"
    with pytest.raises(CorruptFrameError, match="a row is damaged"):
        clips[0]


def test_poses_cost_no_shard(dataset: Path) -> None:
    for shard in dataset.rglob("*.tar"):
        shard.unlink()
    pairs = PairDataset(dataset, layers=())
    assert [sample["frame"] for sample in pairs] == [1, 2, 3] * 6
    assert set(pairs[0]) == {
        *("key", "map", "world", "clip", "frame", "split", "time_s", "world_from_camera", "K", "facts")
    }
    assert len(pairs.clips) == 6 and pairs.clips[2]["split"] == "val" and len(pairs[::2]) == 9
