"""One writer at a time, whoever dies, and a clear word to the second."""

from __future__ import annotations

import errno
import fcntl
import json
import os
import signal
import socket
import subprocess
import sys
from pathlib import Path

import pytest

from scenegen.foundation.errors import InputError
from scenegen.foundation.lock import DirectoryLock

HOLD = """
import sys, time
from pathlib import Path
from scenegen.foundation.lock import DirectoryLock
with DirectoryLock(Path(sys.argv[1])):
    print("held", flush=True)
    time.sleep(600)
"""

CONTEND = """
import sys
from pathlib import Path
from scenegen.foundation.errors import InputError
from scenegen.foundation.lock import DirectoryLock
root, won = Path(sys.argv[1]), 0
for _ in range(300):
    try:
        with DirectoryLock(root):
            inside = root / "inside"
            inside.touch(exist_ok=False)   # fails if anybody else is in here
            inside.unlink()
            won += 1
    except InputError:
        pass
print(won)
"""


def hold(root: Path) -> subprocess.Popen[str]:
    process = subprocess.Popen([sys.executable, "-c", HOLD, str(root)], stdout=subprocess.PIPE, text=True)
    assert process.stdout is not None and process.stdout.readline() == "held\n"
    return process


def test_the_second_is_told_who_the_first_is(tmp_path: Path) -> None:
    with DirectoryLock(tmp_path):
        with pytest.raises(InputError, match=f"process {os.getpid()} on {socket.gethostname()}"):
            DirectoryLock(tmp_path).__enter__()
        assert (tmp_path / ".lock").exists()
    assert list(tmp_path.iterdir()) == []
    with DirectoryLock(tmp_path):
        pass


def test_a_killed_holder_leaves_no_lock_behind(tmp_path: Path) -> None:
    process = hold(tmp_path)
    with pytest.raises(InputError, match=f"process {process.pid} "):
        DirectoryLock(tmp_path).__enter__()
    process.send_signal(signal.SIGKILL)
    process.communicate()
    assert (tmp_path / ".lock").exists(), "the file is stale, the lock is not"
    with DirectoryLock(tmp_path):
        assert json.loads((tmp_path / ".lock").read_bytes())["pid"] == os.getpid()
    assert list(tmp_path.iterdir()) == []


def test_released_after_an_error(tmp_path: Path) -> None:
    with pytest.raises(ZeroDivisionError), DirectoryLock(tmp_path):
        raise ZeroDivisionError
    with DirectoryLock(tmp_path):
        pass


def test_many_processes_are_never_inside_together(tmp_path: Path) -> None:
    """900 attempts from three processes: taking, releasing and unlinking race with each other."""
    command = [sys.executable, "-c", CONTEND, str(tmp_path)]
    racing = [
        subprocess.Popen(command, stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True) for _ in range(3)
    ]
    results = [p.communicate(timeout=600) for p in racing]
    assert [p.returncode for p in racing] == [0, 0, 0], results
    assert sum(int(out) for out, _ in results) > 100


def no_flock(*_: object) -> None:
    raise OSError(errno.ENOTSUP, "no locks here")


def test_without_kernel_locks_a_claim_decides(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(fcntl, "flock", no_flock)
    with DirectoryLock(tmp_path):
        with pytest.raises(InputError, match=f"process {os.getpid()} on"):
            DirectoryLock(tmp_path).__enter__()
        with pytest.raises(InputError, match=f"process {os.getpid()} on"):
            DirectoryLock(tmp_path).__enter__()
    with DirectoryLock(tmp_path):
        pass


def test_a_claim_is_taken_over_only_from_the_provably_dead(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(fcntl, "flock", no_flock)
    claim = tmp_path / ".lock.claim"
    dead = subprocess.Popen([sys.executable, "-c", ""])
    dead.wait()
    for holder in (
        {"host": "elsewhere", "pid": dead.pid},
        {"host": socket.gethostname(), "pid": 1},
        {},
        ["x"],
    ):
        claim.write_text(json.dumps(holder))
        with pytest.raises(InputError, match="being written by"):
            DirectoryLock(tmp_path).__enter__()
    claim.write_text(json.dumps({"host": socket.gethostname(), "pid": dead.pid}))
    with DirectoryLock(tmp_path):
        assert json.loads(claim.read_text())["pid"] == os.getpid()
    assert not claim.exists()


def test_a_directory_that_cannot_be_written_is_told(tmp_path: Path) -> None:
    with pytest.raises(InputError, match="cannot lock"):
        DirectoryLock(tmp_path / "nowhere").__enter__()
