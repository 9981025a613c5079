"""Clips of merged and of sensed datasets are made again from the lock alone, to the byte."""

from __future__ import annotations

import json
import shutil
from pathlib import Path

import pytest
import small

from scenegen_cli.main import main
from scenegen_datasets.receipt import read_receipt, receipt_paths, shard_of
from scenegen_datasets.verify import verify


@pytest.fixture(scope="module")
def merged(finished_dataset: Path, tmp_path_factory: pytest.TempPathFactory) -> Path:
    """The worlds of two seeds: sixteen pairs of one, four of the other."""
    base = tmp_path_factory.mktemp("merged")
    other = base / "other"
    assert main(small.render(other, pairs=4, jobs=1, more=("--seed", "7"))) == 0
    assert (
        main(["merge", str(base / "whole"), str(finished_dataset), str(other), "--copy", "--jobs", "1"]) == 0
    )
    return base / "whole"


def flip(root: Path, receipt: str) -> None:
    """Damage one bit of a clip's second depth map."""
    path = root / shard_of(receipt)
    data = bytearray(path.read_bytes())
    data[read_receipt(root, receipt).frames[1].members["depth.tiff"].offset + 40] ^= 4
    path.write_bytes(data)


def test_a_merged_dataset_is_repaired_to_the_byte(
    merged: Path, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    """A flipped bit in a world with a new number, a lost clip of the other seed, and what only repeats the lock."""
    root = shutil.copytree(merged, tmp_path / "whole")
    first, *_, last = receipt_paths(root)
    assert "city-07000" in last and "city-00000" in first
    flip(root, last)
    (root / shard_of(first)).unlink()
    (root / first).unlink()
    (root / "recipe.yaml").unlink()
    assert main(["repair", str(root), "--jobs", "1"]) == 0
    assert "2 clips rendered again" in capsys.readouterr().out
    assert small.tree(root) == small.tree(merged)


def test_frames_of_a_merged_dataset_are_rendered_again(
    merged: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    before = small.tree(merged)
    assert main(["verify", str(merged), "--rerender", "3", "--seed", "1", "--jobs", "1", "--json"]) == 0
    told = json.loads(capsys.readouterr().out)["rerendered"]
    assert (len(told["frames"]), told["identical"], told["same_software"]) == (3, 3, True)
    assert {key[:10] for key in told["frames"]} == {"city-00000", "city-07000"}
    assert small.tree(merged) == before


def test_what_was_sensed_of_a_merged_dataset_is_repaired_without_it(merged: Path, tmp_path: Path) -> None:
    """Rendered, numbered anew, binned and sensed: the whole way again, though the merged dataset is gone."""
    source = shutil.copytree(merged, tmp_path / "source")
    root = tmp_path / "coarse"
    asked = ["--size", "32x32", "--seed", "5", "--sensor.netd-mk", "200", "--jobs", "1"]
    assert main(["sense", str(source), "--out", str(root), *asked]) == 0
    assert verify(root).ok
    shutil.rmtree(source)
    before = small.tree(root)
    flip(root, receipt_paths(root)[-1])
    assert main(["repair", str(root), "--jobs", "1"]) == 0
    assert small.tree(root) == before


def test_a_seed_in_two_pieces_is_the_whole(finished_dataset: Path, tmp_path: Path) -> None:
    """With one seed and another first world, a second machine goes on with the same dataset."""
    later = tmp_path / "later"
    assert main(small.render(later, pairs=4, jobs=1, more=("--first-world", "1"))) == 0
    assert main(["merge", str(tmp_path / "pieces"), str(finished_dataset), str(later), "--jobs", "1"]) == 0
    grown = shutil.copytree(finished_dataset, tmp_path / "grown")
    assert main(small.render(grown, pairs=20, jobs=1)) == 0
    told = [json.loads((root / "dataset.json").read_bytes()) for root in (tmp_path / "pieces", grown)]
    assert told[0]["content_id"] == told[1]["content_id"] and told[0]["splits"] == told[1]["splits"]
