"""How a loader travels: light to import, small to send, opened once per process; and what others read."""

from __future__ import annotations

import pickle
import subprocess
import sys
from pathlib import Path
from types import ModuleType

import numpy as np
import pytest

from scenegen.foundation.errors import DatasetError
from scenegen_datasets import PairDataset
from scenegen_datasets.index import ROW, open_index, write_index


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


def test_an_index_of_a_million_rows_is_mapped_not_read(tmp_path: Path) -> None:
    path = tmp_path / "index.npy"
    rows = np.zeros(10_000, ROW)
    rows["frame"] = np.arange(10_000) % 65
    write_index(path, (rows for _ in range(100)), 1_000_000)
    mapped = open_index(path, 1_000_000)
    assert isinstance(mapped, np.memmap) and not mapped.flags.writeable
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
    frame, reading = fakes.truth(1)[1]
    assert count == 8 and key == "city-00000-001-0001"
    assert {"thermal.png", "depth.tiff", "flow.exr", "truth.exr", "json"} <= set(columns)
    np.testing.assert_array_equal(thermal, reading.counts)  # type: ignore[attr-defined]
    np.testing.assert_array_equal(np.float32(depth), frame.depth)  # type: ignore[attr-defined]
    assert json.loads(lines[1]) == {"train": 8, "validation": 8, "test": 8}
