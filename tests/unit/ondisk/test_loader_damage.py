"""Damage anywhere is an error, never data."""

from __future__ import annotations

from pathlib import Path
from types import ModuleType

import numpy as np
import pytest

from scenegen.foundation.errors import CorruptFrameError, DatasetError
from scenegen_datasets import PairDataset


def test_any_damage_in_a_shard_is_an_error_never_data(fakes: ModuleType, dataset: Path) -> None:
    """Flip 150 random bits of a shard: a sample is either exactly right or a `CorruptFrameError`."""
    job = fakes.jobs(1)[0]
    path = dataset / job.shard
    data = path.read_bytes()
    frames = fakes.truth(0)
    rng = np.random.default_rng(2)
    refused = 0
    for at in rng.integers(0, len(data), 150):
        flipped = bytearray(data)
        flipped[at] ^= 1 << rng.integers(8)
        path.write_bytes(flipped)
        pairs = PairDataset(dataset, "train", layers=["thermal", "depth", "instance"])
        for k in (1, 2, 3):
            try:
                sample = pairs[k - 1]
            except CorruptFrameError as error:
                assert job.shard in str(error) and job.key(k) in str(error)
                refused += 1
                continue
            assert sample["depth"].tobytes() == frames[k][0].depth.tobytes()
            assert sample["thermal"].tobytes() == frames[k][1].counts.tobytes()
            assert sample["instance"].tobytes() == frames[k][0].instance.tobytes()
    assert refused > 10


def test_any_damage_in_the_index_is_an_error_never_data(dataset: Path) -> None:
    path = dataset / "index.npy"
    data = path.read_bytes()
    clean = [(s["key"], s["time_s"], s["world_from_camera"].tobytes()) for s in PairDataset(dataset)]
    rng = np.random.default_rng(3)
    refused = 0
    for at in rng.integers(0, len(data), 200):
        flipped = bytearray(data)
        flipped[at] ^= 1 << rng.integers(8)
        path.write_bytes(flipped)
        try:
            told = [(s["key"], s["time_s"], s["world_from_camera"].tobytes()) for s in PairDataset(dataset)]
        except DatasetError:
            refused += 1
            continue
        assert told == clean
    assert refused > 150


def test_missing_and_short_shards_are_told(fakes: ModuleType, dataset: Path) -> None:
    a, b = fakes.jobs(2)
    (dataset / a.shard).unlink()
    (dataset / b.shard).write_bytes((dataset / b.shard).read_bytes()[:30_000])
    pairs = PairDataset(dataset, "train")
    with pytest.raises(CorruptFrameError, match=f"{dataset}/{a.shard}: missing .*; run `scenegen verify`"):
        pairs[0]
    with pytest.raises(CorruptFrameError, match=f"{dataset}/{b.shard}: .*; run `scenegen verify`"):
        pairs[5]


def test_a_damaged_clip_list_or_description_is_refused(dataset: Path) -> None:
    for name in ("clips.jsonl", "dataset.json"):
        data = (dataset / name).read_bytes()
        (dataset / name).write_bytes(data.replace(b"2", b"3", 1))
        with pytest.raises(DatasetError, match=name):
            PairDataset(dataset)
        (dataset / name).write_bytes(data)
