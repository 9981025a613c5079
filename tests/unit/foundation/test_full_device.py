"""A full device: locks hold, logs are silent, everything else is one line that says so."""

from __future__ import annotations

import errno
import fcntl
import json
import os
from pathlib import Path

import pytest

from scenegen.foundation.errors import InputError, NoSpaceError
from scenegen.foundation.lock import DirectoryLock
from scenegen_cli.main import main
from scenegen_datasets.run_log import RunLog


@pytest.fixture
def full(monkeypatch: pytest.MonkeyPatch) -> None:
    """A device that gives files names, and no byte of content."""

    def refuse(*_: object) -> None:
        raise OSError(errno.ENOSPC, os.strerror(errno.ENOSPC))

    monkeypatch.setattr(os, "pwrite", refuse)


def test_on_a_full_device_a_lock_holds_without_a_name(tmp_path: Path, full: None) -> None:
    with DirectoryLock(tmp_path), pytest.raises(InputError, match=r"process \? on an unknown host"):
        DirectoryLock(tmp_path).__enter__()
    assert not (tmp_path / ".lock").exists()


def test_a_claim_without_a_name_is_taken_back(
    tmp_path: Path, full: None, monkeypatch: pytest.MonkeyPatch
) -> None:
    def unsupported(*_: object) -> None:
        raise OSError(errno.ENOLCK, "No locks available")

    monkeypatch.setattr(fcntl, "flock", unsupported)
    with pytest.raises(NoSpaceError, match="no space left"):
        DirectoryLock(tmp_path).__enter__()
    assert not (tmp_path / ".lock.claim").exists()


def test_a_log_on_a_full_device_is_silent(tmp_path: Path) -> None:
    with RunLog(tmp_path) as log:
        log.write("before", word="\udcff")
        assert log._file is not None
        with Path("/dev/full").open("wb") as device:
            os.dup2(device.fileno(), log._file.fileno())
        log.write("while it is full")
    assert json.loads((tmp_path / "run.log.jsonl").read_text("utf-8").splitlines()[-1])["event"] == "before"


def test_whatever_a_full_device_stops_is_told_as_such(
    monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    def refuse(_: object) -> int:
        raise OSError(errno.ENOSPC, os.strerror(errno.ENOSPC), "/data/x")

    monkeypatch.setattr("scenegen_cli.info.run", refuse)
    assert main(["info"]) == 4
    assert capsys.readouterr().err.startswith("scenegen: no space left for /data/x; free some")
