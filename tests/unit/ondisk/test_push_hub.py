"""Pushed to a Hub over HTTP by `huggingface_hub` itself, and read back by three readers: ours, fsspec's, `datasets`."""

from __future__ import annotations

import json
import os
import subprocess
import sys
from collections.abc import Iterator
from pathlib import Path
from types import ModuleType

import numpy as np
import pytest

import hub as hubs
from scenegen.foundation.errors import DatasetError, InputError
from scenegen_datasets import PairDataset
from scenegen_datasets.push import Pushed, push

pytest.importorskip("huggingface_hub")
pytestmark = pytest.mark.filterwarnings("ignore:Use .content=:DeprecationWarning")  # of huggingface_hub

URL = "hf://datasets/somebody/night-city"
NAME = "somebody/night-city"


@pytest.fixture
def hub(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Iterator[hubs.Hub]:
    monkeypatch.setenv("SCENEGEN_CACHE", str(tmp_path / "copies"))
    monkeypatch.setattr("huggingface_hub.constants.HF_HUB_DISABLE_XET", True)
    monkeypatch.setattr("huggingface_hub.constants.HF_HUB_CACHE", str(tmp_path / "hub"))
    monkeypatch.setattr("scenegen_datasets.remote.web._WAITS_S", ())
    from huggingface_hub.utils import disable_progress_bars, enable_progress_bars

    disable_progress_bars()
    with hubs.serve_hub() as served:
        yield served
    enable_progress_bars()


def options(hub: hubs.Hub, token: str = hubs.TOKEN) -> dict[str, str]:
    return {"endpoint": hub.url, "token": token}


def pushed(root: Path, hub: hubs.Hub, url: str = URL, private: bool = False) -> Pushed:
    return push(root, url, options=options(hub), private=private)


def files(root: Path) -> dict[str, bytes]:
    return {str(p.relative_to(root)): p.read_bytes() for p in root.rglob("*") if p.is_file()}


def test_what_arrives_is_the_dataset_and_is_sent_once(pristine: Path, hub: hubs.Hub) -> None:
    assert pushed(pristine, hub, private=True).sent == len(files(pristine))
    there = hub.repositories[NAME]
    assert there.private
    assert {k: v for k, v in there.branches["main"].items() if k != ".gitattributes"} == files(pristine)
    assert there.commits[0] == ("Add recipe.lock.json", ["recipe.lock.json"])
    assert [names for _, names in there.commits[-2:]] == [["MANIFEST.sha256"], ["dataset.json"]]
    commits = len(there.commits)
    assert pushed(pristine, hub).sent == 0 and len(there.commits) == commits


def test_a_cut_push_is_no_dataset_and_goes_on(
    pristine: Path, hub: hubs.Hub, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr("scenegen_datasets.push._BATCH_FILES", 4)
    total = len(files(pristine))
    for commits in (1, 3):
        made = len(hub.repositories[NAME].commits) if NAME in hub.repositories else 0
        hub.refuses = lambda method, path, most=made + commits: (
            "/commit/" in path and len(hub.repositories[NAME].commits) >= most
        )
        with pytest.raises(DatasetError, match=r"^hf://datasets/somebody/night-city: cannot be reached"):
            pushed(pristine, hub)
        with pytest.raises(InputError, match="not whole yet"):
            PairDataset(URL, storage_options=options(hub))
    hub.refuses = lambda method, path: False
    assert pushed(pristine, hub).sent == total - 1 - 3 * 4
    assert len(PairDataset(URL, storage_options=options(hub))) == 18


def test_growing_hides_the_old_state_and_keeps_old_clips(
    fakes: ModuleType, tmp_path: Path, hub: hubs.Hub
) -> None:
    root = fakes.make(tmp_path / "d", 2)
    pushed(root, hub)
    there = hub.repositories[NAME]
    there.commits.clear()
    fakes.make(root, 3)
    pushed(root, hub)
    assert there.commits[0] == ("Remove dataset.json", ["-dataset.json"])
    assert not any("city-00000/000" in path for _, names in there.commits for path in names)
    assert len(PairDataset(URL, storage_options=options(hub))) == 9


def test_a_branch_is_a_place_of_its_own(pristine: Path, hub: hubs.Hub) -> None:
    pushed(pristine, hub, f"{URL}@v1.0.0")
    there = hub.repositories[NAME]
    assert "dataset.json" in there.branches["v1.0.0"] and set(there.branches["main"]) == {".gitattributes"}
    assert len(PairDataset(f"{URL}@v1.0.0", storage_options=options(hub))) == 18


def test_what_goes_wrong_is_told_in_one_line(pristine: Path, hub: hubs.Hub) -> None:
    for url in ("hf://datasets/alone", "hf://somebody/model", "hf://datasets/a/b/c"):
        with pytest.raises(InputError, match="write hf://datasets/USER/NAME"):
            pushed(pristine, hub, url)
    with pytest.raises(DatasetError, match=r"401.*check the URL and your access") as told:
        push(pristine, URL, options=options(hub, "hf_of_somebody_else"))
    assert "\n" not in str(told.value)
    with pytest.raises((InputError, DatasetError)) as told:
        PairDataset(URL, storage_options=options(hub))
    assert "\n" not in str(told.value)


def test_random_and_streaming_reads_are_those_of_the_directory(pristine: Path, hub: hubs.Hub) -> None:
    pushed(pristine, hub)
    layers = ("thermal", "depth", "flow", "previous_thermal")
    here = PairDataset(pristine, layers=layers)
    there = PairDataset(URL, layers=layers, storage_options=options(hub))
    for order in (np.random.default_rng(1).permutation(18).tolist(), range(18)):
        for i in order:
            for name in layers:
                np.testing.assert_array_equal(there[i][name], here[i][name])


def test_load_dataset_takes_splits_and_shards_from_the_card(
    pristine: Path, hub: hubs.Hub, tmp_path: Path
) -> None:
    pytest.importorskip("datasets.arrow_dataset")
    pushed(pristine, hub)
    code = f"""
import datasets, json, numpy as np
datasets.disable_progress_bars()
whole = datasets.load_dataset({NAME!r})
row = next(iter(datasets.load_dataset({NAME!r}, split="validation", streaming=True)))
print(json.dumps([{{k: len(v) for k, v in whole.items()}}, row["__key__"], np.asarray(row["depth.tiff"]).tolist()]))
"""
    home = {"HF_ENDPOINT": hub.url, "HF_HOME": str(tmp_path / "hf"), "HF_HUB_DISABLE_XET": "1"}
    done = subprocess.run([sys.executable, "-c", code], env={**os.environ, **home}, capture_output=True)
    assert done.returncode == 0, done.stderr.decode()
    splits, key, depth = json.loads(done.stdout)
    assert splits == {"train": 8, "validation": 8, "test": 8}
    assert key == "city-00001-000-0000"
    assert np.asarray(depth, np.float32).shape == (12, 16)
