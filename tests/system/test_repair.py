"""A damaged dataset comes back to the bytes it had, through the command that people type."""

import json
import os
import shutil
from pathlib import Path

import pytest
import small

from scenegen_cli.main import main
from scenegen_datasets.receipt import read_receipt, receipt_paths, shard_of


@pytest.fixture
def damaged(finished_dataset: Path, tmp_path: Path) -> Path:
    """A flipped bit, a swapped member, a missing receipt, a short index, a lost picture, a pipe, strangers."""
    root = shutil.copytree(finished_dataset, tmp_path / "tiny")
    flipped, swapped, lost = receipt_paths(root)[:3]
    path = root / shard_of(flipped)
    data = bytearray(path.read_bytes())
    data[read_receipt(root, flipped).frames[2].members["depth.tiff"].offset + 40] ^= 4
    path.write_bytes(data)
    path = root / shard_of(swapped)
    data = bytearray(path.read_bytes())
    a, b = (read_receipt(root, swapped).frames[k].members["flow.exr"] for k in (1, 2))
    one, two = (bytes(data[s.offset : s.offset + s.size]) for s in (a, b))
    data[a.offset : a.offset + a.size], data[b.offset : b.offset + b.size] = two, one
    path.write_bytes(data)
    (root / lost).unlink()
    os.truncate(root / "index.npy", 100)
    (root / "preview/contact_sheet.png").unlink()
    (root / "README.md").unlink()
    os.mkfifo(root / "README.md")
    return root


def test_everything_is_named_and_comes_back(
    finished_dataset: Path, damaged: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    flipped, swapped, lost = receipt_paths(finished_dataset)[:3]
    assert main(["verify", str(damaged), "--json", "--jobs", "1"]) == 1
    named = {f["file"] for f in json.loads(capsys.readouterr().out)["findings"]}
    keys = [read_receipt(finished_dataset, p).frames for p in (flipped, swapped)]
    assert f"{shard_of(flipped)}: {keys[0][2].key}.depth.tiff" in named
    assert {f"{shard_of(swapped)}: {keys[1][k].key}.flow.exr" for k in (1, 2)} <= named
    assert {lost, "index.npy", "preview/contact_sheet.png", "README.md"} <= named
    assert main(["repair", str(damaged), "--jobs", "1"]) == 0
    shown = capsys.readouterr()
    assert "sound again" in shown.out and "3 clips rendered again" in shown.out
    assert small.tree(damaged) == small.tree(finished_dataset)
    assert main(["repair", str(damaged), "--jobs", "1"]) == 0
    assert "nothing to repair" in capsys.readouterr().out


def test_frames_are_rendered_again_from_the_lock_alone(
    finished_dataset: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    before = small.tree(finished_dataset)
    assert (
        main(["verify", str(finished_dataset), "--rerender", "2", "--seed", "3", "--jobs", "1", "--json"])
        == 0
    )
    told = json.loads(capsys.readouterr().out)["rerendered"]
    assert (len(told["frames"]), told["identical"], told["same_software"]) == (2, 2, True)
    assert small.tree(finished_dataset) == before


def test_other_software_is_refused_before_anything_is_rendered(
    finished_dataset: Path,
    tmp_path: Path,
    capsys: pytest.CaptureFixture[str],
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    from scenegen_datasets.repair import remake

    root = shutil.copytree(finished_dataset, tmp_path / "tiny")
    (root / shard_of(receipt_paths(root)[0])).unlink()
    before = small.tree(root)
    here = {**json.loads((root / "recipe.lock.json").read_bytes())["fingerprint"], "numpy": "1.0"}
    monkeypatch.setattr(remake, "fingerprint_here", lambda: here)
    assert main(["repair", str(root), "--jobs", "1"]) == 2
    said = capsys.readouterr().err
    assert 'numpy: "' in said and '-> "1.0"' in said and "--allow-mixed" in said
    assert small.tree(root) == before
