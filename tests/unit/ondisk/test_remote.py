"""Datasets behind URLs: the same arrays as from the directory, few requests, nothing stale, errors in one line."""

from __future__ import annotations

import pickle
import shutil
import sys
from pathlib import Path
from types import ModuleType
from typing import Any

import numpy as np
import pytest

import served
from scenegen.foundation.errors import CorruptFrameError, DatasetError, InputError
from scenegen_datasets import PairDataset
from scenegen_datasets.layers import DEFAULT_LAYERS
from scenegen_datasets.remote import is_url
from scenegen_datasets.remote.disk import DiskFiles
from scenegen_datasets.remote.web import WebFiles

LAYERS = (*DEFAULT_LAYERS, "previous_thermal")


@pytest.fixture(autouse=True)
def copies(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    """Copies of small files go here."""
    monkeypatch.setenv("SCENEGEN_CACHE", str(tmp_path / "copies"))
    monkeypatch.setattr("scenegen_datasets.remote.web._WAITS_S", (0.0, 0.0))
    return tmp_path / "copies" / "files"


def same(a: dict[str, Any], b: dict[str, Any]) -> bool:
    return a.keys() == b.keys() and all(np.array_equal(a[k], b[k], equal_nan=k == "flow") for k in a)


def in_memory(root: Path, name: str) -> str:
    import fsspec

    memory = fsspec.filesystem("memory")
    for file in root.rglob("*"):
        if file.is_file():
            memory.pipe_file(f"/{name}/{file.relative_to(root)}", file.read_bytes())
    return f"memory://{name}"


def test_urls_are_told_from_paths() -> None:
    assert all(map(is_url, ("s3://b/d", "hf://datasets/u/n", "https://h/d", "simplecache::gs://b/d")))
    assert not any(map(is_url, ("/data/d", "data/d", "./a:b", "file:///data/d", "C:\\d", Path("s3:/b"))))


def test_every_sample_in_memory_and_over_http_is_that_of_the_directory(pristine: Path) -> None:
    here = PairDataset(pristine, layers=LAYERS)
    order = np.random.default_rng(3).permutation(len(here)).tolist()
    with served.serve(pristine.parent) as place:
        urls = [in_memory(pristine, "same"), f"{place.url}/{pristine.name}/", f"file://{pristine}"]
        for url in urls:
            there = PairDataset(url, layers=LAYERS)
            assert len(there) == len(here) == 18
            for i in order:
                assert same(there[i], here[i])
            assert same(
                PairDataset(url, "val", ["depth"], seq_length=2)[1],
                PairDataset(pristine, "val", ["depth"], 2)[1],
            )


def test_reading_on_takes_few_requests_and_jumping_about_one_a_frame(dataset: Path) -> None:
    with served.serve(dataset) as place:
        pairs = PairDataset(place.url, layers=DEFAULT_LAYERS)
        for _ in pairs:
            pass
        shards = len(list(dataset.rglob("*.tar")))
        assert len(place.shards()) == 2 * shards, "first frame, then all the rest"
        place.asked.clear()
        fresh = PairDataset(place.url, layers=["thermal", "depth"])
        for i in (2, 8, 14):
            fresh[i]
        assert len(place.shards()) == 3, "neighbouring members come in one request"
        assert all(span and span[1] - span[0] < 10_000 for span in place.shards())


def test_memory_of_reading_ahead_is_bounded(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr("scenegen_datasets.remote.web._AHEAD", 1000)
    monkeypatch.setattr("scenegen_datasets.remote.web._MOST_AHEAD", 4000)
    for k in range(12):
        (tmp_path / f"{k}.tar").write_bytes(np.random.default_rng(k).bytes(50_000))
    with served.serve(tmp_path) as place:
        files = WebFiles(place.url, {})
        disk = DiskFiles(tmp_path)
        for start in range(0, 40_000, 500):
            for k in range(12):
                wanted = [(start, 100), (start + 200, 50)]
                assert files.spans(f"{k}.tar", wanted) == disk.spans(f"{k}.tar", wanted)
        assert len(files._blocks) == 8
        assert max(len(block.data) for block in files._blocks.values()) <= 4250
        assert files.spans("0.tar", [(49_990, 100)]) == [(tmp_path / "0.tar").read_bytes()[49_990:]]
        assert files.spans("0.tar", [(0, 10), (49_000, 10)]) == disk.spans("0.tar", [(0, 10), (49_000, 10)])


def test_small_files_are_fetched_once_and_never_stale(dataset: Path, copies: Path, fakes: ModuleType) -> None:
    with served.serve(dataset) as place:
        PairDataset(place.url)
        assert {path for path, _ in place.asked} == {"/dataset.json", "/index.npy", "/clips.jsonl"}
        before = {file.name for file in copies.iterdir()}
        place.asked.clear()
        pairs = PairDataset(place.url)
        assert {path for path, _ in place.asked} == {"/dataset.json"}
        sent = pickle.dumps(pairs)
        assert len(sent) < 2000 and same(pickle.loads(sent)[3], pairs[3])
        fakes.make(dataset, 8)
        assert len(PairDataset(place.url)) == 24
        assert len({file.name for file in copies.iterdir()} - before) == 2
        with pytest.raises(DatasetError, match="changed while it was being read"):
            pickle.loads(sent)


def test_a_copy_that_is_not_what_its_name_says_is_not_kept(dataset: Path, copies: Path) -> None:
    data = bytearray((dataset / "index.npy").read_bytes())
    data[-9] ^= 1
    (dataset / "index.npy").write_bytes(data)
    with served.serve(dataset) as place, pytest.raises(DatasetError, match=r"index\.npy: damaged"):
        PairDataset(place.url)
    assert not list(copies.iterdir())


def test_damage_on_the_way_is_an_error_not_data(dataset: Path) -> None:
    shard = dataset / "shards/train/city-00000/000.tar"
    data = bytearray(shard.read_bytes())
    with served.serve(dataset) as place:
        data[600] ^= 4
        shard.write_bytes(data)
        with pytest.raises(CorruptFrameError, match=r"000-0000\.thermal\.png: damaged"):
            PairDataset(place.url, layers=["previous_thermal"])[0]
        shard.unlink()
        with pytest.raises(CorruptFrameError, match=r"000\.tar"):
            PairDataset(place.url)[0]


def test_what_cannot_be_read_is_told_in_one_line(dataset: Path, tmp_path: Path) -> None:
    with served.serve(dataset, ranges=False) as place, pytest.raises(InputError, match="range requests"):
        PairDataset(place.url)[0]
    with served.serve(dataset) as place:
        pairs = PairDataset(place.url)
    with pytest.raises(DatasetError, match="cannot be reached") as caught:
        pairs[0]
    assert not isinstance(caught.value, CorruptFrameError), (
        "who skips damaged frames must not skip all of them"
    )
    with pytest.raises(DatasetError, match="cannot be reached"):
        PairDataset(place.url)
    (dataset / "dataset.json").unlink()
    with served.serve(dataset) as place:
        with pytest.raises(InputError, match="not whole yet"):
            PairDataset(place.url)
        with pytest.raises(InputError, match="no dataset at http"):
            PairDataset(f"{place.url}/nowhere")
    with pytest.raises(InputError, match="nosuch"):
        PairDataset("nosuch://bucket/dataset")


def test_a_missing_library_is_named(pristine: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setitem(sys.modules, "fsspec.core", None)
    with pytest.raises(InputError, match=r"pip install 'thermal-scenegen\[remote\]'"):
        PairDataset("s3://bucket/dataset")
    assert len(PairDataset(pristine)) == 18


def test_descriptors_close_when_others_are_opened(pristine: Path, tmp_path: Path) -> None:
    for k in range(70):
        shutil.copy(pristine / "dataset.json", tmp_path / f"{k}.json")
    files = DiskFiles(tmp_path)
    first = files._opened("0.json")
    for k in range(1, 70):
        files.spans(f"{k}.json", [(0, 1)])
    assert len(files._open) == 64 and "0.json" not in files._open
    assert DiskFiles(tmp_path).spans("0.json", [(0, 1)]) == [b"{"]
    import os

    assert os.pread(first.descriptor, 1, 0) == b"{", "whoever still reads keeps what it opened"
