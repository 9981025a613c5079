"""`scenegen export` from the command line, on a dataset that was really rendered."""

import json
import signal
from pathlib import Path

import pytest
import small

from consumers import check
from scenegen_cli.main import main


def test_one_command_exports_what_its_consumer_reads(
    finished_dataset: Path, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    out = tmp_path / "out"
    command = ["export", str(finished_dataset), "--to", "kitti", "--out", str(out), "--jobs", "2"]
    assert main([*command, "--gain", "fixed", "--gain-K", "230", "340"]) == 0
    assert "frames of 4 clips as kitti" in capsys.readouterr().out
    compared, errors = check("kitti", out, finished_dataset)
    assert compared == small.PAIRS and errors["flow_px"] <= 1 / 128 and errors["depth_m"] <= 1 / 512
    assert main([*command, "--gain", "fixed", "--gain-K", "230", "340"]) == 0
    assert "; 4 clips had been there" in capsys.readouterr().out
    assert main([*command, "--gain", "ground"]) == 2
    assert "options.gain" in capsys.readouterr().err


def test_json_and_default_place(
    finished_dataset: Path, capsys: pytest.CaptureFixture[str], tmp_path: Path
) -> None:
    alias = tmp_path / "data"
    alias.symlink_to(finished_dataset)
    assert main(["export", str(alias), "--to", "colmap", "--split", "train", "--jobs", "1", "--json"]) == 0
    told = json.loads(capsys.readouterr().out)
    root = tmp_path / "data-colmap"
    assert told["root"] == str(root) and told["frames"] == sum(1 for _ in root.rglob("images/*.png"))
    summary = json.loads((root / "export.json").read_text())
    assert summary["splits"] == ["train"] and summary["format"]["name"] == "colmap"
    assert check("colmap", root, finished_dataset, ("train",))[0] > 0


def test_killed_in_the_middle_and_run_again(finished_dataset: Path, tmp_path: Path) -> None:
    arguments = ["export", str(finished_dataset), "--to", "exr", "--jobs", "2", "--out"]
    process = small.start([*arguments, str(tmp_path / "out")])
    out = tmp_path / "out"
    assert small.until(lambda: process.poll() is not None or list(out.glob("*/*/*.exr")))
    workers = small.children(process.pid)
    process.send_signal(signal.SIGKILL)
    process.communicate()
    assert small.gone(workers)
    assert main([*arguments, str(tmp_path / "out")]) == 0
    assert check("exr", tmp_path / "out", finished_dataset)[0] == small.PAIRS


def test_help_lists_the_formats(capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["export", "--help"]) == 0
    told = capsys.readouterr().out
    assert all(f"\n  {name} " in told for name in ("unpack", "kitti", "tartanair", "nerfstudio", "rerun"))


@pytest.mark.parametrize(
    ("arguments", "said"),
    [
        (["/", "--to", "kitti"], "no dataset at /"),
        (["DATA", "--to", "../kitti"], "unknown format"),
        (["DATA", "--to", "tum", "--depth-unit-m", "1e-320"], "--depth-unit-m 9.99989e-321"),
        (["DATA", "--to", "kitti", "--out", "/proc/export"], "cannot be made"),
        (["DATA", "--to", "kitti", "--out", "x" * 300], "File name too long"),
        (["DATA", "--to", "kitti", "--split", "vall"], "perhaps you meant 'val'"),
    ],
)
def test_what_cannot_be_is_one_line(
    arguments: list[str], said: str, finished_dataset: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    given = [str(finished_dataset) if word == "DATA" else word for word in arguments]
    assert main(["export", *given]) == 2
    told = capsys.readouterr()
    assert said in told.err and told.err.count("\n") == 1 and told.out == ""


def test_default_place_of_a_path_with_dots(
    finished_dataset: Path, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    (tmp_path / "data").symlink_to(finished_dataset)
    (tmp_path / "deeper").mkdir()
    given = tmp_path / "deeper" / ".." / "data" / "."
    assert main(["export", str(given), "--to", "pix2pix", "--split", "train", "--jobs", "1", "--json"]) == 0
    assert json.loads(capsys.readouterr().out)["root"] == str(tmp_path / "data-pix2pix")
