"""What a trainer gets: exact arrays, honest indices, sequences inside clips."""

from __future__ import annotations

import io
import pickle
import tarfile
from pathlib import Path
from types import ModuleType

import numpy as np
import pytest

from scenegen.foundation.errors import InputError
from scenegen_datasets import PairDataset
from scenegen_datasets.layers import DEFAULT_LAYERS


def test_every_layer_of_every_pair_is_exact(fakes: ModuleType, pristine: Path) -> None:
    pairs = PairDataset(pristine, layers=[*DEFAULT_LAYERS, "previous_thermal"])
    assert len(pairs) == 18
    for i, sample in enumerate(pairs):
        job, k = fakes.jobs(6)[i // 3], i % 3 + 1
        frames = fakes.truth(job.ordinal)
        frame, reading = frames[k]
        np.testing.assert_array_equal(sample["thermal"], reading.counts)
        np.testing.assert_array_equal(sample["previous_thermal"], frames[k - 1][1].counts)
        for name in DEFAULT_LAYERS:
            if name != "thermal":
                expected = getattr(frame, name)
                assert sample[name].dtype == expected.dtype
                assert sample[name].tobytes() == np.ascontiguousarray(expected).tobytes()
        assert sample["key"] == job.key(k)
        assert (sample["map"], sample["world"], sample["clip"], sample["frame"]) == (
            "city",
            job.world,
            job.clip,
            k,
        )
        assert sample["split"] == job.split
        np.testing.assert_array_equal(sample["world_from_camera"], fakes.meta(k).world_from_camera)
        np.testing.assert_array_equal(sample["K"], fakes.K)
        assert sample["time_s"] == fakes.meta(k).time_s
        assert sample["facts"]["hour"] == fakes.record(job).hour
        assert sample["facts"]["air_mean_K"] == 290.0 + job.ordinal


def test_layers_on_request_come_back(fakes: ModuleType, tmp_path: Path) -> None:
    layers = ("thermal", "normal", "flow_back", "covisible_back")
    root = fakes.make(tmp_path / "d", 1, layers=layers)
    sample = PairDataset(root, layers=layers)[0]
    rng = np.random.default_rng(0)
    frames = [(fakes.frame(rng, extra=True), fakes.reading(rng)) for _ in range(2)]
    for name in layers[1:]:
        assert sample[name].tobytes() == np.ascontiguousarray(getattr(frames[1][0], name)).tobytes()
    with pytest.raises(InputError, match="no layer 'depth'"):
        PairDataset(root)


def test_inertial_samples_come_back_and_sequences_keep_them_apart(fakes: ModuleType, tmp_path: Path) -> None:
    layers = ("thermal", "depth", "imu")
    root = fakes.make(tmp_path / "d", 1, layers=layers)
    assert PairDataset(root, layers=layers)[1]["imu"].tobytes() == fakes.imu(2).tobytes()
    both = PairDataset(root, layers=layers, seq_length=2)[0]
    assert [len(table) for table in both["imu"]] == [10, 11]
    assert both["depth"].shape == (2, *fakes.SHAPE)
    with tarfile.open(root / "shards/train/city-00000/000.tar") as tar:
        stored = tar.extractfile("city-00000-000-0001.imu.npy")
        assert stored is not None
        np.testing.assert_array_equal(np.load(io.BytesIO(stored.read())), fakes.imu(1))


def test_indices_behave_like_those_of_a_list(pristine: Path) -> None:
    pairs = PairDataset(pristine)
    assert pairs[-1]["key"] == pairs[17]["key"]
    assert pairs[-18]["key"] == pairs[0]["key"]
    assert pairs[np.int64(3)]["key"] == pairs[3]["key"]
    for index in (18, -19, 10**9):
        with pytest.raises(IndexError):
            pairs[index]


def test_splits_partition_the_pairs(pristine: Path) -> None:
    keys = {s: {sample["key"] for sample in PairDataset(pristine, s)} for s in ("train", "val", "test")}
    assert {s: len(k) for s, k in keys.items()} == {"train": 6, "val": 6, "test": 6}
    assert set().union(*keys.values()) == {sample["key"] for sample in PairDataset(pristine)}


@pytest.mark.parametrize(
    ("length", "skip", "stride", "frames"),
    [
        (1, 0, 1, [[1], [2], [3], [4], [5], [6], [7]]),
        (1, 0, 3, [[1], [4], [7]]),
        (2, 0, 1, [[1, 2], [2, 3], [3, 4], [4, 5], [5, 6], [6, 7]]),
        (3, 1, 1, [[1, 3, 5], [2, 4, 6], [3, 5, 7]]),
        (3, 1, 2, [[1, 3, 5], [3, 5, 7]]),
        (7, 0, 1, [[1, 2, 3, 4, 5, 6, 7]]),
    ],
)
def test_sequences_never_cross_clips(
    fakes: ModuleType,
    tmp_path_factory: pytest.TempPathFactory,
    length: int,
    skip: int,
    stride: int,
    frames: list[list[int]],
) -> None:
    root = long_clips(fakes, tmp_path_factory)
    found = PairDataset(root, layers=["thermal"], seq_length=length, frame_skip=skip, seq_stride=stride)
    assert len(found) == 2 * len(frames)
    told = [np.atleast_1d(sample["frame"]).tolist() for sample in found]
    assert told == frames + frames
    if length > 1 and frames:
        sample = found[len(frames)]
        assert sample["thermal"].shape == (length, *fakes.SHAPE)
        assert sample["world_from_camera"].shape == (length, 4, 4)
        assert sample["clip"] == 1
        single = PairDataset(root, layers=["thermal"])
        for t, k in enumerate(frames[0]):
            np.testing.assert_array_equal(sample["thermal"][t], single[7 + k - 1]["thermal"])


_LONG: list[Path] = []


def long_clips(fakes: ModuleType, factory: pytest.TempPathFactory) -> Path:
    """Two clips of seven pairs, made once."""
    if not _LONG:
        from scenegen.foundation.lock import DirectoryLock
        from scenegen_datasets.commit import commit_clip
        from scenegen_datasets.finish import finish
        from scenegen_datasets.store import create_or_open

        root = factory.mktemp("long")
        jobs = fakes.jobs(2, pairs=7)
        with DirectoryLock(root):
            create_or_open(root, "x", fakes.lock(14))
            for job in jobs:
                commit_clip(root, fakes.record(job), fakes.encoded(job), fingerprint="f")
            finish(root, jobs)
        _LONG.append(root)
    return _LONG[0]


@pytest.mark.parametrize(
    ("arguments", "reason"),
    [
        ({"split": "trian"}, "perhaps you meant 'train'"),
        ({"layers": ["thermal", "dpeth"]}, "perhaps you meant 'depth'"),
        ({"layers": ["normal"]}, "no layer 'normal'"),
        ({"seq_length": 0}, "seq_length is 0"),
        ({"frame_skip": -1}, "frame_skip is -1"),
        ({"seq_stride": 0}, "seq_stride is 0"),
        ({"layers": ["previous_termal"]}, "perhaps you meant 'previous_thermal'"),
        ({"seq_length": 4}, "takes 4 pairs, and the longest clip of all splits in .* has 3"),
        ({"seq_length": 2, "frame_skip": 2, "split": "val"}, "takes 4 pairs, and the longest clip of val in"),
    ],
)
def test_bad_arguments_are_told(pristine: Path, arguments: dict[str, object], reason: str) -> None:
    with pytest.raises(InputError, match=reason):
        PairDataset(pristine, **arguments)  # type: ignore[arg-type]


def test_a_path_without_a_dataset_is_told(tmp_path: Path) -> None:
    with pytest.raises(InputError, match="no dataset at"):
        PairDataset(tmp_path / "nowhere")


def test_a_growing_dataset_is_readable_on_request(fakes: ModuleType, tmp_path: Path) -> None:
    root = fakes.make(tmp_path / "d", 2, done=False)
    with pytest.raises(InputError, match="allow_partial"):
        PairDataset(root)
    growing = PairDataset(root, allow_partial=True)
    assert len(growing) == 6
    keys = [sample["key"] for sample in growing]
    fakes.make(root, 4, done=False)
    assert [sample["key"] for sample in pickle.loads(pickle.dumps(growing))] == keys, (
        "workers see what the parent saw"
    )
    fakes.make(root, 4)
    finished = PairDataset(root)
    assert [sample["key"] for sample in finished][:6] == keys
    np.testing.assert_array_equal(finished[4]["depth"], growing[4]["depth"])
    (root / fakes.jobs(4)[1].shard).unlink()
    (root / "dataset.json").unlink()
    assert len(PairDataset(root, allow_partial=True)) == 9


def test_an_empty_growing_dataset_is_empty(fakes: ModuleType, tmp_path: Path) -> None:
    from scenegen_datasets.store import create_or_open

    create_or_open(tmp_path, "x", fakes.lock(3))
    assert len(PairDataset(tmp_path, allow_partial=True)) == 0
