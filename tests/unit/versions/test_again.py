"""Merged and sensed datasets are repaired from their locks alone; the renderer is played by hand-made clips.

`tests/system/test_made_again.py` does the same with the real one.
"""

from __future__ import annotations

import shutil
from collections.abc import Callable
from pathlib import Path
from types import ModuleType
from typing import Any

import pytest

from scenegen.foundation.canonical import pretty
from scenegen.foundation.errors import DatasetError, InputError
from scenegen_cli.main import main
from scenegen_datasets.receipt import read_receipt, receipt_paths, shard_of
from scenegen_datasets.repair.again import planned
from scenegen_datasets.repair.repair import repair
from scenegen_datasets.sensing.run import sense_dataset
from scenegen_datasets.store import read_lock
from scenegen_datasets.verify import verify
from scenegen_datasets.verify.rerender import rerender
from scenegen_datasets.versions.merge import merge

PARTS = (("a", "city", 0), ("b", "field", 0), ("c", "city", 7))
"""Name, map and seed."""


@pytest.fixture(scope="module")
def whole(make_map: Callable[..., Path], tmp_path_factory: pytest.TempPathFactory) -> Path:
    """City by seeds 0 and 7, field by seed 0; merged in two steps. The parts are gone."""
    base = tmp_path_factory.mktemp("whole")
    roots = [make_map(base / name, map, 4, seed=seed) for name, map, seed in PARTS]
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr("scenegen_datasets.versions.merge.write_preview", lambda _: None)
        merge(base / "two", roots[:2], copy=True)
        merge(base / "all", [roots[2], base / "two"], copy=True)
    for root in (*roots, base / "two"):
        shutil.rmtree(root)
    return base / "all"


def flip(root: Path, receipt: str, member: str = "depth.tiff") -> None:
    path = root / shard_of(receipt)
    data = bytearray(path.read_bytes())
    data[read_receipt(root, receipt).frames[1].members[member].offset + 20] ^= 4
    path.write_bytes(data)


def test_the_plan_of_a_merged_dataset_is_what_it_holds(whole: Path, studio: list[str]) -> None:
    jobs = planned(whole, read_lock(whole))
    assert sorted(job.receipt for job in jobs) == receipt_paths(whole)
    assert [read_receipt(whole, job.receipt).clip.job for job in jobs] == list(jobs)


def test_every_kind_of_damage_to_a_merged_dataset_is_repaired_to_the_byte(
    fakes: ModuleType, whole: Path, tmp_path: Path, studio: list[str]
) -> None:
    root = shutil.copytree(whole, tmp_path / "all")
    first, second, *_, last = (path for path in receipt_paths(root) if "city" in path)
    flip(root, last)
    flip(root, last, "json")
    (root / shard_of(second)).unlink()
    (root / first).unlink()
    (root / "recipe.yaml").write_text("lost")
    (root / "index.npy").unlink()
    done = repair(root, 1)
    assert done.after.ok and not done.failed and not done.rewritten
    assert done.remade == ("city-00000-000", "city-00000-001", "city-07001-001")
    assert studio == ["city-00000-000", "city-00000-001", "city-00001-001"], "by their own names"
    assert fakes.tree(root) == fakes.tree(whole)


def test_an_unfinished_whole_is_for_the_command_that_makes_it(
    whole: Path, tmp_path: Path, studio: list[str]
) -> None:
    root = shutil.copytree(whole, tmp_path / "all")
    for name in ("dataset.json", "MANIFEST.sha256", shard_of(receipt_paths(root)[0])):
        (root / name).unlink()
    with pytest.raises(InputError, match="1 clip missing or broken; the same merge command goes on with it"):
        repair(root, 1)
    assert studio == []


def test_other_datasets_that_share_what_was_broken_are_thought_of(
    whole: Path, tmp_path: Path, studio: list[str], capsys: pytest.CaptureFixture[str]
) -> None:
    """A hard link that was damaged is damaged under all its names; a repair puts one of them right."""
    root = shutil.copytree(whole, tmp_path / "all")
    last = receipt_paths(root)[-1]
    (tmp_path / "elsewhere.tar").hardlink_to(root / shard_of(last))
    for shared in (True, False):
        flip(root, last)
        assert main(["repair", str(root), "--jobs", "1"]) == 0
        assert ("1 shard put right (field-00001-001) had hard links" in capsys.readouterr().err) == shared


def test_frames_of_a_merged_dataset_are_rendered_again_and_compared(
    fakes: ModuleType, whole: Path, studio: list[str], monkeypatch: pytest.MonkeyPatch
) -> None:
    before = fakes.tree(whole)
    found = rerender(whole, 20, 1)
    assert (found.findings, found.identical, found.same_software) == ((), 20, True)
    assert {key[:8] for key in found.frames} == {"city-000", "city-070", "field-00"}
    assert fakes.tree(whole) == before
    meta = fakes.meta
    monkeypatch.setattr(fakes, "meta", lambda k: meta(k + 1))
    assert rerender(whole, 2, 1).findings


def test_a_clip_that_comes_out_otherwise_does_not_take_the_place(
    fakes: ModuleType, whole: Path, tmp_path: Path, studio: list[str], monkeypatch: pytest.MonkeyPatch
) -> None:
    root = shutil.copytree(whole, tmp_path / "all")
    flip(root, receipt_paths(root)[-1])
    meta = fakes.meta
    monkeypatch.setattr(fakes, "meta", lambda k: meta(k + 1))
    done = repair(root, 1)
    ((clip, reason),) = done.failed
    assert clip == "field-00001-001" and "came out with SHA-256" in reason and not done.after.ok


def test_what_was_sensed_is_sensed_again(
    fakes: ModuleType, whole: Path, tmp_path: Path, studio: list[str], monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr("scenegen_datasets.sensing.run.write_preview", lambda _: None)
    root = tmp_path / "sensed"
    sense_dataset(whole, root, {"sensor": {"netd_mk": 200.0}}, seed=5)
    assert verify(root).ok
    lock = read_lock(root)
    assert lock["source"]["parts"] == read_lock(whole)["parts"]
    assert planned(root, lock) == planned(whole, read_lock(whole))
    before = fakes.tree(root)
    flip(root, receipt_paths(root)[-1], "thermal.png")
    done = repair(root, 1)
    assert done.after.ok and len(done.remade) == 1 and len(studio) == 1
    assert fakes.tree(root) == before


def test_a_sensed_dataset_that_does_not_know_its_source_says_what_to_do(
    whole: Path, tmp_path: Path, studio: list[str], monkeypatch: pytest.MonkeyPatch, capsys: Any
) -> None:
    monkeypatch.setattr("scenegen_datasets.sensing.run.write_preview", lambda _: None)
    root = tmp_path / "sensed"
    sense_dataset(whole, root, {}, seed=5)
    old = {key: value for key, value in read_lock(root).items() if key != "source"}
    for path in (root / "recipe.lock.json", root / "dataset.json", root / "MANIFEST.sha256"):
        path.unlink()
    (root / "recipe.lock.json").write_bytes(pretty(old))
    with pytest.raises(InputError, match="sensed by an older scenegen, which did not keep the recipe"):
        planned(root, old)
    for wrong in (3, {"recipe": 3}):
        with pytest.raises(DatasetError, match="what it says of its source makes no sense"):
            planned(root, {**old, "source": wrong})
    assert main(["sense", str(whole), "--out", str(root), "--seed", "5", "--jobs", "1"]) == 0
    assert verify(root).ok and "source" in read_lock(root), "the same command completes the lock"
