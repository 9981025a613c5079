"""What the engine promises: resume, one export per directory, the same files whatever happens on the way."""

from __future__ import annotations

import errno
import json
import os
import shutil
import signal
import subprocess
import sys
from collections.abc import Callable
from pathlib import Path

import pytest

from scenegen.foundation.errors import CorruptFrameError, InputError, NoSpaceError
from scenegen_datasets.description import read_description, sealed_description
from scenegen_datasets.exports import engine
from scenegen_datasets.exports.marker import SUMMARY
from scenegen_datasets.exports.plan import Request
from scenegen_datasets.store import DATASET

Run = Callable[..., engine.Outcome]
Tree = Callable[[Path], dict[str, str]]
Make = Callable[..., Path]


def test_number_of_processes_does_not_show(run: Run, tree: Tree, tmp_path: Path) -> None:
    one, two = run("kitti", "one"), run("kitti", "two", jobs=2)
    assert tree(tmp_path / "one") == tree(tmp_path / "two")
    assert (one.counts, one.bytes, one.frames) == (two.counts, two.bytes, two.frames)
    assert one.counts["depth_too_far"] > 0 and any("255.99 m" in words for words in one.words)
    assert not (tmp_path / "two/.export/work").exists()


def test_a_second_run_writes_nothing(run: Run, tmp_path: Path) -> None:
    run("kitti")
    before = {p: p.stat().st_mtime_ns for p in tmp_path.rglob("*.png")}
    assert run("kitti").made == 0
    assert before == {p: p.stat().st_mtime_ns for p in tmp_path.rglob("*.png")}


def test_the_licence_travels(run: Run, tmp_path: Path) -> None:
    run("kitti", splits=("val",))
    assert json.loads((tmp_path / "out" / SUMMARY).read_text())["license"] == "CC-BY-4.0"
    pytest.importorskip("pyarrow")
    run("hf", "hub", splits=("val",))
    assert (tmp_path / "hub/README.md").read_text().startswith("---\nlicense: cc-by-4.0\nconfigs:\n")


@pytest.mark.parametrize("to", ["kitti", "hf", "zarr", "hdf5", "rerun"])
def test_a_dataset_that_states_no_licence_has_the_usual_one(
    run: Run, make_dataset: Make, tmp_path: Path, to: str
) -> None:
    old = make_dataset(tmp_path / "old", clips=1)
    said = read_description(old / DATASET)
    sums = said.pop("sums")
    del said["license"]
    (old / DATASET).write_bytes(sealed_description(said, sums))
    for package in {"hf": ("pyarrow",), "zarr": ("zarr",), "hdf5": ("h5py",), "rerun": ("rerun",)}.get(
        to, ()
    ):
        pytest.importorskip(package)
    run(to, dataset=old)
    assert json.loads((tmp_path / "out" / SUMMARY).read_text())["license"] == "CC-BY-4.0"


def test_what_is_gone_or_cut_is_written_again(run: Run, tree: Tree, tmp_path: Path) -> None:
    run("kitti")
    whole = tree(tmp_path / "out")
    pictures = sorted((tmp_path / "out/train").rglob("sequences/*/image_2/*.png"))
    pictures[0].unlink()
    pictures[-1].write_bytes(pictures[-1].read_bytes()[:40])
    outcome = run("kitti")
    assert outcome.made == 2 and tree(tmp_path / "out") == whole


@pytest.mark.parametrize("step", [1, 25, 60, 100])
def test_killed_anywhere_and_continued(step: int, small: Path, run: Run, tree: Tree, tmp_path: Path) -> None:
    """SIGKILL at the n-th call that touches the disk; no file under its final name is ever half a file."""
    run("tum", "whole")
    whole = tree(tmp_path / "whole")
    code = (
        "import itertools, os, signal, sys\nfrom pathlib import Path\n"
        "from scenegen_datasets.exports.engine import export\n"
        "from scenegen_datasets.exports.plan import Request\nsteps = itertools.count(1)\n"
        "def armed(call):\n"
        "    def wrapper(*a, **k):\n"
        f"        if next(steps) == {step}: os.kill(os.getpid(), signal.SIGKILL)\n"
        "        return call(*a, **k)\n"
        "    return wrapper\n"
        "for name in ('fsync', 'replace', 'mkdir'): setattr(os, name, armed(getattr(os, name)))\n"
        "export(Request(Path(sys.argv[1]), Path(sys.argv[2]), 'tum'))\n"
    )
    done = subprocess.run([sys.executable, "-c", code, str(small), str(tmp_path / "out")], timeout=600)
    assert done.returncode == -signal.SIGKILL and not (tmp_path / "out" / SUMMARY).exists()
    for name, digest in tree(tmp_path / "out").items():
        assert name.startswith(".") or whole[name] == digest, name
    run("tum")
    assert tree(tmp_path / "out") == whole


@pytest.mark.parametrize(
    ("change", "named"),
    [
        ({"to": "tum"}, "format"),
        ({"gain": "ground"}, "options.gain"),
        ({"splits": ("val",)}, "splits"),
        ({"dataset": "other"}, "recipe_id"),
    ],
)
def test_another_export_in_the_directory_is_refused(
    change: dict[str, object], named: str, run: Run, tree: Tree, make_dataset: Make, tmp_path: Path
) -> None:
    run("kitti")
    before = tree(tmp_path / "out")
    if "dataset" in change:
        change = {"dataset": make_dataset(tmp_path / "other", netd_mk=40.0)}
    with pytest.raises(InputError, match=named):
        run(**{"to": "kitti", **change})
    assert tree(tmp_path / "out") == before


def test_a_directory_of_somebody_else_is_refused(run: Run, tmp_path: Path) -> None:
    (tmp_path / "out").mkdir()
    (tmp_path / "out/thesis.tex").write_text("x")
    with pytest.raises(InputError, match=r"thesis\.tex"):
        run("kitti")
    assert [p.name for p in (tmp_path / "out").iterdir()] == ["thesis.tex"]


def test_links_are_not_followed(run: Run, tmp_path: Path) -> None:
    run("kitti", splits=("val",))
    shutil.rmtree(tmp_path / "out/val")
    (tmp_path / "elsewhere").mkdir()
    (tmp_path / "out/val").symlink_to(tmp_path / "elsewhere")
    with pytest.raises(InputError, match="link"):
        run("kitti", splits=("val",))
    assert not list((tmp_path / "elsewhere").iterdir())


@pytest.mark.parametrize(
    ("arguments", "message"),
    [
        ({"to": "kiti"}, "perhaps you meant 'kitti'"),
        ({"to": "kitti", "splits": ("vale",)}, "--split vale"),
        ({"to": "kitti", "maps": ("moon",)}, "--map moon"),
        ({"to": "zarr", "gain": "ground"}, "--gain changes nothing in an export to zarr"),
        ({"to": "kitti", "gain": "auto"}, "--gain auto"),
        ({"to": "kitti", "gain": "fixed", "gain_K": (300.0, 200.0)}, "lower one first"),
        ({"to": "pix2pix", "depth_cap_m": float("nan")}, "--depth-cap-m nan"),
    ],
)
def test_bad_wishes_are_one_line(
    arguments: dict[str, object], message: str, run: Run, tmp_path: Path
) -> None:
    with pytest.raises(InputError, match=message) as caught:
        run(**arguments)
    assert "\n" not in str(caught.value) and not (tmp_path / "out").exists()


def test_out_inside_the_dataset_is_refused(small: Path, tmp_path: Path) -> None:
    (tmp_path / "alias").symlink_to(small)
    for out in (small, small / "shards", small.parent, tmp_path / "alias" / "new"):
        with pytest.raises(InputError, match="inside the dataset or around it"):
            engine.export(Request(small, out, "kitti"))


def test_a_missing_layer_is_named(run: Run, make_dataset: Make, tmp_path: Path) -> None:
    bare = make_dataset(tmp_path / "bare", 1, ("thermal", "depth", "semantic", "temperature"))
    run("kitti", dataset=bare)
    assert not list((tmp_path / "out").rglob("flow_occ"))  # optional layers are left out
    thermal = make_dataset(tmp_path / "thermal", 1, ("thermal", "semantic", "temperature"))
    with pytest.raises(InputError, match="needs the layer 'depth'"):
        run("kitti", "none", dataset=thermal)


def test_a_full_device_is_said(run: Run, monkeypatch: pytest.MonkeyPatch, tmp_path: Path) -> None:
    monkeypatch.setattr(shutil, "disk_usage", lambda path: shutil._ntuple_diskusage(100, 100, 0))
    with pytest.raises(NoSpaceError, match="are needed"):
        run("kitti")
    monkeypatch.undo()

    def full(descriptor: int) -> None:
        raise OSError(errno.ENOSPC, "No space left on device")

    monkeypatch.setattr(os, "fsync", full)
    with pytest.raises(NoSpaceError):
        run("kitti")
    monkeypatch.undo()
    assert run("kitti").made == 6


def test_a_damaged_clip_stops_the_export(run: Run, small: Path, tmp_path: Path) -> None:
    broken = Path(shutil.copytree(small, tmp_path / "broken"))
    shard = sorted(broken.glob("shards/val/*/*.tar"))[0]
    data = bytearray(shard.read_bytes())
    data[600:640] = bytes(40)
    shard.write_bytes(data)
    with pytest.raises(CorruptFrameError, match=shard.stem):
        run("kitti", dataset=broken)
    assert not (tmp_path / "out" / SUMMARY).exists()
