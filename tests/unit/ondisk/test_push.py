"""Pushed datasets: whole or not there, resumed where they stopped, checked on arrival, never mixed with others."""

from __future__ import annotations

import json
import shutil
from collections.abc import Sequence
from pathlib import Path
from types import ModuleType
from typing import Any

import numpy as np
import pytest

from scenegen.foundation.errors import DatasetError, InputError
from scenegen_cli.main import main
from scenegen_datasets import PairDataset
from scenegen_datasets.push import push
from scenegen_datasets.push.storage import StorageTarget
from scenegen_datasets.verify import verify

pytest.importorskip("fsspec")


@pytest.fixture(autouse=True)
def quiet(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv("SCENEGEN_CACHE", str(tmp_path / "copies"))
    monkeypatch.setattr("scenegen_datasets.remote.web._WAITS_S", ())


class Watched(StorageTarget):
    """Storage that breaks after so many files, and remembers what it was asked."""

    def __init__(self, url: str, breaks_after: int = 10**9) -> None:
        super().__init__(url, {})
        self.asked: list[str] = []
        self.left = breaks_after

    def send(self, root: Path, items: Sequence[Any]) -> None:
        for item in items:
            if not self.left:
                raise DatasetError("the line is cut")
            self.left -= 1
            self.asked.append(item.path)
            super().send(root, [item])

    def remove(self, paths: Sequence[str]) -> None:
        self.asked += [f"-{path}" for path in paths]
        super().remove(paths)


def files(root: Path) -> dict[str, bytes]:
    return {str(p.relative_to(root)): p.read_bytes() for p in root.rglob("*") if p.is_file()}


def test_a_pushed_dataset_is_the_dataset(pristine: Path, tmp_path: Path) -> None:
    url = f"file://{tmp_path}/there"
    done = push(pristine, url)
    assert done.sent == done.files == len(files(pristine)) and done.removed == 0
    assert files(tmp_path / "there") == files(pristine)
    assert verify(tmp_path / "there").ok
    again = push(pristine, url)
    assert again.sent == again.sent_bytes == 0 and again.bytes == done.bytes
    np.testing.assert_array_equal(PairDataset(url)[4]["depth"], PairDataset(pristine)[4]["depth"])


def test_memory_and_the_command_line(pristine: Path, capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["push", str(pristine), "memory://pushed/by-command", "--json"]) == 0
    told = json.loads(capsys.readouterr().out)
    assert told["sent"] == told["files"] and told["url"] == "memory://pushed/by-command"
    assert len(PairDataset("memory://pushed/by-command")) == 18
    assert main(["push", str(pristine), "memory://pushed/by-command"]) == 0
    assert "all of it was there; checked" in capsys.readouterr().out


def test_a_cut_push_is_not_taken_for_a_dataset_and_goes_on(pristine: Path) -> None:
    url = "memory://cut/short"
    count = len(files(pristine))
    sent = 0
    for breaks_after in (0, 1, 5, count - sent - 8):
        with pytest.raises(DatasetError, match="cut"):
            push(pristine, url, target=Watched(url, breaks_after))
        sent += breaks_after
        with pytest.raises(InputError, match=r"no dataset|not whole"):
            PairDataset(url)
    last = Watched(url)
    done = push(pristine, url, target=last)
    assert done.sent == count - sent and last.asked[-2:] == ["MANIFEST.sha256", "dataset.json"]
    assert len(PairDataset(url)) == 18


def test_growing_sends_what_is_new_and_hides_the_old_state_first(
    fakes: ModuleType, pristine: Path, tmp_path: Path
) -> None:
    url = "memory://grown/up"
    root = fakes.make(tmp_path / "d", 2)
    push(root, url)
    fakes.make(root, 4)
    target = Watched(url, 3)
    with pytest.raises(DatasetError, match="cut"):
        push(root, url, target=target)
    assert target.asked[0] == "-dataset.json"
    with pytest.raises(InputError, match="not whole"):
        PairDataset(url)
    target = Watched(url)
    push(root, url, target=target)
    assert not [path for path in target.asked if "city-00000" in path], "old clips stay as they are"
    assert len(PairDataset(url)) == 12


def test_what_does_not_belong_is_removed_and_damage_there_is_mended(pristine: Path, tmp_path: Path) -> None:
    there = tmp_path / "there"
    push(pristine, f"file://{there}")
    (there / "shards/train/city-00009").mkdir()
    shutil.copy(there / "shards/train/city-00000/000.tar", there / "shards/train/city-00009/000.tar")
    shard = there / "shards/val/city-00001/000.tar"
    data = bytearray(shard.read_bytes())
    data[700] ^= 1
    shard.write_bytes(data)
    assert push(pristine, f"file://{there}", quick=True).removed == 1
    done = push(pristine, f"file://{there}")
    assert (done.sent, done.removed) == (2, 0)
    assert files(there) == files(pristine)


def test_damage_here_is_not_sent(dataset: Path) -> None:
    shard = dataset / "shards/val/city-00001/000.tar"
    data = bytearray(shard.read_bytes())
    data[700] ^= 1
    shard.write_bytes(data)
    with pytest.raises(DatasetError, match=r"001/000\.tar: damaged; run `scenegen repair`"):
        push(dataset, "memory://damaged/here")
    with pytest.raises(InputError):
        PairDataset("memory://damaged/here")


def test_what_arrives_wrong_is_noticed(pristine: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    class Lossy(Watched):
        def send(self, root: Path, items: Sequence[Any]) -> None:
            super().send(root, items)
            for item in items:
                if item.path.endswith("000.tar"):
                    self._fs.pipe_file(self._place(item.path), bytes(item.size))

    with pytest.raises(DatasetError, match="did not arrive as it was sent"):
        push(pristine, "memory://lossy/line", target=Lossy("memory://lossy/line"))
    with pytest.raises(InputError, match="not whole"):
        PairDataset("memory://lossy/line")


def test_places_that_hold_something_else_are_left_alone(
    fakes: ModuleType, pristine: Path, tmp_path: Path
) -> None:
    (tmp_path / "full").mkdir()
    (tmp_path / "full/thesis.pdf").write_bytes(b"x")
    with pytest.raises(InputError, match=r"something else \(thesis\.pdf\)"):
        push(pristine, f"file://{tmp_path}/full")
    other = shutil.copytree(pristine, tmp_path / "other")
    lock = json.loads((other / "recipe.lock.json").read_bytes())
    (other / "recipe.lock.json").write_text(json.dumps({**lock, "recipe_id": "0" * 64}))
    with pytest.raises(InputError, match="another dataset"):
        push(pristine, f"file://{other}")
    for url in ("there", "http://host/d", "hf://datasets/alone", "nosuch://x/y"):
        with pytest.raises(InputError):
            push(pristine, url)
    with pytest.raises(InputError, match="not finished"):
        push(fakes.make(tmp_path / "growing", 1, done=False), "memory://x")
