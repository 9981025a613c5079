"""What a trainer gets: exact arrays, honest indices, sequences inside clips, errors instead of wrong data."""

from __future__ import annotations

import io
import pickle
import subprocess
import sys
import tarfile
import time
from pathlib import Path
from types import ModuleType

import numpy as np
import pytest

from scenegen.foundation.errors import CorruptFrameError, DatasetError, InputError
from scenegen_datasets import PairDataset
from scenegen_datasets.index import ROW, open_index, write_index
from scenegen_datasets.layers import DEFAULT_LAYERS


def truth(fakes: ModuleType, clip: int) -> list[tuple[object, object]]:
    """Frames and readings of one clip, drawn again as `fakes.encoded` drew them."""
    rng = np.random.default_rng(clip)
    return [(fakes.frame(rng), fakes.reading(rng)) for _ in range(fakes.PAIRS + 1)]


def test_every_layer_of_every_pair_is_exact(fakes: ModuleType, pristine: Path) -> None:
    pairs = PairDataset(pristine, layers=[*DEFAULT_LAYERS, "previous_thermal"])
    assert len(pairs) == 18
    for i, sample in enumerate(pairs):
        job, k = fakes.jobs(6)[i // 3], i % 3 + 1
        frames = truth(fakes, job.ordinal)
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
        (8, 0, 1, []),
        (2, 9, 1, []),
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


def test_any_damage_in_a_shard_is_an_error_never_data(fakes: ModuleType, dataset: Path) -> None:
    """Flip 150 random bits of a shard: a sample is either exactly right or a `CorruptFrameError`."""
    job = fakes.jobs(1)[0]
    path = dataset / job.shard
    data = path.read_bytes()
    frames = truth(fakes, 0)
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
            assert sample["depth"].tobytes() == frames[k][0].depth.tobytes()  # type: ignore[attr-defined]
            assert sample["thermal"].tobytes() == frames[k][1].counts.tobytes()  # type: ignore[attr-defined]
            assert sample["instance"].tobytes() == frames[k][0].instance.tobytes()  # type: ignore[attr-defined]
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
    with pytest.raises(CorruptFrameError, match=a.shard):
        pairs[0]
    with pytest.raises(CorruptFrameError, match=b.shard):
        pairs[5]


def test_a_damaged_clip_list_or_description_is_refused(dataset: Path) -> None:
    for name in ("clips.jsonl", "dataset.json"):
        data = (dataset / name).read_bytes()
        (dataset / name).write_bytes(data.replace(b"2", b"3", 1))
        with pytest.raises(DatasetError, match=name):
            PairDataset(dataset)
        (dataset / name).write_bytes(data)


def test_importing_the_loader_is_light() -> None:
    """No renderer, no torch, no codecs, no pydantic until a frame is read or a plan is made."""
    code = "import sys, scenegen_datasets; print(*sorted({m.split('.')[0] for m in sys.modules}))"
    loaded = subprocess.run(
        [sys.executable, "-c", code], capture_output=True, text=True, check=True
    ).stdout.split()
    ours = {"numpy", "scenegen", "scenegen_datasets"}
    foreign = {
        m for m in loaded if m not in sys.stdlib_module_names and m not in ours and not m.startswith("_")
    }
    editable = {m for m in foreign if m in ("site", "distutils-precedence", "sitecustomize", "usercustomize")}
    assert foreign - editable == set()


@pytest.mark.slow
def test_a_torch_loader_with_spawned_workers_shuffles_and_collates(pristine: Path) -> None:
    torch = pytest.importorskip("torch")
    pairs = PairDataset(
        pristine, layers=["thermal", "depth", "flow", "semantic", "instance", "material", "covisible"]
    )
    shuffled = torch.utils.data.DataLoader(
        pairs,
        batch_size=5,
        shuffle=True,
        num_workers=2,
        multiprocessing_context="spawn",
        generator=torch.Generator().manual_seed(0),
    )
    seen = []
    for batch in shuffled:
        seen += batch["key"]
        assert batch["depth"].dtype == torch.float32
        assert batch["thermal"].dtype == torch.uint16
        assert batch["instance"].dtype == torch.uint32
        assert batch["covisible"].dtype == torch.bool
        assert batch["flow"].shape[1:] == (12, 16, 2)
        assert batch["world_from_camera"].shape[1:] == (4, 4)
        assert batch["facts"]["hour"].dtype == torch.float64
        for key, depth in zip(batch["key"], batch["depth"], strict=True):
            mine = next(s for s in pairs if s["key"] == key)
            np.testing.assert_array_equal(depth.numpy(), mine["depth"])
    ordered = [s["key"] for s in pairs]
    assert sorted(seen) == sorted(ordered) and seen != ordered


def test_a_pickled_dataset_is_small_and_opens_its_own_files(pristine: Path) -> None:
    pairs = PairDataset(pristine, "val", seq_length=2)
    pairs[0]
    data = pickle.dumps(pairs)
    other = pickle.loads(data)
    assert len(data) < 10_000
    assert len(other) == len(pairs) == 4
    np.testing.assert_array_equal(other[3]["depth"], pairs[3]["depth"])


def test_no_descriptor_is_leaked(fakes: ModuleType, pristine: Path) -> None:
    before = len(list(Path("/proc/self/fd").iterdir()))
    for _ in range(3):
        list(PairDataset(pristine))
    assert len(list(Path("/proc/self/fd").iterdir())) <= before + 1


def test_an_index_of_a_million_rows_opens_at_once(tmp_path: Path) -> None:
    path = tmp_path / "index.npy"
    rows = np.zeros(10_000, ROW)
    rows["frame"] = np.arange(10_000) % 65
    write_index(path, (rows for _ in range(100)), 1_000_000)
    start = time.process_time()
    mapped = open_index(path, 1_000_000)
    assert time.process_time() - start < 0.02
    assert int(mapped[999_999]["frame"]) == rows["frame"][-1]
    np.testing.assert_array_equal(np.load(path, mmap_mode="r")[-5:]["frame"], rows["frame"][-5:])
    with pytest.raises(DatasetError, match="not an index of 999999 frames"):
        open_index(path, 999_999)
    path.unlink()


def test_others_read_a_shard_too(fakes: ModuleType, pristine: Path, tmp_path: Path) -> None:
    """Hugging Face `datasets`, offline, through the card's own globs."""
    pytest.importorskip("datasets.arrow_dataset")
    code = f"""
import numpy as np, datasets, json
datasets.disable_progress_bars()
files = {{"train": {str(pristine)!r} + "/shards/train/*/*.tar"}}
d = datasets.load_dataset("webdataset", data_files=files, split="train", cache_dir={str(tmp_path)!r})
row = d[5]
print(json.dumps([len(d), row["__key__"], sorted(d.column_names),
    np.asarray(row["thermal.png"]).astype(int).tolist(), np.asarray(row["depth.tiff"]).astype(float).tolist()]))
whole = datasets.load_dataset({str(pristine)!r}, cache_dir={str(tmp_path)!r})
print(json.dumps({{k: len(v) for k, v in whole.items()}}))
"""
    env = {"HF_HUB_OFFLINE": "1", "HF_HOME": str(tmp_path), "PATH": "/usr/bin:/bin"}
    out = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, cwd=tmp_path, env=env)
    assert out.returncode == 0, out.stderr[-2000:]
    import json

    lines = [line for line in out.stdout.splitlines() if line.startswith(("[", "{"))]
    count, key, columns, thermal, depth = json.loads(lines[0])
    frame, reading = truth(fakes, 1)[1]
    assert count == 8 and key == "city-00000-001-0001"
    assert {"thermal.png", "depth.tiff", "flow.exr", "truth.exr", "json"} <= set(columns)
    np.testing.assert_array_equal(thermal, reading.counts)  # type: ignore[attr-defined]
    np.testing.assert_array_equal(np.float32(depth), frame.depth)  # type: ignore[attr-defined]
    assert json.loads(lines[1]) == {"train": 8, "validation": 8, "test": 8}
