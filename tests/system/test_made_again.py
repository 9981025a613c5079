"""Two seeds merged and repaired, and one seed made in two pieces, to the byte, by the command that people type.

`tests/unit/versions/test_again.py` goes through everything else that can be made again, without a renderer.
"""

from __future__ import annotations

import json
import shutil
from pathlib import Path

import pytest
import small

import hostile_scenes
from scenegen_cli.main import main
from scenegen_datasets.receipt import read_receipt, receipt_paths, shard_of


def flip(root: Path, receipt: str) -> None:
    """Damage one bit of a clip's second depth map."""
    path = root / shard_of(receipt)
    data = bytearray(path.read_bytes())
    data[read_receipt(root, receipt).frames[1].members["depth.tiff"].offset + 40] ^= 4
    path.write_bytes(data)


def test_a_merged_dataset_is_repaired_to_the_byte(
    finished_dataset: Path, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    """A flipped bit in a world with a new number, and a file that only repeats the lock; the parts are not needed."""
    other, whole = tmp_path / "other", tmp_path / "whole"
    assert main(small.render(other, pairs=4, jobs=1, more=("--seed", "7"))) == 0
    assert main(["merge", str(whole), str(finished_dataset), str(other), "--copy", "--jobs", "1"]) == 0
    assert "worlds of seed 7 are numbered from 7000 on" in capsys.readouterr().out
    shutil.rmtree(other)
    before = small.tree(whole)
    last = receipt_paths(whole)[-1]
    assert "city-07000" in last
    flip(whole, last)
    (whole / "recipe.yaml").unlink()
    assert main(["repair", str(whole), "--jobs", "1"]) == 0
    assert "1 clip rendered again" in capsys.readouterr().out
    assert small.tree(whole) == before


def test_an_own_scene_in_a_merged_dataset_is_repaired_with_its_file(
    finished_dataset: Path, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    """The lock knows what the scene is; where it lies now, the user says. Clips of the city do without."""
    scene, whole = tmp_path / "yard.glb", tmp_path / "whole"
    scene.write_bytes(hostile_scenes.sound(".glb"))
    scene.with_suffix(".yaml").write_text("up_axis: z\ndefault_material: granite\n")
    flags = ("--map", str(scene), "--flight.height-m", "6", "12", "--no-verify")
    assert main(small.render(tmp_path / "yard", pairs=4, jobs=1, more=flags)) == 0
    assert (
        main(["merge", str(whole), str(finished_dataset), str(tmp_path / "yard"), "--copy", "--jobs", "1"])
        == 0
    )
    before = small.tree(whole)
    there = tmp_path / "elsewhere" / "farm.glb"
    there.parent.mkdir()
    scene.rename(there)
    scene.with_suffix(".yaml").rename(there.with_suffix(".yaml"))
    (whole / "shards/train/yard-00000/000.tar").unlink()
    capsys.readouterr()
    assert main(["repair", str(whole), "--jobs", "1"]) == 2
    said = capsys.readouterr().err.strip()
    assert "takes the scene yard" in said and "--own-files FILE" in said and "\n" not in said
    assert {k: v for k, v in before.items() if "yard-00000/000.tar" not in k} == small.tree(whole)
    assert main(["repair", str(whole), "--jobs", "1", "--own-files", str(there)]) == 0
    assert small.tree(whole) == before


def test_a_seed_in_two_pieces_is_the_whole(finished_dataset: Path, tmp_path: Path) -> None:
    """With one seed and another first world, a second machine goes on with the same dataset."""
    later = tmp_path / "later"
    assert main(small.render(later, pairs=4, jobs=1, more=("--first-world", "1"))) == 0
    assert main(["merge", str(tmp_path / "pieces"), str(finished_dataset), str(later), "--jobs", "1"]) == 0
    grown = shutil.copytree(finished_dataset, tmp_path / "grown")
    assert main(small.render(grown, pairs=20, jobs=1)) == 0
    told = [json.loads((root / "dataset.json").read_bytes()) for root in (tmp_path / "pieces", grown)]
    assert told[0]["content_id"] == told[1]["content_id"] and told[0]["splits"] == told[1]["splits"]
