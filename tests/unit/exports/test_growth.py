"""A dataset grows, and its exports follow: what is new is added, what belongs to all clips is written anew."""

from __future__ import annotations

import json
import shutil
from collections.abc import Callable
from pathlib import Path

import pytest

from consumers import CONSUMERS, check
from scenegen.foundation.errors import InputError
from scenegen_datasets.exports import engine
from scenegen_datasets.exports.marker import SUMMARY
from scenegen_datasets.exports.registry import FORMATS

Run = Callable[..., engine.Outcome]
Tree = Callable[[Path], dict[str, str]]
Make = Callable[..., Path]


@pytest.fixture(scope="module")
def before(make_dataset: Make, tmp_path_factory: pytest.TempPathFactory) -> Path:
    """Three clips: two to train, one to validate."""
    return make_dataset(tmp_path_factory.mktemp("before") / "dataset", clips=3)


@pytest.fixture(scope="module")
def after(before: Path, make_dataset: Make, tmp_path_factory: pytest.TempPathFactory) -> Path:
    """The same, grown by one clip to validate and the first to test."""
    root = Path(shutil.copytree(before, tmp_path_factory.mktemp("after") / "dataset"))
    return make_dataset(root, clips=5)


@pytest.mark.parametrize("name", FORMATS)
def test_an_export_goes_on_when_its_dataset_has_grown(
    name: str, run: Run, tree: Tree, before: Path, after: Path, tmp_path: Path
) -> None:
    """Old clips are not touched, and the whole is what a new export of the grown dataset would be."""
    for module in FORMATS[name].modules:
        pytest.importorskip(module)
    if name == "hf":
        pytest.importorskip("datasets.arrow_dataset")
    run(name, dataset=before)
    markers = sorted((tmp_path / "out/.export/clips").iterdir())
    kept = [f for marker in markers for f in json.loads(marker.read_bytes())["clip"]["files"]]
    inodes = {f: (tmp_path / "out" / f).stat().st_ino for f in kept}
    outcome = run(name, dataset=after)
    assert (outcome.made, outcome.clips) == (2, 5)
    assert kept and inodes == {f: (tmp_path / "out" / f).stat().st_ino for f in kept}
    compared, _ = check(name, tmp_path / "out", after)
    assert compared == (10 if name == "monodepth2" else 15) * len(CONSUMERS[name])
    if name != "rerun":
        run(name, "new", dataset=after)
        assert tree(tmp_path / "out") == tree(tmp_path / "new")


def test_growth_that_was_interrupted(
    run: Run, tree: Tree, before: Path, after: Path, monkeypatch: pytest.MonkeyPatch, tmp_path: Path
) -> None:
    """An export that is behind its dataset does not look complete, and what was added is kept."""
    run("filelist", dataset=before)

    def stop(*_: object) -> None:
        raise KeyboardInterrupt

    monkeypatch.setattr(engine, "_finish", stop)
    with pytest.raises(KeyboardInterrupt):
        run("filelist", dataset=after)
    monkeypatch.undo()
    assert not (tmp_path / "out" / SUMMARY).exists()
    assert run("filelist", dataset=after).made == 0
    run("filelist", "new", dataset=after)
    assert tree(tmp_path / "out") == tree(tmp_path / "new")


def test_growth_elsewhere_changes_the_summary_alone(
    run: Run, tree: Tree, before: Path, after: Path, tmp_path: Path
) -> None:
    run("colmap", dataset=before, splits=("train",))
    old = tree(tmp_path / "out")
    assert run("colmap", dataset=after, splits=("train",)).made == 0
    new = tree(tmp_path / "out")
    assert {name for name in old if old[name] != new[name]} == {SUMMARY} and old.keys() == new.keys()
    told = json.loads((tmp_path / "out" / SUMMARY).read_text())
    assert told["content_id"] == json.loads((after / "dataset.json").read_text())["content_id"]


def test_a_clip_that_changed_is_refused(
    run: Run, tree: Tree, before: Path, make_dataset: Make, tmp_path: Path
) -> None:
    """The same recipe and names, one clip of other content: nothing of the export is touched."""
    run("kitti", dataset=before)
    old = tree(tmp_path / "out")
    other = Path(shutil.copytree(before, tmp_path / "other"))
    (other / "receipts/train/city-00000/001.json").unlink()
    make_dataset(other, clips=4, cameras=2)
    with pytest.raises(InputError, match=r"holds city-00000-001 as it was before .* choose another --out"):
        run("kitti", dataset=other)
    assert tree(tmp_path / "out") == old


def test_an_export_of_more_is_refused(
    run: Run, tree: Tree, before: Path, after: Path, tmp_path: Path
) -> None:
    """An older copy of the dataset does not make an export smaller."""
    run("kitti", dataset=after)
    old = tree(tmp_path / "out")
    with pytest.raises(InputError, match="holds city-00001-001, which is not asked for or not there"):
        run("kitti", dataset=before)
    assert tree(tmp_path / "out") == old


def test_a_damaged_marker_is_made_again(run: Run, tree: Tree, before: Path, tmp_path: Path) -> None:
    run("kitti", dataset=before)
    whole = tree(tmp_path / "out")
    marker = tmp_path / "out/.export/clips/city-00000-000.json"
    marker.write_bytes(marker.read_bytes()[:-9])
    assert run("kitti", dataset=before).made == 1 and tree(tmp_path / "out") == whole
