"""What lies in the place of a lock or a log is written into only if it is a plain file of that one name."""

from __future__ import annotations

import os
import signal
from collections.abc import Callable, Iterator
from pathlib import Path

import pytest

from scenegen.foundation.errors import InputError
from scenegen.foundation.lock import DirectoryLock
from scenegen.foundation.plain_file import open_plain
from scenegen_datasets.run_log import RunLog


def _log(root: Path) -> None:
    with RunLog(root) as log:
        log.write("start", pairs=1)


def _lock(root: Path) -> None:
    with DirectoryLock(root):
        pass


WRITERS: dict[str, Callable[[Path], None]] = {"run.log.jsonl": _log, ".lock": _lock}


@pytest.fixture(autouse=True)
def patience() -> Iterator[None]:
    """A pipe would keep the test waiting for ever."""
    signal.alarm(600)
    yield
    signal.alarm(0)


@pytest.fixture
def prey(tmp_path: Path) -> Path:
    path = tmp_path / "outside" / "prey"
    path.parent.mkdir()
    path.write_text("keep me")
    return path


@pytest.fixture
def root(tmp_path: Path) -> Path:
    path = tmp_path / "dataset"
    path.mkdir()
    return path


PLANTED: dict[str, tuple[Callable[[Path, Path], None], str]] = {
    "symbolic link": (lambda at, prey: at.symlink_to(prey), "is a symbolic link"),
    "dangling link": (lambda at, prey: at.symlink_to(prey.parent / "new"), "is a symbolic link"),
    "hard link": (lambda at, prey: at.hardlink_to(prey), "is a hard link to another file"),
    "pipe": (lambda at, prey: os.mkfifo(at), "is a pipe, a device or a directory"),
    "directory": (lambda at, prey: at.mkdir(), "is a pipe, a device or a directory"),
}


@pytest.mark.parametrize("name", WRITERS)
@pytest.mark.parametrize("planted", PLANTED)
def test_planted_files_are_refused_and_nothing_outside_is_written(
    root: Path, prey: Path, name: str, planted: str
) -> None:
    plant, reason = PLANTED[planted]
    plant(root / name, prey)
    with pytest.raises(InputError) as refusal:
        WRITERS[name](root)
    said = str(refusal.value)
    assert said.startswith(str(root / name)) and reason in said and "remove it" in said and "\n" not in said
    assert {p.name: p.read_text() for p in prey.parent.iterdir()} == {"prey": "keep me"}
    assert os.path.lexists(root / name), "what was planted is for its owner to remove"


@pytest.mark.parametrize("name", WRITERS)
def test_a_plain_file_is_used(root: Path, name: str) -> None:
    """What an earlier run left there: a stale lock, the log so far."""
    (root / name).write_text("before\n")
    WRITERS[name](root)
    if name == "run.log.jsonl":
        lines = (root / name).read_text().splitlines()
        assert lines[0] == "before" and '"pairs": 1' in lines[1] and len(lines) == 2
    else:
        assert not (root / name).exists()


def test_a_name_that_is_removed_meanwhile_is_no_hard_link(
    root: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """Another process may release the lock between our opening it and looking at it."""
    path, fstat = root / "file", os.fstat

    def removed(descriptor: int) -> os.stat_result:
        path.unlink()
        return fstat(descriptor)

    monkeypatch.setattr(os, "fstat", removed)
    descriptor = open_plain(path, os.O_RDWR)
    monkeypatch.undo()
    assert os.fstat(descriptor).st_nlink == 0
    os.close(descriptor)


def test_a_claim_that_is_a_pipe_is_not_waited_for(root: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    import errno
    import fcntl

    def no_flock(*_: object) -> None:
        raise OSError(errno.ENOTSUP, "no locks here")

    monkeypatch.setattr(fcntl, "flock", no_flock)
    os.mkfifo(root / ".lock.claim")
    with pytest.raises(InputError, match="being written by"):
        DirectoryLock(root).__enter__()
