"""A clip is there, whole, or not there: killed at any step, out of space at any byte, made in any order."""

from __future__ import annotations

import errno
import itertools
import os
import resource
import shutil
import subprocess
import sys
import tarfile
from collections.abc import Callable
from pathlib import Path
from types import ModuleType

import pytest

from scenegen.foundation.errors import DatasetError, InputError, NoSpaceError
from scenegen_datasets.commit import ShardWriter, commit_clip
from scenegen_datasets.store import finished

KILLED = Path(__file__).with_name("killed.py")


def run_killed(root: Path, clips: int, step: int, *flags: str) -> int:
    command = [sys.executable, str(KILLED), str(root), str(clips), str(step), *flags]
    return subprocess.run(command, capture_output=True, check=False).returncode


def test_bytes_do_not_depend_on_order_resume_or_growth(
    fakes: ModuleType, pristine: Path, tmp_path: Path
) -> None:
    backwards = fakes.make(tmp_path / "backwards", 6, order=-1)
    grown = fakes.make(tmp_path / "grown", 2)
    small = fakes.tree(grown)
    fakes.make(grown, 4, order=-1, done=False)
    fakes.make(grown, 6)
    expected = fakes.tree(pristine)
    assert fakes.tree(backwards) == expected
    assert fakes.tree(grown) == expected
    for path, data in small.items():
        if path.startswith(("shards", "receipts")):
            assert expected[path] == data


def test_finishing_again_changes_nothing(fakes: ModuleType, dataset: Path) -> None:
    before = fakes.tree(dataset)
    fakes.make(dataset, 6)
    assert fakes.tree(dataset) == before


@pytest.mark.slow
def test_killed_at_any_step_then_resumed_gives_the_same_tree(fakes: ModuleType, tmp_path: Path) -> None:
    """SIGKILL between any two steps of two clips, of the finish, and of creation; a second kill during the resume."""
    clean = fakes.tree(fakes.make(tmp_path / "clean", 2))
    died, steps = 0, [*range(1, 30, 3), *range(30, 190, 16)]
    for number, step in enumerate(steps):
        root = tmp_path / f"killed{step}"
        code = run_killed(root, 2, step)
        died += code == -9
        assert code in (-9, 0)
        sound = finished(root) if root.exists() else set()
        for name in sound:
            clip = f"train/{name[:10]}/{name[11:]}"
            assert (root / f"shards/{clip}.tar").read_bytes() == clean[f"shards/{clip}.tar"]
        if number % 4 == 0:
            run_killed(root, 2, 25)
        fakes.make(root, 2)
        assert fakes.tree(root) == clean, f"killed at step {step}"
        shutil.rmtree(root)
    assert died > len(steps) // 2, "the kills must hit"


def test_a_naive_writer_fails_the_same_test(fakes: ModuleType, tmp_path: Path) -> None:
    """Negative control: in-place writes with "exists, so skip" leave a wrong tree, and the comparison sees it."""
    clean = fakes.tree(fakes.make(tmp_path / "clean", 2))
    wrong = 0
    for step in (70, 71, 72):
        root = tmp_path / f"naive{step}"
        assert run_killed(root, 2, step, "naive") == -9
        assert run_killed(root, 2, 10**9, "naive") in (0, 1)
        wrong += fakes.tree(root) != clean
    assert wrong


def failing_at(k: int, call: Callable[..., object], code: int) -> Callable[..., object]:
    calls = itertools.count(1)

    def wrapper(*args: object) -> object:
        if next(calls) == k:
            raise OSError(code, "injected")
        return call(*args)

    return wrapper


def test_every_failing_call_is_one_clear_error_and_leaves_nothing(
    fakes: ModuleType, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """The k-th write, fsync or rename fails, for every k: no partial stays, no clip counts that is not whole."""
    job = fakes.jobs(1)[0]
    frames = list(fakes.encoded(job))
    for name in ("write", "fsync", "replace"):
        original = getattr(os, name)
        for k in range(1, 200):
            root = tmp_path / f"{name}{k}"
            root.mkdir()
            code = errno.ENOSPC if name == "write" else errno.EIO
            monkeypatch.setattr(os, name, failing_at(k, original, code))
            try:
                commit_clip(root, fakes.record(job), frames, fingerprint="f")
                done = True
            except (NoSpaceError, InputError, OSError) as error:
                assert name != "write" or isinstance(error, NoSpaceError)
                done = False
            monkeypatch.setattr(os, name, original)
            assert not list(root.rglob("*.partial"))
            if done:
                assert finished(root) == {job.name}
                assert k > 2
                break
            if not (name == "fsync" and (root / job.receipt).exists()):
                assert finished(root) == set()
        else:
            pytest.fail(f"{name} never ran out")


def test_the_receipt_comes_last(fakes: ModuleType, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    job = fakes.jobs(1)[0]
    order: list[str] = []
    original = os.replace
    monkeypatch.setattr(os, "replace", lambda a, b: (order.append(Path(b).name), original(a, b))[1])
    commit_clip(tmp_path, fakes.record(job), fakes.encoded(job), fingerprint="f")
    assert order == ["000.tar", "000.json"]


def test_a_full_device_is_told_as_such(fakes: ModuleType, tmp_path: Path) -> None:
    """A real limit of the operating system, in a child process: half a shard fits."""
    code = f"""
import resource, signal, sys
from pathlib import Path
sys.path.insert(0, {str(KILLED.parents[2])!r})
import fakes
from scenegen.foundation.errors import NoSpaceError
signal.signal(signal.SIGXFSZ, signal.SIG_IGN)
resource.setrlimit(resource.RLIMIT_FSIZE, (20_000, resource.RLIM_INFINITY))
try:
    fakes.make(Path(sys.argv[1]), 1)
except NoSpaceError as error:
    print(error, error.exit_code)
"""
    root = tmp_path / "full"
    out = subprocess.run(
        [sys.executable, "-c", code, str(root)], capture_output=True, text=True, check=True
    ).stdout
    assert "no space left" in out and "000.tar" in out and out.strip().endswith("4")
    assert resource.getrlimit(resource.RLIMIT_FSIZE)[0] == resource.RLIM_INFINITY
    assert not list(root.rglob("*.partial")) and not list(root.rglob("*.tar"))
    fakes.make(root, 1)
    assert finished(root) == {"city-00000-000"}


def test_leaving_without_commit_leaves_nothing(fakes: ModuleType, tmp_path: Path) -> None:
    job = fakes.jobs(1)[0]
    with pytest.raises(KeyboardInterrupt), ShardWriter(tmp_path, job) as shard:
        shard.add(next(fakes.encoded(job)))
        raise KeyboardInterrupt
    assert [p for p in tmp_path.rglob("*") if p.is_file()] == []


def test_what_a_killed_writer_left_is_removed_by_the_next(fakes: ModuleType, tmp_path: Path) -> None:
    job = fakes.jobs(1)[0]
    orphan = tmp_path / job.shard
    orphan.parent.mkdir(parents=True)
    mine = orphan.with_name(f".{orphan.name}.1-1.partial")
    other = orphan.with_name(".001.tar.1-1.partial")
    mine.touch()
    other.touch()
    commit_clip(tmp_path, fakes.record(job), fakes.encoded(job), fingerprint="f")
    assert not mine.exists()
    assert other.exists(), "another clip's writer may be alive"


def test_a_clip_must_be_complete_and_of_its_job(fakes: ModuleType, tmp_path: Path) -> None:
    job, other = fakes.jobs(2)
    with pytest.raises(DatasetError, match="3 frames of 4"):
        commit_clip(tmp_path, fakes.record(job), list(fakes.encoded(job))[:-1], fingerprint="f")
    with pytest.raises(DatasetError, match="where city-00000-000-0000 belongs"):
        commit_clip(tmp_path, fakes.record(job), fakes.encoded(other), fingerprint="f")
    with pytest.raises(DatasetError, match="the record says otherwise"):
        commit_clip(tmp_path, fakes.record(job, (99, 99)), fakes.encoded(job), fingerprint="f")


def test_the_tar_is_plain_and_anonymous(fakes: ModuleType, pristine: Path) -> None:
    job = fakes.jobs(1)[0]
    with tarfile.open(pristine / job.shard) as tar:
        members = tar.getmembers()
    suffixes = ["thermal.png", "depth.tiff", "flow.exr", "truth.exr", "json"]
    assert [m.name for m in members] == [f"{job.key(k)}.{s}" for k in range(job.frames) for s in suffixes]
    for member in members:
        assert (member.mtime, member.uid, member.gid, member.uname, member.gname, member.mode) == (
            0,
            0,
            0,
            "",
            "",
            0o644,
        )
        assert member.isreg()
        assert member.name.count(".") <= 2 and "." not in member.name.split(".")[0]


def test_a_directory_that_is_a_link_is_not_followed(fakes: ModuleType, tmp_path: Path) -> None:
    root, elsewhere = tmp_path / "root", tmp_path / "elsewhere"
    root.mkdir()
    elsewhere.mkdir()
    (root / "shards").symlink_to(elsewhere)
    with pytest.raises(InputError, match="link"):
        ShardWriter(root, fakes.jobs(1)[0])
    assert list(elsewhere.iterdir()) == []
