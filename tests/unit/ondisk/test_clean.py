"""`scenegen clean` as people type it: what does not belong is listed, then gone, but never what somebody writes."""

from __future__ import annotations

import json
import os
import shutil
from pathlib import Path

import pytest

from scenegen.foundation.lock import DirectoryLock
from scenegen_cli.main import main
from scenegen_datasets.verify import verify

STRAY, PARTIAL = "shards/train/notes.txt", "shards/train/.000.tar.1-1.partial"


@pytest.fixture
def littered(pristine: Path, tmp_path: Path) -> Path:
    """Somebody's notes, a link to their files, what a writer was at."""
    root = Path(shutil.copytree(pristine, tmp_path / "a b ü"))
    (root / STRAY).write_text("mine")
    (root / PARTIAL).touch()
    (root / "link").symlink_to(tmp_path)
    return root


def test_what_does_not_belong_is_listed_and_removed(
    littered: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    assert main(["clean", str(littered), "--dry-run"]) == 0
    dry = capsys.readouterr()
    assert dry.out.endswith("3 would be removed\n") and dry.err == "" and (littered / STRAY).exists()
    assert main(["clean", str(littered), "--json"]) == 0
    told = json.loads(capsys.readouterr().out)
    assert told["removed"] is True
    reasons = {stray["path"]: stray["reason"] for stray in told["strays"]}
    assert reasons.keys() == {STRAY, PARTIAL, "link"}
    assert reasons["link"] == "a symbolic link", "without advice to run what was run"
    assert verify(littered).ok
    assert main(["clean", str(littered)]) == 0
    assert capsys.readouterr().out == "nothing to remove\n"


def test_what_somebody_writes_is_neither_removed_nor_called_left_behind(
    littered: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    with DirectoryLock(littered):
        assert main(["clean", str(littered)]) == 2
        refused = capsys.readouterr()
        assert main(["clean", str(littered), "--dry-run"]) == 0
        dry = capsys.readouterr()
    assert refused.out == "" and f"being written by process {os.getpid()}" in refused.err
    assert f"process {os.getpid()}" in dry.err and "writes to it" in dry.err
    assert (littered / PARTIAL).exists()
    assert main(["clean", str(littered)]) == 0
    assert capsys.readouterr().out.endswith("3 removed\n") and not (littered / PARTIAL).exists()
