"""`scenegen status` reads the lock and the log that lie in a dataset, and believes neither."""

from __future__ import annotations

import json
import os
import signal
import socket
from collections.abc import Callable, Iterator
from pathlib import Path

import pytest

from scenegen.foundation.lock import DirectoryLock
from scenegen_cli.main import main
from scenegen_datasets.run_log import RunLog

HOST = socket.gethostname()


@pytest.fixture(autouse=True)
def patience() -> Iterator[None]:
    """A pipe would keep the test waiting for ever."""
    signal.alarm(600)
    yield
    signal.alarm(0)


@pytest.fixture
def told(dataset: Path, capsys: pytest.CaptureFixture[str]) -> Callable[[], dict[str, object]]:
    """What it says, as JSON, after it has said it in words."""

    def run() -> dict[str, object]:
        assert main(["status", str(dataset)]) == 0
        assert all(line.isprintable() for line in capsys.readouterr().out.split("\n"))
        assert main(["status", str(dataset), "--json"]) == 0
        return dict(json.loads(capsys.readouterr().out))

    return run


def test_the_writer_and_the_last_event_are_told(dataset: Path, told: Callable[[], dict[str, object]]) -> None:
    with RunLog(dataset) as log:
        log.write("start", pairs=3)
        log.write("quarantine", clip="city-00009-000", message="no way through")
    assert told()["writer"] is None
    with DirectoryLock(dataset):
        facts = told()
    assert facts["writer"] == f"process {os.getpid()} on {HOST}"
    assert str(facts["last_event"]).endswith(" quarantine")
    assert facts["quarantined"] == {"city-00009-000": "no way through"}


@pytest.mark.parametrize(
    "holder",
    [
        b"",
        b"[" * 4000,
        b'{"pid": 1}',
        b'{"pid": 1e400, "host": "x"}',
        b'{"pid": "a", "host": "x"}',
        b'{"pid": 100000000000000000000, "host": "%s"}' % HOST.encode(),
        b'{"pid": null, "host": []}',
        b'{"pid": 1, "host": "x"}' + b" " * 10_000,
    ],
)
def test_a_lock_that_names_no_process_has_no_writer(
    dataset: Path, told: Callable[[], dict[str, object]], holder: bytes
) -> None:
    (dataset / ".lock").write_bytes(holder)
    assert told()["writer"] is None


@pytest.mark.parametrize("name", [".lock", "run.log.jsonl"])
@pytest.mark.parametrize("plant", [os.mkfifo, lambda p: p.symlink_to("/etc/passwd"), Path.mkdir])
def test_what_is_no_file_is_not_opened(
    dataset: Path, told: Callable[[], dict[str, object]], name: str, plant: Callable[[Path], None]
) -> None:
    plant(dataset / name)
    facts = told()
    assert facts["writer"] is None and facts["last_event"] is None


def test_lines_that_make_no_sense_are_left_out(dataset: Path, told: Callable[[], dict[str, object]]) -> None:
    lines = [
        b'{"time": "t", "event": "start"}',
        b'{"time": "t", "event": "quarantine"}',
        b'{"time": "t", "event": "quarantine", "clip": {}, "message": 1}',
        b'{"time": [], "event": "start"}',
        b'{"a":' * 50_000,
        b"\xff\x00",
        b'{"time": "\\u001b[2J", "event": "\xc2\x9bend"}',
    ]
    (dataset / "run.log.jsonl").write_bytes(b"\n".join(lines))
    facts = told()
    assert facts["last_event"] == "\x1b[2J \x9bend" and facts["quarantined"] == {}
